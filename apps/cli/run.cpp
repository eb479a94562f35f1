// rosefusion run: a depth sequence in; trajectory, mesh, preview and report out.
#include <spdlog/spdlog.h>

#include <cstdio>
#include <numbers>

#include "apps/chosen_settings.h"
#include "apps/cli/commands.h"
#include "apps/cli/exit_code.h"
#include "apps/cli/interrupt.h"
#include "apps/cli/progress.h"
#include "apps/cli/source_options.h"
#include "engine/error.h"
#include "host/core/error.h"
#include "host/core/file_io.h"
#include "host/core/log_to_spdlog.h"
#include "host/run/likely_cause.h"
#include "host/run/output.h"
#include "host/run/report.h"
#include "host/run/scene_of_source.h"

namespace rosefusion::cli {
namespace {

struct RunArguments {
  SourceArguments source;
  std::string out;
  std::string config = "default";
  std::string sensor;
  std::vector<std::string> assignments;
  std::string device;
  std::string json;
  bool validation = false;
  bool no_page = false;
};

bool isSame(const std::filesystem::path& a, const std::filesystem::path& b) {
  std::error_code error;  // of what is not there
  return std::filesystem::equivalent(a, b, error);
}

/// Whether an earlier report names another recording. It may name it from another working directory, where
/// the last part of the path has to do.
bool isAnother(const std::filesystem::path& reported, const std::filesystem::path& recording) {
  std::error_code error;
  return std::filesystem::exists(reported, error)
             ? !isSame(reported, recording)
             : settledPath(reported).filename() != settledPath(recording).filename();
}

std::string outputFolder(const RunArguments& o) {
  if (!o.out.empty()) return o.out;
  if (isLiveSource(o.source.source)) return "out/live";
  const std::filesystem::path sequence = settledPath(o.source.source);
  const bool folder = std::filesystem::is_directory(sequence);
  std::filesystem::path out = std::filesystem::path("out") / (folder ? sequence.filename() : sequence.stem());
  if (isSame(out, sequence)) out += "-run";  // of a sequence that lies in out itself
  return out.string();
}

/// Its truth and its mesh may be called like ours.
void requireOtherThanSequence(const std::string& out, const SequenceInfo& info) {
  const std::filesystem::path& path = info.path;
  if (isSame(out, path) || (!std::filesystem::is_directory(path) && isSame(out, path.parent_path())))
    throw InputError(out + ": is the folder of the recording; choose another one with --out.");
}

void printSummary(std::FILE* to, const RunSummary& summary, const SequenceInfo& info,
                  const std::string& out) {
  std::fprintf(to,
               "%zu frames in %.1f s: %zu tracked, %zu uncertain, %zu relocalised, %zu lost, %zu skipped.\n",
               summary.frames.size(), summary.seconds, summary.count(TrackingStatus::Tracked),
               summary.count(TrackingStatus::Uncertain), summary.count(TrackingStatus::Relocalised),
               summary.count(TrackingStatus::Lost), summary.skipped());
  if (const std::size_t dropped = summary.dropped())
    std::fprintf(to, "%zu more frames came while the tracker was busy, and were dropped.\n", dropped);
  for (const RunFrame& f : summary.frames)
    if (!f.skipped && f.result.status == TrackingStatus::Lost) {
      std::fprintf(to, "First lost at frame %zu: %s.\n", f.index, f.reason().c_str());
      break;
    }
  if (summary.loops) {
    std::fprintf(
        to,
        "%zu loops closed (%zu keyframes, %.1f MB; %zu comparisons with old places, %zu without drift).\n",
        summary.loops->closures, summary.loops->keyframes, 1e-6 * double(summary.loops->image_bytes),
        summary.loops->checks, summary.loops->agreements);
    for (const RunFrame& f : summary.frames)
      if (f.result.loop)
        std::fprintf(to, "  at frame %zu with %.2f s: %.1f cm, %.2f degrees\n", f.index,
                     f.result.loop->timestamp, 100 * f.result.loop->shift,
                     f.result.loop->turn * 180 / std::numbers::pi);
  }
  if (const auto errors = errorsOf(summary, info); errors && errors->common_poses >= kFewestCommonPoses)
    std::fprintf(
        to,
        "Against the truth: ATE %.2f cm RMSE, %.2f cm mean; TE %.2f cm RMSE, %.0f %% of the frames under 5 "
        "cm.\n",
        100 * errors->ate_m.rmse, 100 * errors->ate_m.mean, 100 * errors->te_m.rmse,
        100 * errors->te_share[2]);
  if (const auto errors = errorsOf(summary, info); errors && !lostMost(summary))
    if (const std::string doubt = scaleDoubt(*errors); !doubt.empty()) spdlog::warn("{}", doubt);
  std::vector<std::string> files(std::begin(kOutputFiles), std::end(kOutputFiles));
  for (const MapFrames& map : mapsOf(summary))
    for (const char* ending : {".txt", ".ply"}) files.push_back(detachedFile(map.map, ending));
  for (const std::string& file : files)
    if (const auto path = std::filesystem::path(out) / file; std::filesystem::exists(path))
      std::fprintf(to, "  %s\n", path.c_str());
}

[[noreturn]] void throwNothingToWrite(const std::string& source, const RunSummary& summary) {
  if (summary.end == RunEnd::DeviceFull) throw DeviceError(DeviceErrorCode::OutOfMemory, summary.end_reason);
  if (summary.end == RunEnd::Interrupted) {
    spdlog::warn("Interrupted before anything was reconstructed; no files are written.");
    throw ExitCode(kExitInterrupted);
  }
  std::string first = summary.frames.empty() ? "" : summary.frames.front().reason();
  if (first.ends_with('.')) first.pop_back();
  if (!first.empty()) first = " (the first: " + first + ")";
  throw InputError(source + ": no frame could be used" + first +
                   ", so there is nothing to write; look at it with 'rosefusion check', and at depth.min, "
                   "depth.max and volume.voxel_size.");
}

/// `asked` with what suits the source's first images where it is 'auto', and says what that is.
Settings settingsFor(const Settings& asked, PeekedSource& source) {
  const std::optional<SceneMeasures> scene = sceneOf(source, asked, interrupted);
  const Settings settings = resolved(asked, scene);
  for (const std::string& choice : choicesOf(asked, settings, scene)) spdlog::info("{}", choice);
  return settings;
}

void run(const RunArguments& o) {
  const Settings asked = chosenSettings(o.config, o.assignments, o.sensor);
  const bool live = isLiveSource(o.source.source);
  const StreamOptions& stream = o.source.stream;
  if (!isStreamEndpoint(o.source.source) &&
      !(stream.secret_key.empty() && stream.peer_keys.empty() && stream.silence_limit == 0))
    throw InputError(o.source.source +
                     ": is no network stream (tcp://*:PORT); leave out --secret-key, --peer-key and "
                     "--silence-limit.");
  if (live) catchInterrupts();  // before a recording begins, Ctrl-C just ends the program
  auto [opened, findings] = openSource(o.source, asked.volume.colour, {asked.depth.min, asked.depth.max});
  if (!opened) throw ExitCode(kExitInterrupted);
  PeekedSource source(std::move(opened));
  const SequenceInfo& info = source.info();

  requireImagesFit(asked, info.intrinsics.width, info.intrinsics.height);
  const std::string out = outputFolder(o);
  requireOtherThanSequence(out, info);
  const OutputFolder folder(out);
  requireWritableJson(o.json);
  Device device({o.device, o.validation});
  const std::string count = info.frames ? std::to_string(info.frames) + " frames, " : "";
  spdlog::info("{}: {}{}; on {}", info.path.string(), count, info.format, device.info().name);
  const Settings settings = settingsFor(asked, source);
  Pipeline pipeline(device, settings, info.intrinsics, info.depth_units_per_metre, logToSpdlog);

  if (const std::string other = folder.resultOf(); !other.empty() && !live && isAnother(other, info.path))
    spdlog::warn("{}: what lies there is of {} and is replaced; give each its own with --out.", out, other);
  folder.removeEarlier();
  catchInterrupts();
  RunSummary summary;
  {
    Progress progress("frames");
    const auto show = [&](const RunProgress& p) {
      progress.update(p.done, p.total, p.last->skipped ? "skipped" : toString(p.last->result.status));
    };
    summary = reconstruct(source, pipeline, o.source.selection.max_frames, show, interrupted);
  }
  if (pipeline.volume().blockCount() == 0) throwNothingToWrite(o.source.source, summary);
  spdlog::info("writing {}", out);
  folder.write(summary, info, pipeline, !o.no_page);
  writeJson(o.json, reportJson(summary, info, pipeline).dump(2));
  printSummary(o.json == "-" ? stderr : stdout, summary, info, out);
  for (const std::string& message : device.validationMessages()) spdlog::error("{}", message);

  if (summary.end == RunEnd::DeviceFull) {
    spdlog::error("Ended after {} frames: {}", summary.frames.size(), summary.end_reason);
    throw ExitCode(kExitDevice);
  }
  if (summary.end == RunEnd::Interrupted) {
    spdlog::warn("Interrupted after {} frames; the files are complete up to there.", summary.frames.size());
    throw ExitCode(kExitInterrupted);
  }
  if (lostMost(summary)) {
    spdlog::error("{}", likelyCause(summary, findings));
    throw ExitCode(kExitLost);
  }
}

}  // namespace

void addRunCommand(CLI::App& app) {
  auto o = std::make_shared<RunArguments>();
  CLI::App* command = app.add_subcommand(
      "run", "Reconstruct a depth sequence, camera or stream: trajectory, mesh, page, picture and report");
  o->source.addTo(*command);
  command->get_option("SOURCE")->description(command->get_option("SOURCE")->get_description() +
                                             ", or network stream (tcp://*:PORT)");
  command
      ->add_option("--silence-limit", o->source.stream.silence_limit,
                   "End a network stream that is silent for so many seconds; 0: wait for the sender")
      ->check(CLI::NonNegativeNumber);
  command->add_option("--out", o->out,
                      "Output folder (default: out/NAME; out/NAME-run for a sequence that lies there)");
  command->add_option("--config", o->config, "Preset (default, paper) or YAML file")->capture_default_str();
  command->add_option(
      "--sensor", o->sensor,
      "Whose noise the depths have: auto (measured), kinect1, kinect2, azure, d400, l515, f200, "
      "iphone, given");
  command->add_option("--set", o->assignments, "Change one setting: key=value; may be repeated")
      ->allow_extra_args(false);
  command->add_option("--device", o->device, "Device by index, name or type (see 'rosefusion devices')");
  command->add_option("--json", o->json, "Also write the report here; '-': standard output");
  command->add_flag("--no-page", o->no_page,
                    "Leave out view.html, the page that shows the result in a browser");
  command->add_flag("--validation", o->validation, "Run with the Vulkan validation layer (slow)");
  command->footer(
      "Examples:\n"
      "  rosefusion run rgbd_dataset_freiburg1_desk --out out/desk\n"
      "  rosefusion run my_room --config paper --stride 2 --set volume.voxel_size=0.01\n"
      "  rosefusion run 'tcp://*:5555' --out out/live        # what 'rosefusion send' sends\n"
      "Exit codes: 0 finished, 2 bad input, 3 device, 4 most frames were lost (the files are written, and "
      "the likely "
      "cause is\nsaid), 130 interrupted (the files are complete).");
  command->callback([o] { run(*o); });
}

}  // namespace rosefusion::cli
