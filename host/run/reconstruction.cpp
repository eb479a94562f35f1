#include "host/run/reconstruction.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <numeric>

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

/// Frames that were lost when they came have the poses that the last one confirms.
void recover(RunSummary& summary, const FrameResult& last) {
  auto frame = summary.frames.rbegin();
  for (std::size_t left = last.recovered.size(); left > 0; --left) {
    const StampedPose& pose = last.recovered[left - 1];
    frame = std::find_if(frame, summary.frames.rend(), [&](const RunFrame& f) {
      return !f.skipped && !f.result.number && f.result.timestamp == pose.timestamp;
    });
    if (frame == summary.frames.rend()) return;
    FrameResult& result = frame->result;
    result.status = TrackingStatus::Relocalised;
    result.reason = {Reason::ConfirmedLater};
    result.world_from_camera = pose.world_from_camera;
    result.number = *last.number - (last.recovered.size() - (left - 1));
  }
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
    if (frame.result.number) recover(summary, frame.result);
    summary.frames.push_back(std::move(frame));
    if (progress) progress({summary.frames.size(), total, &summary.frames.back()});
  }
  if (colourless > 1) spdlog::warn("{} frames were taken without their colour.", colourless);
  finish(pipeline, summary);
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

}  // namespace rosefusion
