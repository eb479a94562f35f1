#include "host/run/result.h"

#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "host/core/error.h"
#include "host/core/number_text.h"
#include "host/core/text_file.h"

namespace rosefusion {
namespace {

namespace fs = std::filesystem;

/// Fields of one line, quotation marks around texts taken off.
std::vector<std::string> csvFields(const std::string& line) {
  std::vector<std::string> fields(1);
  bool quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (c == '"' && quoted && i + 1 < line.size() && line[i + 1] == '"')
      fields.back() += line[++i];
    else if (c == '"')
      quoted = !quoted;
    else if (c == ',' && !quoted)
      fields.emplace_back();
    else
      fields.back() += c;
  }
  return fields;
}

/// The columns by name, and a line's fields under them.
class CsvRow {
 public:
  CsvRow(const std::map<std::string, std::size_t>& columns, const std::vector<std::string>& fields)
      : columns_(columns), fields_(fields) {}
  const std::string& text(const std::string& column) const { return fields_.at(columns_.at(column)); }
  double number(const std::string& column) const { return parseNumber(text(column)).value(); }

 private:
  const std::map<std::string, std::size_t>& columns_;
  const std::vector<std::string>& fields_;
};

PageFrame frameOf(const CsvRow& row, double seconds_per_stamp) {
  PageFrame frame;
  frame.number = static_cast<std::size_t>(row.number("frame"));
  frame.seconds = seconds_per_stamp * row.number("timestamp_s");
  frame.status = row.text("status");
  frame.reason = row.text("reason");
  frame.placed = frame.status != "lost" && frame.status != "skipped";
  const Eigen::Quaterniond q(row.number("qw"), row.number("qx"), row.number("qy"), row.number("qz"));
  frame.world_from_camera.linear() = q.normalized().toRotationMatrix();
  frame.world_from_camera.translation() =
      Eigen::Vector3d(row.number("tx_m"), row.number("ty_m"), row.number("tz_m"));
  return frame;
}

SequenceOptions optionsOf(const nlohmann::json& given) {
  SequenceOptions options;
  if (given.contains("intrinsics")) {
    const auto& k = given["intrinsics"];
    options.intrinsics = Intrinsics{0, 0, k.at(0), k.at(1), k.at(2), k.at(3)};
  }
  if (given.contains("depth_units_per_metre"))
    options.depth_units_per_metre = given["depth_units_per_metre"].get<double>();
  options.topic = given.value("topic", "");
  return options;
}

}  // namespace

RunResult readResult(const fs::path& folder) {
  const fs::path report_file = folder / "report.json", frames_file = folder / "frames.csv";
  for (const fs::path& file : {report_file, frames_file})
    if (!fs::is_regular_file(file))
      throw InputError(folder.string() + ": holds no result of 'rosefusion run' (there is no " +
                       file.filename().string() + "); give the folder that a run wrote.");
  RunResult result{.folder = folder};
  double seconds_per_stamp = 1;
  try {
    const auto report = nlohmann::json::parse(readTextFile(report_file));
    result.recording = report.at("sequence").value("path", "");
    seconds_per_stamp = report.at("sequence").value("seconds_per_stamp", 1.0);
    result.opened_with = optionsOf(report.at("sequence").value("given", nlohmann::json::object()));
    if (report.contains("camera")) {
      const auto& k = report["camera"];
      result.camera =
          Intrinsics{k.at("width"), k.at("height"), k.at("fx"), k.at("fy"), k.at("cx"), k.at("cy")};
    }
  } catch (const nlohmann::json::exception& error) {
    throw InputError(report_file.string() + ": is no report of a run (" + error.what() + ").");
  }
  std::istringstream in(readTextFile(frames_file));
  std::string line;
  std::getline(in, line);
  std::map<std::string, std::size_t> columns;
  for (const std::string& name : csvFields(line)) columns.emplace(name, columns.size());
  for (int number = 2; std::getline(in, line); ++number) try {
      result.frames.push_back(frameOf(CsvRow(columns, csvFields(line)), seconds_per_stamp));
    } catch (const std::exception&) {  // a column or a number that is not there
      throw InputError(frames_file.string() + ":" + std::to_string(number) +
                       ": is no line of a run's frames; run it again.");
    }
  return result;
}

std::vector<PageFrame> pageFramesOf(const RunSummary& summary, double seconds_per_stamp) {
  std::vector<PageFrame> frames;
  for (const RunFrame& f : summary.frames) {
    const FrameResult& r = f.result;
    const bool placed = !f.skipped && r.status != TrackingStatus::Lost;
    frames.push_back({f.index, seconds_per_stamp * r.timestamp, f.skipped ? "skipped" : toString(r.status),
                      f.reason(), placed, r.world_from_camera});
  }
  return frames;
}

PageContent pageContentOf(const std::string& title, TriangleMesh mesh, std::vector<PageFrame> frames,
                          const std::optional<Intrinsics>& camera) {
  PageContent content{title, std::move(mesh), std::move(frames)};
  if (camera) {
    content.field_of_view =
        2 * std::atan(camera->height / (2 * std::abs(camera->fy))) * 180 / std::acos(-1.0);
    content.aspect = std::abs(camera->width / camera->fx) / std::abs(camera->height / camera->fy);
  }
  return content;
}

}  // namespace rosefusion
