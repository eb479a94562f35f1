// rosefusion check: looks through a sequence and says what is wrong with it before any time is spent on it.

#include <algorithm>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <sstream>

#include "apps/cli/commands.h"
#include "apps/cli/progress.h"
#include "apps/cli/validators.h"
#include "host/core/error.h"
#include "host/core/number_text.h"
#include "host/datasets/inspection.h"
#include "host/run/scene_of_source.h"
#include "host/sources/sequence_source.h"

namespace rosefusion::cli {
namespace {

struct CheckOptions {
  std::string sequence;
  std::string json;
  std::size_t max_frames = 0;
  std::vector<double> intrinsics;  // fx fy cx cy, or empty
  double depth_units_per_metre = 0;
};

/// One line of the report: a label and its text.
void line(std::ostream& out, const char* label, const std::string& text) {
  out << "  " << label << std::string(16 - std::string(label).size(), ' ') << text << '\n';
}

/// "2 of 54 images looked at (frames 9, 18)"; a long list is cut, as the JSON has all of it.
std::string unreadable(const Inspection& r) {
  constexpr std::size_t kShown = 8;
  std::string text = std::to_string(r.unreadable.size()) + " of " +
                     std::to_string(r.unreadable.size() + r.images_read) + " images looked at";
  for (std::size_t i = 0; i < std::min(kShown, r.unreadable.size()); ++i)
    text += (i == 0 ? " (frames " : ", ") + std::to_string(r.unreadable[i].index);
  if (r.unreadable.size() > kShown) text += ", ...";
  return r.unreadable.empty() ? text : text + ")";
}

/// "0.6 mm at 0.50 m, 1.4 mm at 0.98 m: like a kinect1's"
std::string noiseOf(const std::optional<SceneMeasures>& scene, const Settings& settings) {
  if (!scene || scene->flat.empty()) return "not measured: too few flat surfaces in the first images";
  std::string text;
  for (const SceneMeasures::Deviation& at : scene->flat)
    text += printed("%s%.1f mm at %.2f m", text.empty() ? "" : ", ", 1000 * at.deviation, at.depth);
  const SensorModel* model = sensorModel(settings.depth.sensor);
  return text + (model ? printed(": like a %s's", model->name) : ": like no sensor's that is known");
}

std::string describe(const SequenceInfo& info, const Inspection& r, const std::optional<SceneMeasures>& scene,
                     const Settings& settings) {
  TextStream out;
  const Intrinsics& k = info.intrinsics;
  out << info.path.string() << '\n';
  line(out, "format", info.format);
  line(out, "frames", printed("%zu in %.1f s, %.1f per second", r.frames, r.seconds, r.frames_per_second));
  line(out, "images",
       printed("%dx%d, %s", k.width, k.height, info.has_colour ? "depth and colour" : "depth only"));
  line(out, "intrinsics",
       printed("fx %g, fy %g, cx %g, cy %g (%s", k.fx, k.fy, k.cx, k.cy,
               info.intrinsics_assumed ? "assumed: " : "") +
           info.intrinsics_source + ")");
  line(out, "depth scale",
       printed("%g units per metre%s", info.depth_units_per_metre,
               info.depth_units_assumed ? (" (assumed: as " + info.format + " has it)").c_str() : ""));
  if (r.images_read > 0)
    line(out, "valid depth",
         printed("%.0f %% of the pixels (median), %.0f %% in the worst frame (%zu)",
                 100 * r.valid_share_median, 100 * r.valid_share_worst, r.worst_frame));
  if (const auto& d = r.depth)
    line(out, "depth range",
         printed("%.2f to %.2f m for 98 %% of the pixels, median %.2f m", d->p1, d->p99, d->p50));
  if (r.images_read > 0) {
    line(out, "depth noise", noiseOf(scene, settings));
    line(out, "voxels",
         printed("%g cm, truncated at %g cm", 100 * settings.volume.voxel_size,
                 100 * settings.volume.truncation));
  }
  if (info.truth.empty())
    line(out, "truth", "none");
  else
    line(out, "truth",
         printed("%zu poses, covers %zu of %zu frames", info.truth.size(), r.frames_with_truth, r.frames));
  if (const auto& s = r.speeds)
    line(out, "camera speed",
         printed("%.2f m/s mean, %.2f max; %.2f rad/s mean, %.2f max", s->linear_mean, s->linear_max,
                 s->angular_mean, s->angular_max));
  line(out, "unreadable", unreadable(r));
  line(out, "gaps in time", printed("%zu", r.gaps.size()));
  for (const std::string& note : info.notes) line(out, "note", note);
  out << '\n' << (r.findings.empty() ? "Nothing looks wrong.\n" : "What looks wrong:\n");
  for (const Finding& finding : r.findings) {
    out << (finding.fatal ? "  [error] " : "  [warning] ") << finding.what << '\n';
    if (!finding.remedy.empty()) out << "      -> " << finding.remedy << '\n';
  }
  return out.str();
}

/// Of the frames that a run begins with.
std::optional<SceneMeasures> surveyOf(Sequence& sequence, const Settings& settings) {
  PeekedSource source(
      std::make_unique<SequenceSource>(sequence, RunOptions{.max_frames = 2 * kSurveyedFrames}));
  return sceneOf(source, settings);
}

nlohmann::ordered_json toJson(const SequenceInfo& info, const Inspection& r,
                              const std::optional<SceneMeasures>& scene, const Settings& settings) {
  const Intrinsics& k = info.intrinsics;
  nlohmann::ordered_json json{
      {"path", info.path.string()},
      {"format", info.format},
      {"usable", r.usable()},
      {"frames", r.frames},
      {"seconds", r.seconds},
      {"frames_per_second", r.frames_per_second},
      {"has_colour", info.has_colour},
      {"intrinsics",
       {{"width", k.width},
        {"height", k.height},
        {"fx", k.fx},
        {"fy", k.fy},
        {"cx", k.cx},
        {"cy", k.cy},
        {"assumed", info.intrinsics_assumed},
        {"source", info.intrinsics_source}}},
      {"depth_units_per_metre", info.depth_units_per_metre},
      {"depth_units_assumed", info.depth_units_assumed},
      {"images_read", r.images_read},
      {"valid_share",
       {{"median", r.valid_share_median}, {"worst", r.valid_share_worst}, {"worst_frame", r.worst_frame}}},
      {"empty_frames", r.empty_frames},
      {"flat_frames", r.flat_frames},
      {"repeated_images", r.repeated_images},
      {"repeated_stamps", r.repeated_stamps},
      {"truth", {{"poses", info.truth.size()}, {"frames_covered", r.frames_with_truth}}}};
  if (const auto& d = r.depth)
    json["depth_m"] = {{"p1", d->p1}, {"p5", d->p5}, {"p50", d->p50}, {"p95", d->p95}, {"p99", d->p99}};
  json["voxel_size_m"] = settings.volume.voxel_size;
  json["truncation_m"] = settings.volume.truncation;
  json["sensor"] = fieldText(settings, "depth.sensor", "check");
  json["flat_deviation_m"] = nlohmann::ordered_json::array();
  if (scene)
    for (const SceneMeasures::Deviation& at : scene->flat)
      json["flat_deviation_m"].push_back({{"depth", at.depth}, {"deviation", at.deviation}});
  if (const auto& s = r.speeds)
    json["speed"] = {{"linear_mean_m_s", s->linear_mean},
                     {"linear_max_m_s", s->linear_max},
                     {"angular_mean_rad_s", s->angular_mean},
                     {"angular_max_rad_s", s->angular_max}};
  json["unreadable"] = nlohmann::ordered_json::array();
  for (const UnreadableFrame& frame : r.unreadable)
    json["unreadable"].push_back({{"frame", frame.index}, {"problem", frame.problem}});
  json["gaps"] = nlohmann::ordered_json::array();
  for (const TimeGap& gap : r.gaps)
    json["gaps"].push_back({{"after_frame", gap.after_frame}, {"seconds", gap.seconds}});
  json["notes"] = info.notes;
  json["findings"] = nlohmann::ordered_json::array();
  for (const Finding& finding : r.findings)
    json["findings"].push_back(
        {{"fatal", finding.fatal}, {"what", finding.what}, {"remedy", finding.remedy}});
  return json;
}

void check(const CheckOptions& options) {
  SequenceOptions open;
  open.colour = true;
  if (const auto& v = options.intrinsics; !v.empty())
    open.intrinsics = Intrinsics{0, 0, v[0], v[1], v[2], v[3]};
  if (options.depth_units_per_metre != 0) open.depth_units_per_metre = options.depth_units_per_metre;
  const auto sequence = openSequence(options.sequence, open);
  const Settings settings = loadSettings("default");  // what a run uses
  Inspection inspection = [&] {
    Progress progress("depth images");
    return inspectSequence(*sequence, options.max_frames,
                           [&](std::size_t done, std::size_t total) { progress.update(done, total); },
                           {settings.depth.min, settings.depth.max});
  }();
  const Intrinsics& k = sequence->info().intrinsics;
  try {
    requireImagesFit(settings, k.width, k.height);
  } catch (const InputError& error) {
    inspection.findings.push_back({true, error.what(), ""});
  }
  const std::optional<SceneMeasures> scene = surveyOf(*sequence, settings);
  // With the JSON on standard output, people read standard error.
  std::fputs(describe(sequence->info(), inspection, scene, resolved(settings, scene)).c_str(),
             options.json == "-" ? stderr : stdout);
  writeJson(options.json, toJson(sequence->info(), inspection, scene, resolved(settings, scene)).dump(2));
  if (!inspection.usable())
    throw InputError(options.sequence + ": not usable as it is; change what is marked [error] above.");
}

}  // namespace

void addCheckCommand(CLI::App& app) {
  const auto options = std::make_shared<CheckOptions>();
  CLI::App* command =
      app.add_subcommand("check", "Look through a sequence and say what is wrong and what to change");
  command
      ->add_option("SEQUENCE", options->sequence,
                   "folder (TUM, ETH3D, ICL-NUIM, 7-Scenes, Replica, FastCaMo, "
                   "PNGs with a sequence.yaml) or packed .seq file")
      ->required();
  command->add_option("--json", options->json,
                      "also write everything as JSON to this file ('-': standard output)");
  command
      ->add_option(
          "--max-frames", options->max_frames,
          "look at this many depth images only, spread over the sequence (stamps and truth: always all)")
      ->check(positive());
  command->add_option("--intrinsics", options->intrinsics, "fx,fy,cx,cy in pixels instead of the data's own")
      ->delimiter(',')
      ->expected(4);
  command
      ->add_option("--depth-units-per-metre", options->depth_units_per_metre,
                   "instead of the data set's own, such as 1000 for millimetres")
      ->check(positive());
  command->footer(
      "Examples:\n"
      "  rosefusion check rgbd_dataset_freiburg1_rpy\n"
      "  rosefusion check my_recording --max-frames 100 --json check.json\n"
      "  rosefusion check my_recording --intrinsics 525,525,319.5,239.5 --depth-units-per-metre 1000\n"
      "Exit code: 0 when usable (warnings allowed), 2 when not.");
  command->callback([options] { check(*options); });
}

}  // namespace rosefusion::cli
