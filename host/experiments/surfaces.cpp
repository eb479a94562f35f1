// Table comp-fcm-real and figures gallery and teaser: the reconstructed surfaces.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "host/core/log_to_spdlog.h"
#include "host/evaluation/alignment.h"
#include "host/evaluation/mesh_error.h"
#include "host/experiments/families.h"
#include "host/experiments/quoted.h"
#include "host/experiments/runs.h"
#include "host/run/preview.h"
#include "host/slam/mapping/mesh_extraction.h"

namespace rosefusion {
namespace {

constexpr double kLever_m = 1;  // see alignPoses: the surface counts, not the camera's place alone

std::vector<TestSequence> someRooms(const ExperimentContext& context) {
  std::vector<TestSequence> rooms = fastRooms(context);
  rooms.resize(std::min<std::size_t>(rooms.size(), static_cast<std::size_t>(context.amount(10, 2))));
  return rooms;
}

/// Runs `test` and hands over the pipeline with its model.
void reconstructWith(const ExperimentContext& context, const Variant& method, const TestSequence& test,
                     const std::function<void(Pipeline&, const RunSummary&, const MemorySequence&)>& use) {
  const auto sequence = std::dynamic_pointer_cast<MemorySequence>(test.open());
  const SequenceInfo& info = sequence->info();
  Pipeline pipeline(context.device, settingsOf(context, method), info.intrinsics, info.depth_units_per_metre,
                    logToSpdlog);
  SequenceSource source(*sequence, test.run);
  const RunSummary summary = reconstruct(
      source, pipeline, 0,
      [&](const RunProgress&) {
        if (context.progress) context.progress(1, method.name + ", " + test.name);
      },
      context.stop);
  if (summary.end == RunEnd::Interrupted) throw Interrupted{};
  use(pipeline, summary, *sequence);
}

const std::vector<Variant>& surfaceMethods() {
  static const std::vector<Variant> all = {pst(), ours(), {"icp", {"tracking.method=icp"}}};
  return all;
}

int surfaceWork(const ExperimentContext& context) {
  const auto rooms = someRooms(context);
  return static_cast<int>(rooms.size() * rooms[0].frames * surfaceMethods().size());
}

ExperimentResult runSurfaces(const ExperimentContext& context) {
  ResultWriter out(context, "surfaces");
  Table table({"sequence", "method", "completeness_15cm_percent", "accuracy_within_15cm_cm",
               "completeness_5cm_percent", "accuracy_cm", "lost"});
  Table bars({"sequence", "pst", "default", "icp", "pst_cm", "default_cm", "icp_cm"});
  std::vector<double> complete(surfaceMethods().size(), 0.0), accurate(surfaceMethods().size(), 0.0);
  const std::vector<TestSequence> rooms = someRooms(context);
  for (const TestSequence& room : rooms) {
    std::vector<double> of_room;
    std::vector<double> errors_of_room;
    for (std::size_t m = 0; m < surfaceMethods().size(); ++m)
      reconstructWith(
          context, surfaceMethods()[m], room,
          [&](Pipeline& pipeline, const RunSummary& summary, const MemorySequence& sequence) {
            const MeshSettings& mesh = pipeline.settings().mesh;
            ExtractPass extract(context.device);
            const TriangleMesh surface = extractMesh(
                extract, pipeline.volume(),
                {static_cast<float>(mesh.min_weight), static_cast<std::size_t>(mesh.min_component)});
            MeshErrorOptions options;
            options.samples = static_cast<std::size_t>(context.amount(200000, 40000));
            options.seed = context.options.seed;
            options.truth_from_reconstruction =
                alignPoses(
                    associate(trajectoryOf(summary), sequence.info().truth, Association::Nearest, 0.02),
                    kLever_m)
                    .truth_from_estimate;
            const MeshErrors errors = measureMesh(surface, sequence.seen(), options);
            of_room.push_back(100 * errors.scores.back().completeness);
            errors_of_room.push_back(100 * errors.inlier_accuracy_m.rmse);
            complete[m] += of_room.back() / static_cast<double>(rooms.size());
            accurate[m] += errors_of_room.back() / static_cast<double>(rooms.size());
            table.add({room.name, surfaceMethods()[m].name, of_room.back(), errors_of_room.back(),
                       100 * errors.scores.front().completeness, 100 * errors.accuracy_m.rmse,
                       double(summary.count(TrackingStatus::Lost))});
          });
    bars.add({room.name, of_room[0], of_room[1], of_room[2], errors_of_room[0], errors_of_room[1],
              errors_of_room[2]});
  }
  out.table("surfaces", table);
  out.table("quoted", quotedTable("tab:comp-fcm-real"));
  Plot plot;
  plot.width_px = 1500;
  plot.height_px = 560;
  plot.tables["bars.dat"] = bars.plotData();
  plot.commands =
      "set multiplot layout 1,2\nset style data histograms\nset style histogram clustered gap 1\nset "
      "boxwidth 0.9\nset xlabel "
      "\"sequence\"\nset yrange [0:105]\nset ylabel \"completeness within 15 cm (%)\"\nplot \"bars.dat\" "
      "using 2:xticlabels(1) linetype 1 "
      "fillstyle solid 0.85 title \"pst\", \"\" using 3 linetype 6 fillstyle solid 0.4 title \"default\", "
      "\"\" using 4 linetype 3 fillstyle "
      "pattern 4 title \"icp\"\nset yrange [0:*]\nset ylabel \"RMS distance of what lies within 15 cm "
      "(cm)\"\nplot \"bars.dat\" using "
      "5:xticlabels(1) linetype 1 fillstyle solid 0.85 title \"pst\", \"\" using 6 linetype 6 fillstyle "
      "solid 0.4 title \"default\", \"\" using "
      "7 linetype 3 fillstyle pattern 4 title \"icp\"\n";
  out.plot(
      "surfaces", plot,
      "Completeness and accuracy of the reconstructed surface against the true surface that the camera saw.");
  double worst_quoted = 0;
  for (const QuotedFigure& f : quotedFigures())
    if (f.label == "tab:comp-fcm-real" && f.system == "ROSEFusion" && f.quantity == "accuracy")
      worst_quoted = std::max(worst_quoted, f.value);
  out.result.ran = fmt::format(
      "{} generated flights of {} frames at up to 4 m/s, each method's mesh against the part of the "
      "true surface that the camera saw; {} samples on each.",
      rooms.size(), rooms[0].frames, context.amount(200000, 40000));
  out.result.paper =
      "On FastCaMo-Real far more complete than the others, at a like accuracy of what lies within 15 cm. "
      "Means of its table: " +
      quotedMeans("tab:comp-fcm-real") + ".";
  out.result.verdicts = {mostOf("pst's surface is more complete than the classical method's", " %",
                                {"pst", complete[0]}, {{"icp", complete[2]}}),
                         within("pst's accuracy within 15 cm is no worse than the paper's worst", " cm",
                                {"pst", accurate[0]}, worst_quoted),
                         mostOf("this program's default method is as complete as pst (within 2 %)", " %",
                                {"default", complete[1]}, {{"pst", complete[0]}}, 0.02)};
  return out.result;
}

/// Speed at each pose, m/s, over the poses around it.
std::vector<double> speedsOf(const Trajectory& trajectory) {
  std::vector<double> speeds;
  for (std::size_t i = 0; i < trajectory.size(); ++i) {
    const StampedPose &a = trajectory[i > 0 ? i - 1 : 0],
                      &b = trajectory[std::min(i + 1, trajectory.size() - 1)];
    const double seconds = b.timestamp - a.timestamp;
    speeds.push_back(
        seconds > 0 ? (b.world_from_camera.translation() - a.world_from_camera.translation()).norm() / seconds
                    : 0);
  }
  return speeds;
}

/// The picture above a bar that explains the path's shades.
cv::Mat withSpeedBar(const cv::Mat& picture, double fastest) {
  constexpr int kBar = 64, kLeft = 260;
  cv::Mat out(picture.rows + kBar, picture.cols, CV_8UC3, cv::Scalar::all(255));
  picture.copyTo(out.rowRange(0, picture.rows));
  const int width = picture.cols - 2 * kLeft, top = picture.rows + 8;
  cv::Mat ramp(1, width, CV_8UC1), colours;
  for (int i = 0; i < width; ++i) ramp.at<std::uint8_t>(i) = static_cast<std::uint8_t>(255 * i / width);
  cv::applyColorMap(ramp, colours, cv::COLORMAP_VIRIDIS);
  for (int row = 0; row < 20; ++row) colours.copyTo(out(cv::Rect(kLeft, top + row, width, 1)));
  const auto label = [&](const std::string& text, int x, int y) {
    cv::putText(out, text, {x, y}, cv::FONT_HERSHEY_SIMPLEX, 0.6, cv::Scalar::all(30), 1, cv::LINE_AA);
  };
  label("camera's speed (m/s)", 20, top + 16);
  for (int i = 0; i <= 4; ++i)
    label(fmt::format("{:.1f}", fastest * i / 4), kLeft - 14 + width * i / 4, top + 44);
  return out;
}

int galleryWork(const ExperimentContext& context) {
  const auto rooms = someRooms(context);
  return static_cast<int>(rooms.size() * rooms[0].frames);
}

ExperimentResult runGallery(const ExperimentContext& context) {
  ResultWriter out(context, "gallery");
  Table table({"sequence", "time_s", "x_m", "y_m", "z_m", "speed_m_per_s", "true_speed_m_per_s"});
  double worst = 0, fastest_of_all = 0;
  const std::vector<TestSequence> rooms = someRooms(context);
  for (const TestSequence& room : rooms)
    reconstructWith(
        context, ours(), room,
        [&](Pipeline& pipeline, const RunSummary& summary, const MemorySequence& sequence) {
          const Trajectory path = trajectoryOf(summary);
          const std::vector<double> speeds = speedsOf(path), true_speeds = speedsOf(sequence.info().truth);
          const double fastest = *std::max_element(speeds.begin(), speeds.end());
          fastest_of_all = std::max(fastest_of_all, fastest);
          std::vector<double> shades;
          for (std::size_t i = 0; i < path.size(); ++i) {
            shades.push_back(speeds[i] / fastest);
            const Eigen::Vector3d& p = path[i].world_from_camera.translation();
            // Only where no frame is missing are the two sums over the same time.
            const bool whole = path.size() == true_speeds.size();
            if (whole) worst = std::max(worst, std::abs(speeds[i] - true_speeds[i]));
            table.add({room.name, path[i].timestamp, p.x(), p.y(), p.z(), speeds[i],
                       whole ? Cell(true_speeds[i]) : Cell("")});
          }
          std::vector<std::uint8_t> png;
          cv::imencode(".png", withSpeedBar(renderOverview(pipeline, path, shades), fastest), png);
          out.picture(
              room.name, {reinterpret_cast<const char*>(png.data()), png.size()},
              fmt::format(
                  "{}: the model from above and the camera's path, dark where slow and bright where fast.",
                  room.name));
        });
  out.table("gallery", table);
  out.result.ran = fmt::format("{} generated flights of {} frames, tracked by this program's default method.",
                               rooms.size(), rooms[0].frames);
  out.result.paper =
      "Whole rooms are reconstructed from cameras at up to 3.6 m/s and more; the path is coloured by the "
      "estimated speed.";
  out.result.verdicts = {
      mostOf("a camera this fast is followed through the room", " m/s",
             {"largest estimated speed", fastest_of_all}, {{"wanted", 3.6}}),
      within("the estimated speed is the true one", " m/s", {"largest difference", worst}, 0.5)};
  return out.result;
}

}  // namespace

Experiment surfaces() {
  return {"surfaces", "Reconstructed surfaces", "Table comp-fcm-real", surfaceWork, runSurfaces};
}
Experiment gallery() {
  return {"gallery", "Gallery", "Figures gallery and teaser", galleryWork, runGallery};
}

}  // namespace rosefusion
