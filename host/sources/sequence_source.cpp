#include "host/sources/sequence_source.h"

#include <algorithm>
#include <thread>
#include <utility>

namespace rosefusion {
namespace {

SourceFrame readFrame(Sequence& sequence, std::size_t index) {
  SourceFrame out;
  out.index = index;
  out.usable = sequence.read(index, out.frame, out.problem);
  if (!out.usable) out.frame.timestamp = sequence.timestamp(index);
  return out;
}

}  // namespace

std::vector<std::size_t> selectedFrames(std::size_t size, const RunOptions& options) {
  std::vector<std::size_t> indices;
  for (std::size_t i = options.start; i < size; i += std::max<std::size_t>(1, options.stride)) {
    if (options.max_frames && indices.size() == options.max_frames) break;
    indices.push_back(i);
  }
  return indices;
}

SequenceSource::SequenceSource(Sequence& sequence, const RunOptions& options, Pace pace)
    : sequence_(sequence), indices_(selectedFrames(sequence.size(), options)), pace_(pace) {
  if (pace_ == Pace::AsTaken) readAhead();
}

SequenceSource::SequenceSource(std::unique_ptr<Sequence> sequence, const RunOptions& options, Pace pace)
    : SequenceSource(*sequence, options, pace) {
  owned_ = std::move(sequence);
}

SequenceSource::~SequenceSource() {
  if (ahead_.valid()) ahead_.wait();
}

std::vector<Finding> SequenceSource::findings(const DepthLimits& limits) {
  constexpr std::size_t kLookedAt = 16;  // images, spread over the sequence
  if (ahead_.valid()) ahead_.wait();     // one reader at a time
  return inspectSequence(sequence_, kLookedAt, {}, limits).findings;
}

void SequenceSource::readAhead() {
  if (position_ < indices_.size())
    ahead_ = std::async(std::launch::async,
                        [this, index = indices_[position_]] { return readFrame(sequence_, index); });
}

SequenceSource::Clock::time_point SequenceSource::due(std::size_t position) const {
  const double stamps = sequence_.timestamp(indices_[position]) - sequence_.timestamp(indices_[0]);
  return start_ + std::chrono::duration_cast<Clock::duration>(
                      std::chrono::duration<double>(stamps * info().seconds_per_stamp));
}

bool SequenceSource::waitForCamera(const StopQuestion& stop) {
  constexpr std::chrono::milliseconds kSlice(20);
  if (start_ == Clock::time_point{}) start_ = Clock::now();
  while (Clock::now() < due(position_)) {
    if (stop && stop()) return false;
    std::this_thread::sleep_for(std::min<Clock::duration>(kSlice, due(position_) - Clock::now()));
  }
  // The camera holds its newest frame only.
  while (position_ + 1 < indices_.size() && due(position_ + 1) <= Clock::now()) {
    ++position_;
    ++dropped_;
  }
  return true;
}

SourceState SequenceSource::next(SourceFrame& out, const StopQuestion& stop) {
  if (position_ == indices_.size()) return SourceState::End;
  if (stop && stop()) return SourceState::Stopped;
  if (pace_ == Pace::AsTaken) {
    out = ahead_.get();
    ++position_;
    readAhead();
    return SourceState::Frame;
  }
  if (!waitForCamera(stop)) return SourceState::Stopped;
  out = readFrame(sequence_, indices_[position_++]);
  out.dropped = std::exchange(dropped_, 0);
  return SourceState::Frame;
}

}  // namespace rosefusion
