#include "host/experiments/sequences.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <deque>

#include "host/core/error.h"
#include "host/synth/parallel.h"
#include "host/synth/sequence.h"

namespace rosefusion {
namespace {

namespace fs = std::filesystem;

constexpr int kQuickShrink = 2;  // of the generated images

std::string keyOf(const SynthOptions& o) {
  const auto& k = o.intrinsics;
  return fmt::format(
      "generated {} motion {} frames {} fps {} linear {} {} {} angular {} {} {} ramp {} camera {} {} {} {} "
      "{} {} "
      "depth {} noise {}",
      o.seed, static_cast<int>(o.motion), o.frames, o.fps, o.linear.low, o.linear.mean, o.linear.high,
      o.angular.low, o.angular.mean, o.angular.high, o.ramp, k.width, k.height, k.fx, k.fy, k.cx, k.cy,
      o.max_depth, toString(o.noise));
}

std::shared_ptr<MemorySequence> remembered(const SynthOptions& synth) {
  constexpr std::size_t kKept = 2;  // a full one takes 150 MB
  static std::deque<std::pair<std::string, std::shared_ptr<MemorySequence>>> kept;
  const std::string key = keyOf(synth);
  for (const auto& [name, sequence] : kept)
    if (name == key) return sequence;
  kept.emplace_front(key, std::make_shared<MemorySequence>(synth));
  if (kept.size() > kKept) kept.pop_back();
  return kept.front().second;
}

/// The folder's own name, however its path is written ("a/b/", ".").
std::string nameOf(const fs::path& folder) {
  const fs::path path = fs::absolute(folder).lexically_normal();
  return (path.has_filename() ? path : path.parent_path()).filename().string();
}

/// Opened, if it is a sequence with truth.
std::shared_ptr<Sequence> tryOpen(const fs::path& path) {
  try {
    std::shared_ptr<Sequence> sequence = openSequence(path);
    return sequence->info().truth.empty() ? nullptr : sequence;
  } catch (const InputError&) {
    return nullptr;  // a folder of something else
  }
}

}  // namespace

MemorySequence::MemorySequence(const SynthOptions& options) {
  const SynthPlan plan(options);
  info_.format = "generated";
  info_.path = fmt::format("generated_{}", options.seed);
  info_.intrinsics = options.intrinsics;
  info_.intrinsics_source = "the generator";
  info_.depth_units_per_metre = kSynthDepthUnitsPerMetre;
  info_.frames = plan.truth().size();
  info_.truth = plan.truth();
  frames_.resize(info_.frames);
  std::vector<std::uint8_t> seen(plan.scene().mesh.triangles.size(), 0);
  parallelFor(static_cast<int>(info_.frames), options.threads,
              [&](int i) { frames_[i] = plan.renderFrame(i, &seen); });
  seen_ = seenPart(plan.scene().mesh, seen);
}

bool MemorySequence::read(std::size_t index, Frame& frame, std::string&) {
  frame = frames_[index];
  return true;
}

TestSequence generated(const std::string& name, const SynthOptions& synth) {
  TestSequence out;
  out.name = name;
  out.key = keyOf(synth);
  out.frames = static_cast<std::size_t>(synth.frames);
  out.open = [synth] { return remembered(synth); };
  return out;
}

SynthOptions experimentSynth(const ExperimentContext& context, int full_frames, int quick_frames) {
  SynthOptions synth;
  synth.frames = std::max(8, context.amount(full_frames, quick_frames));
  if (context.options.quick) synth.intrinsics = {320, 240, 160, 160, 159.5, 119.5};
  return synth;
}

std::vector<TestSequence> fastRooms(const ExperimentContext& context) {
  std::vector<TestSequence> rooms;
  SynthOptions synth = experimentSynth(context, 240, 40);
  for (int i = 0; i < context.amount(10, 2); ++i) {
    synth.seed = 500 + static_cast<std::uint64_t>(i);
    rooms.push_back(generated(fmt::format("room_{}", synth.seed), synth));
  }
  return rooms;
}

std::vector<TestSequence> recordedSequences(const ExperimentContext& context) {
  std::vector<TestSequence> found;
  const fs::path& data = context.options.data;
  if (data.empty()) return found;
  if (!fs::is_directory(data))
    throw InputError(data.string() +
                     ": there is no such folder; --data takes a folder with recorded sequences.");
  std::vector<fs::path> folders = {data};
  for (const auto& entry : fs::directory_iterator(data))
    if (entry.is_directory()) folders.push_back(entry.path());
  std::sort(folders.begin(), folders.end());
  for (const fs::path& folder : folders) {
    const auto sequence = tryOpen(folder);
    if (!sequence) continue;
    TestSequence out;
    out.name = nameOf(folder);
    if (context.options.quick) out.run.max_frames = static_cast<std::size_t>(context.amount(0, 20));
    out.stride_factor = context.options.quick ? kQuickShrink : 1;
    // The copy of 7-Scenes is stored at a walking pace; every fourth frame makes it fast.
    if (out.name == "seven_scenes") out.run.stride = 4;
    out.frames = selectedFrames(sequence->size(), out.run).size();
    out.key = fmt::format("recorded {} {} frames, stride {}, most {}", out.name, sequence->size(),
                          out.run.stride, out.run.max_frames);
    out.open = [folder] { return std::shared_ptr<Sequence>(openSequence(folder)); };
    found.push_back(std::move(out));
  }
  return found;
}

Settings experimentSettings(const ExperimentContext& context) {
  Settings settings = loadSettings("paper");
  settings.volume.colour = false;
  settings.tracking.seed = context.options.seed;
  // Half the image needs half the stride for as many points.
  if (context.options.quick)
    for (SwarmLevel& level : settings.swarm.levels) level.pixel_stride /= kQuickShrink;
  for (SwarmLevel& level : settings.swarm.levels)
    level.particles = std::max(64, level.particles / context.options.shrink);
  if (context.options.quick) settings.tracking.templates_per_level = 5;
  return settings;
}

Settings changed(Settings settings, const std::vector<std::string>& assignments) {
  for (const std::string& assignment : assignments) applyAssignment(settings, assignment);
  return settings;
}

}  // namespace rosefusion
