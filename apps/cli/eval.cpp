// rosefusion eval: how far an estimated trajectory is from the truth.
#include <spdlog/fmt/fmt.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <memory>
#include <string>
#include <system_error>

#include "apps/cli/commands.h"
#include "apps/cli/validators.h"
#include "host/core/error.h"
#include "host/core/file_io.h"
#include "host/datasets/sequence.h"
#include "host/evaluation/report_json.h"
#include "host/evaluation/trajectory_error.h"
#include "host/evaluation/trajectory_plot.h"

namespace rosefusion::cli {
namespace {

namespace fs = std::filesystem;

struct EvalArguments {
  fs::path estimate;
  fs::path truth;
  std::string json;
  fs::path plot;
  bool interpolate = false;
  TrajectoryErrorOptions options;
};

/// `path`, or the trajectory in it when it is a folder.
fs::path estimateIn(const fs::path& path) {
  std::error_code unknown;
  if (!fs::is_directory(path, unknown)) return path;
  if (!fs::exists(path / "trajectory.txt", unknown))
    throw InputError(path.string() +
                     ": the folder has no trajectory.txt; give a trajectory file in TUM format instead.");
  return path / "trajectory.txt";
}

Trajectory readPoses(const fs::path& file) {
  Trajectory trajectory = readTumTrajectory(file);
  if (const std::size_t repeated = repeatedStamps(trajectory); repeated > 0)
    spdlog::warn("{}: {} of {} poses have the time stamp of another, and which of them counts is chance; {}",
                 file.string(), repeated, trajectory.size(),
                 2 * repeated > trajectory.size()
                     ? "the stamps' decimals were lost: write them with six, in seconds."
                     : "leave one pose for each time (do two runs share the file?).");
  if (trajectory.empty())
    throw InputError(file.string() + ": has no poses; expected lines 't tx ty tz qx qy qz qw'.");
  return trajectory;
}

/// The truth in a file or in a sequence's folder, whose stamps may be frame numbers. `arguments.truth`
/// becomes the file where there is one.
Trajectory readTruth(EvalArguments& arguments) {
  std::error_code unknown;
  const fs::path path = arguments.truth;
  if (!fs::is_directory(path, unknown)) return readPoses(path);
  const bool has_file = fs::exists(path / "groundtruth.txt", unknown);
  if (has_file) arguments.truth = path / "groundtruth.txt";
  std::unique_ptr<Sequence> sequence;
  try {
    sequence = openSequence(path);
  } catch (const InputError&) {
    if (!has_file)
      throw InputError(path.string() +
                       ": the folder has no groundtruth.txt and cannot be opened as a sequence ('rosefusion "
                       "check' says why); give a trajectory file in TUM format instead.");
  }
  if (sequence) arguments.options.seconds_per_stamp = sequence->info().seconds_per_stamp;
  if (has_file) return readPoses(arguments.truth);
  if (sequence->info().truth.empty())
    throw InputError(path.string() + ": the sequence (" + sequence->info().format +
                     ") comes without a true trajectory; give one as a file in TUM format instead.");
  return sequence->info().truth;
}

/// The number of frames that `rosefusion run` noted beside its trajectory, or 0.
std::size_t framesOfReport(const fs::path& estimate) {
  if (estimate.filename() != "trajectory.txt") return 0;
  const fs::path file = estimate.parent_path() / "report.json";
  if (std::error_code error; !fs::exists(file, error)) return 0;
  const auto report = nlohmann::json::parse(readFile(file), nullptr, false);
  if (!report.is_object() || !report.contains("frames") || !report["frames"].is_number_unsigned()) return 0;
  return report["frames"].get<std::size_t>();
}

/// Where the truth was to be interpolated: how far its poses are apart.
void requireInterpolated(const TrajectoryErrors& errors, const EvalArguments& arguments,
                         const Trajectory& estimate, const Trajectory& truth) {
  if (errors.common_poses >= kFewestCommonPoses) return;
  std::vector<double> gaps;
  for (std::size_t i = 1; i < truth.size(); ++i) gaps.push_back(truth[i].timestamp - truth[i - 1].timestamp);
  std::sort(gaps.begin(), gaps.end());
  const double unit = arguments.options.seconds_per_stamp,
               gap = gaps.empty() ? 0 : unit * gaps[gaps.size() / 2];
  throw InputError(fmt::format(
      "{}: {} of its {} stamps (they run from {:.3f} to {:.3f}) lie between two poses of {} ({:.3f} to "
      "{:.3f}) "
      "that are at "
      "most {:g} s apart, as --interpolate asks; the truth's are usually {:.3g} s apart: {}.",
      arguments.estimate.string(), errors.common_poses, estimate.size(), estimate.front().timestamp,
      estimate.back().timestamp, arguments.truth.string(), truth.front().timestamp, truth.back().timestamp,
      2 * arguments.options.max_difference_s, gap,
      gap > 2 * arguments.options.max_difference_s
          ? fmt::format("raise --max-difference to {:.3g}, or leave out --interpolate", 0.51 * gap)
          : "check the unit of the stamps and that both are of the same sequence"));
}

void requireCommonPoses(const TrajectoryErrors& errors, const EvalArguments& arguments,
                        const Trajectory& estimate, const Trajectory& truth) {
  if (arguments.interpolate) return requireInterpolated(errors, arguments, estimate, truth);
  if (errors.common_poses < kFewestCommonPoses)
    throw InputError(fmt::format(
        "{}: {} of {} stamps (they run from {:.3f} to {:.3f}) lie within {} s of one in {} "
        "({:.3f} to {:.3f}), and fewer than {} poses always align; check the unit of the stamps "
        "and that both are of the same sequence, or raise --max-difference.",
        arguments.estimate.string(), errors.common_poses, estimate.size(), estimate.front().timestamp,
        estimate.back().timestamp, arguments.options.max_difference_s, arguments.truth.string(),
        truth.front().timestamp, truth.back().timestamp, kFewestCommonPoses));
  if (2 * errors.common_poses < errors.estimate_poses)
    spdlog::warn("{}: only {} of {} poses have a true one; check the unit of the stamps.",
                 arguments.estimate.string(), errors.common_poses, errors.estimate_poses);
}

std::string row(const char* name, const ErrorSummary& summary, double factor, const char* unit) {
  if (summary.count == 0) return fmt::format("  {:<25} {:>10}\n", name, "none");
  return fmt::format("  {:<25} {:>10.3f} {:>10.3f} {:>10.3f} {:>10.3f}  {}\n", name, factor * summary.rmse,
                     factor * summary.mean, factor * summary.median, factor * summary.max, unit);
}

std::string table(const TrajectoryErrors& errors, const EvalArguments& arguments) {
  std::string text =
      fmt::format("Estimate  {}\nTruth     {}\n", arguments.estimate.string(), arguments.truth.string());
  text += fmt::format("Frames    {}, {} lost ({})\n", errors.frames, errors.lost_frames, errors.frames_basis);
  text += fmt::format("Paired    {}\nAligned   {}\n\n", errors.association, errors.alignment.description);
  text += fmt::format("  {:<25} {:>10} {:>10} {:>10} {:>10}\n", "", "RMSE", "mean", "median", "max");
  text += row("ATE (aligned)", errors.ate_m, 100, "cm");
  text += row("TE (from first pose)", errors.te_m, 100, "cm");
  text += row("RPE pose to pose", errors.rpe_frame_m, 100, "cm");
  text += row("", errors.rpe_frame_deg, 1, "deg");
  text += row("RPE per second", errors.rpe_second_m, 100, "cm/s");
  text += row("", errors.rpe_second_deg, 1, "deg/s");
  text += fmt::format("\n  {:<25}", "TE under");
  for (const double threshold_m : kTeThresholds_m) text += fmt::format("{:>6.0f} cm", 100 * threshold_m);
  text += fmt::format("\n  {:<25}", "share of frames");
  for (const double share : errors.te_share) text += fmt::format("{:>7.1f} %", 100 * share);
  return text + "  (lost frames count as failures)\n";
}

void evaluate(EvalArguments arguments) {
  arguments.estimate = estimateIn(arguments.estimate);
  const Trajectory estimate = readPoses(arguments.estimate);
  Trajectory truth = readTruth(arguments);
  TrajectoryErrorOptions& options = arguments.options;
  if (arguments.interpolate) options.association = Association::Interpolated;
  if (options.sequence_frames > 0 && options.sequence_frames < estimate.size())
    throw InputError(
        fmt::format("--frames {}: {} has more poses than that ({}); give the number of frames that the "
                    "sequence has.",
                    options.sequence_frames, arguments.estimate.string(), estimate.size()));
  if (options.sequence_frames == 0) options.sequence_frames = framesOfReport(arguments.estimate);

  TrajectoryErrors errors = measureTrajectory(estimate, truth, options);
  requireCommonPoses(errors, arguments, estimate, truth);
  if (arguments.json != "-") std::cout << table(errors, arguments) << std::flush;
  if (const std::string doubt = scaleDoubt(errors); !doubt.empty()) spdlog::warn("{}", doubt);
  writeJson(arguments.json, toJson(errors).dump(2));
  if (arguments.plot.empty()) return;
  // The plot's time axis is in seconds.
  for (FrameError& frame : errors.per_frame) frame.poses.timestamp *= options.seconds_per_stamp;
  for (StampedPose& pose : truth) pose.timestamp *= options.seconds_per_stamp;
  plotTrajectoryErrors(errors, truth, arguments.estimate.string(), arguments.plot);
}

}  // namespace

void addEvalCommand(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("eval",
                         "Compare a trajectory with the truth.\n"
                         "ATE: distance of the camera positions after rigid alignment (RMSE: as the TUM "
                         "tools and evo report it; mean: as "
                         "the ROSEFusion paper does). TE: distance without alignment, both trajectories "
                         "starting at their first common "
                         "pose. RPE: error of the motion from pose to pose and over one second.");
  const auto arguments = std::make_shared<EvalArguments>();
  command
      ->add_option("ESTIMATE", arguments->estimate, "Trajectory in TUM format, or a folder that `run` wrote")
      ->required();
  command
      ->add_option("TRUTH", arguments->truth,
                   "Trajectory in TUM format, or a folder: groundtruth.txt in it, or a sequence with truth")
      ->required();
  command->add_option("--json", arguments->json,
                      "Write the figures as JSON ('-': to standard output, no table)");
  command->add_option("--plot", arguments->plot,
                      "Draw both trajectories and the errors over time (PNG, by gnuplot)");
  command
      ->add_option("--max-difference", arguments->options.max_difference_s,
                   "Largest difference of paired stamps in seconds (evo's default is 0.01)")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  command->add_flag("--interpolate", arguments->interpolate,
                    "Interpolate the truth at the estimate's stamps instead of taking the nearest pose");
  command
      ->add_option(
          "--frames", arguments->options.sequence_frames,
          "Frames of the sequence; those without a pose count as lost (default: from the report.json that "
          "`run` wrote beside the trajectory, else worked out from the stamps)")
      ->check(positive());
  command->footer(
      "Examples:\n"
      "  rosefusion eval out sequence\n"
      "  rosefusion eval out/trajectory.txt groundtruth.txt --plot errors.png --json errors.json\n"
      "  rosefusion eval other.txt groundtruth.txt --max-difference 0.01 --frames 722");
  command->callback([arguments] { evaluate(*arguments); });
}

}  // namespace rosefusion::cli
