#include "host/run/reconstruction.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <map>
#include <numeric>
#include <utility>

#include "engine/error.h"

namespace rosefusion {

std::size_t RunSummary::count(TrackingStatus status) const {
  return static_cast<std::size_t>(std::count_if(frames.begin(), frames.end(), [&](const RunFrame& f) {
    return !f.skipped && f.result.status == status;
  }));
}

std::size_t RunSummary::skipped() const {
  return static_cast<std::size_t>(
      std::count_if(frames.begin(), frames.end(), [](const RunFrame& f) { return f.skipped; }));
}

std::size_t RunSummary::dropped() const {
  return std::accumulate(frames.begin(), frames.end(), std::size_t{0},
                         [](std::size_t sum, const RunFrame& f) { return sum + f.dropped; });
}

namespace {

/// Closes the loops, and takes over what poses became after they were told.
void finish(Pipeline& pipeline, RunSummary& summary) {
  try {
    pipeline.finish();
  } catch (const DeviceError& error) {
    if (error.code() != DeviceErrorCode::OutOfMemory) throw;
    summary.end = RunEnd::DeviceFull;
    summary.end_reason = error.what();
  }
  if (pipeline.loops()) summary.loops = pipeline.loops()->figures();
  for (RunFrame& f : summary.frames)
    if (f.result.number)
      f.result.world_from_camera = pipeline.trajectory()[*f.result.number].world_from_camera;
}

/// The model begins anew with the last of these frames; those before have no place in it.
void beginAnew(RunSummary& summary) {
  RunFrame* first = nullptr;
  for (RunFrame& f : summary.frames) {
    if (f.skipped) continue;
    if (f.result.status != TrackingStatus::Lost) f.result.reason = {Reason::ModelBegunAnew};
    f.result.status = TrackingStatus::Lost;
    f.result.fused = false;
    f.result.number.reset();
    first = &f;
  }
  if (!first) return;
  first->result.status = TrackingStatus::Tracked;
  first->result.reason = {};
  first->result.world_from_camera = Pose::Identity();
  first->result.fused = true;
  first->result.number = 0;
  summary.began_anew_with = first->index;
  spdlog::info(
      "The model begins anew with frame {}, for what the frames before it showed fits none that follows.",
      first->index);
}

/// The detached map begins anew with the last of its frames; those before have no place in it.
void forget(RunSummary& summary, std::size_t map) {
  bool is_last = true;
  for (auto f = summary.frames.rbegin(); f != summary.frames.rend(); ++f) {
    if (f->result.detached_map != map || std::exchange(is_last, false)) continue;
    f->result.detached_map.reset();
    f->result.reason = {Reason::ModelBegunAnew};
  }
}

/// Frames that were lost when they came have the poses that the last one makes known.
void recover(RunSummary& summary, const FrameResult& last, std::size_t index) {
  if (last.recovered.empty() && last.joined.empty()) return;
  std::map<double, RunFrame*> lost;
  for (RunFrame& f : summary.frames)
    if (!f.skipped && !f.result.number) lost[f.result.timestamp] = &f;
  for (const RecoveredPose& recovered : last.recovered) {
    for (RunFrame& f : summary.frames)
      if (f.result.number && *f.result.number >= recovered.number) ++*f.result.number;
    const auto found = lost.find(recovered.pose.timestamp);
    if (found == lost.end()) continue;
    FrameResult& result = found->second->result;
    result.status = TrackingStatus::Relocalised;
    result.reason = {recovered.reason};
    result.world_from_camera = recovered.pose.world_from_camera;
    result.number = recovered.number;
  }
  for (const JoinedMap& joined : last.joined) {
    spdlog::info("Map {} is connected to map {} by frame {}.", joined.map, joined.into, index);
    if (joined.into == 1) summary.joined.push_back({joined.map, index});
    for (RunFrame& f : summary.frames)
      if (joined.into != 1 && f.result.detached_map == joined.map) f.result.detached_map = joined.into;
  }
}

/// A fit takes half a kilobyte, most of it for what goes on tracking.
void keepFigures(RunFrame& frame) {
  if (const std::optional<PoseFit> fit = std::exchange(frame.result.fit, {}))
    frame.fit = {fit->cost,          fit->observed_ratio,   fit->inlier_ratio,
                 fit->observability, fit->shiftDeviation(), fit->turnDeviation()};
}

}  // namespace

RunSummary reconstruct(FrameSource& source, Pipeline& pipeline, std::size_t max_frames,
                       const std::function<void(const RunProgress&)>& progress, const StopQuestion& stop) {
  const auto start = std::chrono::steady_clock::now();
  const std::size_t expected = source.expectedFrames();
  const std::size_t total = max_frames && (!expected || max_frames < expected) ? max_frames : expected;
  RunSummary summary;
  std::size_t colourless = 0;  // frames whose colour could not be used
  while (!max_frames || summary.frames.size() < max_frames) {
    SourceFrame read;
    const SourceState state = source.next(read, stop);
    if (state == SourceState::Stopped) summary.end = RunEnd::Interrupted;
    if (state != SourceState::Frame) break;
    RunFrame frame;
    frame.index = read.index;
    frame.dropped = read.dropped;
    frame.skipped = !read.usable;
    if (!read.usable)
      spdlog::warn("{}", read.problem);
    else if (!read.problem.empty() && colourless++ == 0)
      spdlog::warn("{} The frame is taken by its depth alone; more of them are only counted.", read.problem);
    try {
      if (read.usable) {
        frame.result = pipeline.processFrame(read.frame);
      } else {
        frame.result.timestamp = read.frame.timestamp;
        frame.problem = read.problem;
      }
    } catch (const DeviceError& error) {
      if (error.code() != DeviceErrorCode::OutOfMemory) throw;
      summary.end = RunEnd::DeviceFull;
      summary.end_reason = error.what();
      break;
    }
    if (frame.result.began_anew) beginAnew(summary);
    if (frame.result.detached_began_anew) forget(summary, *frame.result.detached_map);
    recover(summary, frame.result, frame.index);
    keepFigures(frame);
    summary.frames.push_back(std::move(frame));
    if (progress) progress({summary.frames.size(), total, &summary.frames.back()});
  }
  if (colourless > 1) spdlog::warn("{} frames were taken without their colour.", colourless);
  finish(pipeline, summary);
  if (const double readout = pipeline.readoutSeconds();
      readout != 0 && pipeline.settings().depth.readout == 0)
    spdlog::info(
        "The rows of an image are exposed over {:.0f} ms (rolling shutter), as was measured on the way; "
        "--set depth.readout={:.3f} corrects the frames before, too.",
        1000 * std::abs(readout), readout);
  summary.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return summary;
}

Trajectory trajectoryOf(const RunSummary& summary) {
  Trajectory trajectory;
  for (const RunFrame& f : summary.frames)
    if (!f.skipped && f.result.status != TrackingStatus::Lost)
      trajectory.push_back({f.result.timestamp, f.result.world_from_camera});
  return trajectory;
}

std::vector<MapFrames> mapsOf(const RunSummary& summary) {
  std::map<std::size_t, MapFrames> maps;
  const auto count = [&](std::size_t number, std::size_t index) {
    MapFrames& map = maps[number];
    map.map = number;
    if (map.frames++ == 0) map.first = index;
    map.last = index;
  };
  for (const RunFrame& f : summary.frames) {
    if (f.skipped) continue;
    if (f.result.number) count(1, f.index);
    if (f.result.detached_map) count(*f.result.detached_map, f.index);
  }
  for (const RunSummary::Joined& joined : summary.joined)
    if (const auto map = maps.find(joined.map); map != maps.end()) map->second.joined_at = joined.at;
  std::vector<MapFrames> out;
  for (const auto& [number, map] : maps) out.push_back(map);
  return out;
}

}  // namespace rosefusion
