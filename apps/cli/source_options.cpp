#include "apps/cli/source_options.h"

#include <spdlog/spdlog.h>

#include <algorithm>

#include "apps/cli/interrupt.h"
#include "apps/cli/validators.h"

namespace rosefusion::cli {

void SourceArguments::addTo(CLI::App& command) {
  command
      .add_option(
          "SOURCE", source,
          "Folder (TUM RGB-D, ETH3D, ICL-NUIM, 7-Scenes, Replica, FastCaMo, ScanNet, Open3D, Stray Scanner, "
          "PNGs "
          "with sequence.yaml), file (.bag, .db3, .mcap, .mkv, .sens, .klg, .r3d, .seq), or camera "
          "(openni2:, "
          "realsense:, k4a:)")
      ->required();
  command.add_flag(
      "--realtime", realtime,
      "Take a recording at the speed it was made with, and drop what comes too fast, as of a camera");
  command
      .add_option("--start", selection.start,
                  "Leave out the first N frames, such as those of a warming camera")
      ->check(CLI::Range(0, 1000000000));
  command.add_option("--stride", selection.stride, "Take every K-th frame")->check(CLI::Range(1, 1000000));
  command.add_option("--max-frames", selection.max_frames, "Stop after N frames; 0: all")
      ->check(CLI::Range(0, 1000000000));
  command.add_option("--intrinsics", intrinsics, "fx,fy,cx,cy in pixels, instead of the source's own")
      ->delimiter(',')
      ->expected(4);
  command
      .add_option("--depth-units-per-metre,--depth-scale", depth_scale,
                  "Depth units per metre, instead of the sequence's own")
      ->check(positive());
  command.add_option("--topic", topic,
                     "Topic of the depth images in a ROS recording; else the first that says depth");
  command.add_option("--secret-key", stream.secret_key,
                     "Encrypt the network stream: this side's file from 'rosefusion keys'");
  command.add_option("--peer-key", stream.peer_keys,
                     "The other side's public key; for 'run' one a line, and only those may send");
}

SourceOptions SourceArguments::options(bool colour) const {
  SourceOptions out;
  out.sequence.colour = colour;
  if (!intrinsics.empty())
    out.sequence.intrinsics = Intrinsics{0, 0, intrinsics[0], intrinsics[1], intrinsics[2], intrinsics[3]};
  if (depth_scale > 0) out.sequence.depth_units_per_metre = depth_scale;
  out.sequence.topic = topic;
  out.selection = selection;
  out.pace = realtime ? Pace::Recorded : Pace::AsTaken;
  out.stream = stream;
  return out;
}

OpenedSource openSource(const SourceArguments& arguments, bool colour, const DepthLimits& limits) {
  auto source = rosefusion::openSource(arguments.source, arguments.options(colour), interrupted);
  if (!source) return {};
  std::vector<Finding> findings = source->findings(limits);
  for (const Finding& finding : findings)
    spdlog::warn("{}{}{}", finding.what, finding.remedy.empty() ? "" : "; ", finding.remedy);
  for (const std::string& note : source->info().notes) spdlog::info("{}", note);
  const bool told = std::any_of(findings.begin(), findings.end(),
                                [](const Finding& f) { return f.kind == FindingKind::Intrinsics; });
  if (source->info().intrinsics_assumed && !told)
    spdlog::warn("The intrinsics are assumed ({}); give them with --intrinsics if the result is bent.",
                 source->info().intrinsics_source);
  return {std::move(source), std::move(findings)};
}

}  // namespace rosefusion::cli
