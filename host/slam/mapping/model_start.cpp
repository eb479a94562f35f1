#include "host/slam/mapping/model_start.h"

#include <algorithm>
#include <utility>

namespace rosefusion {
namespace {

/// A caller may use its images again once the frame is processed.
ModelStart::Candidate keptOf(const Frame& frame, double told) {
  return {{frame.timestamp, frame.depth.clone(), frame.colour.clone(), frame.motion}, told};
}

}  // namespace

void ModelStart::begin(const Frame& frame, double told) {
  if (isSettled()) return;
  first_ = keptOf(frame, told);
  lost_.reset();
  confirmed_ = 0;
}

void ModelStart::confirm(double met) {
  lost_.reset();
  confirmed_ += met;
  if (isSettled()) first_.reset();
}

std::optional<ModelStart::Candidate> ModelStart::rival(const Frame& frame, double told) {
  if (isSettled() || !first_) return {};
  std::optional<Candidate> before = std::exchange(lost_, keptOf(frame, told));
  if (!before || std::min(before->told, told) <= confirmed_) return {};
  return before;
}

}  // namespace rosefusion
