#include "host/run/reconstruction.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <future>

#include "engine/error.h"

namespace rosefusion {
namespace {

struct ReadFrame {
  Frame frame;
  std::string problem;
  bool usable = false;
};

ReadFrame readFrame(Sequence& sequence, std::size_t index) {
  ReadFrame out;
  out.usable = sequence.read(index, out.frame, out.problem);
  return out;
}

}  // namespace

std::size_t RunSummary::count(TrackingStatus status) const {
  return static_cast<std::size_t>(std::count_if(frames.begin(), frames.end(), [&](const RunFrame& f) {
    return !f.skipped && f.result.status == status;
  }));
}

std::size_t RunSummary::skipped() const {
  return static_cast<std::size_t>(
      std::count_if(frames.begin(), frames.end(), [](const RunFrame& f) { return f.skipped; }));
}

std::vector<std::size_t> selectedFrames(std::size_t size, const RunOptions& options) {
  std::vector<std::size_t> indices;
  for (std::size_t i = 0; i < size; i += std::max<std::size_t>(1, options.stride)) {
    if (options.max_frames && indices.size() == options.max_frames) break;
    indices.push_back(i);
  }
  return indices;
}

RunSummary reconstruct(Sequence& sequence, Pipeline& pipeline, const RunOptions& options,
                       const std::function<void(const RunProgress&)>& progress,
                       const std::function<bool()>& stop) {
  const std::vector<std::size_t> indices = selectedFrames(sequence.size(), options);
  const auto start = std::chrono::steady_clock::now();
  RunSummary summary;
  std::future<ReadFrame> ahead;
  const auto readAhead = [&](std::size_t position) {
    if (position < indices.size())
      ahead = std::async(std::launch::async,
                         [&sequence, index = indices[position]] { return readFrame(sequence, index); });
  };
  readAhead(0);
  for (std::size_t position = 0; position < indices.size(); ++position) {
    if (stop && stop()) {
      summary.end = RunEnd::Interrupted;
      break;
    }
    const ReadFrame read = ahead.get();
    readAhead(position + 1);
    RunFrame frame;
    frame.index = indices[position];
    frame.skipped = !read.usable;
    if (!read.problem.empty()) spdlog::warn("{}", read.problem);
    try {
      if (read.usable) {
        frame.result = pipeline.processFrame(read.frame);
      } else {
        frame.result.timestamp = sequence.timestamp(frame.index);
        frame.result.reason = read.problem;
      }
    } catch (const DeviceError& error) {
      if (error.code() != DeviceErrorCode::OutOfMemory) throw;
      summary.end = RunEnd::DeviceFull;
      summary.end_reason = error.what();
      break;
    }
    summary.frames.push_back(std::move(frame));
    if (progress) progress({position + 1, indices.size(), &summary.frames.back()});
  }
  if (ahead.valid()) ahead.wait();
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
