#include "host/slam/tracking/swarm_search.h"

#include <cmath>

#include "host/core/error.h"
#include "host/slam/shader_types.h"

namespace rosefusion {
namespace {

constexpr int kScoreStride = 8;

std::vector<glm::vec4> flatten(const TemplateSet& set) {
  std::vector<glm::vec4> out;
  for (const auto& level : set.levels)
    for (const SwarmTemplate& swarm_template : level)
      for (const Particle& p : swarm_template.particles) {
        out.emplace_back(p[0], p[1], p[2], 0);
        out.emplace_back(p[3], p[4], p[5], 0);
      }
  return out;
}

glm::vec4 shaderLengths(const Vector6& axis_lengths, int first) {
  return {axis_lengths[first], axis_lengths[first + 1], axis_lengths[first + 2], 0};
}

}  // namespace

SwarmSearch::SwarmSearch(Device& device, const Settings& settings, const Intrinsics& intrinsics,
                         TemplateSet templates)
    : settings_(settings),
      templates_(std::move(templates)),
      evaluator_(device, settings, intrinsics, flatten(templates_)) {
  std::uint32_t offset = 0;
  for (std::size_t level = 0; level < settings.swarm.levels.size(); ++level) {
    const auto particles = static_cast<std::size_t>(settings.swarm.levels[level].particles);
    if (level >= templates_.levels.size() || templates_.at(level, 0).particles.size() != particles)
      throw InputError(
          "The swarm templates do not fit swarm.levels; generate them with the same sizes (rosefusion pst).");
    level_offsets_.push_back(offset);
    offset += static_cast<std::uint32_t>(templates_.levels[level].size() * particles);
  }
}

void SwarmSearch::prepare(const VolumeView& volume) {
  evaluator_.fitness.prepare(volume, false, false);
  evaluator_.fitness.prepare(volume, settings_.tracking.overlap == Overlap::EachParticle,
                             settings_.tracking.race_margin > 0);
}

TrackResult SwarmSearch::search(const DeviceFrame& frame, const Volume& volume, const Pose& start,
                                const Pose& last, const SearchObserver& observer) {
  TrackResult result;
  SwarmState state = beginFrame(settings_.swarm, start, previous_ ? &*previous_ : nullptr);
  while (!state.stopped()) {
    const SwarmLevel& level = settings_.swarm.levels[state.level];
    const SwarmTemplate& swarm_template = templates_.at(state.level, state.serial);
    const auto number = static_cast<std::uint32_t>(state.serial % templates_.levels[state.level].size());
    const auto particles = static_cast<std::uint32_t>(level.particles);
    const Eigen::Vector2i offset = pixelOffset(settings_.swarm, state);
    evaluator_.evaluate(
        frame, volume, {level.pixel_stride, offset.x(), offset.y()}, state.centre, last,
        {toShader(state.centre), shaderLengths(state.axis_lengths, 0), shaderLengths(state.axis_lengths, 3),
         level_offsets_[state.level] + number * particles, particles,
         static_cast<float>(settings_.tracking.race_margin)});
    result.lookups += evaluator_.fitness.lookups();
    const std::function<Pose(std::size_t)> pose = [&](std::size_t i) {
      return moveBy(state.centre, scaledParticle(swarm_template, i, state.axis_lengths));
    };
    if (observer) observer({state, evaluator_.losses(), pose});
    update(settings_.swarm, state, swarm_template, evaluator_.losses(), evaluator_.counted());
  }
  result.world_from_camera = state.centre;
  result.iterations = state.iteration;
  previous_ = state;
  return result;
}

std::vector<ScannedPose> SwarmSearch::scan(const DeviceFrame& frame, const Volume& volume,
                                           std::span<const Pose> poses, double shift, double turn) {
  const std::size_t level = settings_.swarm.levels.size() / 2;
  const SwarmTemplate& swarm_template = templates_.at(level, 0);
  Vector6 lengths;
  lengths << Eigen::Vector3d::Constant(shift), Eigen::Vector3d::Constant(turn);
  const int stride = settings_.swarm.levels.front().pixel_stride;
  evaluator_.select.record(evaluator_.recorder, frame, {stride, stride / 2, stride / 2}, nullptr);
  evaluator_.recorder.submit();
  std::vector<ScannedPose> found;
  for (const Pose& pose : poses) {
    evaluator_.fitness.record(
        evaluator_.recorder, volume, evaluator_.select,
        {toShader(pose), shaderLengths(lengths, 0), shaderLengths(lengths, 3), level_offsets_[level],
         static_cast<std::uint32_t>(swarm_template.particles.size())});
    evaluator_.recorder.submit();
    const auto losses = evaluator_.fitness.losses();
    ScannedPose best;
    best.lookups = losses.size() * std::uint64_t(evaluator_.select.selected());
    for (std::size_t i = 0; i < losses.size(); ++i) {
      if (losses[i] < 0 || losses[i] >= best.loss) continue;
      best.loss = losses[i];
      best.world_from_camera = moveBy(pose, scaledParticle(swarm_template, i, lengths));
    }
    found.push_back(best);
  }
  return found;
}

void SwarmSearch::recordScore(Recorder& recorder, const DeviceFrame& frame, const Volume& volume,
                              const Pose& world_from_camera, const Pose& last) {
  // Particle 0 of any template is the zero move.
  const SwarmPlacement one{toShader(world_from_camera), glm::vec4(0), glm::vec4(0), level_offsets_[0], 1};
  const PixelGrid grid{kScoreStride, 0, 0};
  const glm::mat4 previous_from_current = toShader(last.inverse() * world_from_camera);
  evaluator_.select.record(recorder, frame, grid, &previous_from_current);
  evaluator_.fitness.record(recorder, volume, evaluator_.select, one);
}

PoseScore SwarmSearch::recordedScore() const {
  PoseScore score;
  const double valid = evaluator_.select.valid();
  score.valid_share = valid / evaluator_.select.cells();
  if (valid > 0) score.overlap = evaluator_.select.selected() / valid;
  const double loss = evaluator_.fitness.losses()[0];
  if (loss >= 0) score.residual = settings_.swarm.loss == FitnessLoss::Squared ? std::sqrt(loss) : loss;
  return score;
}

PoseScore SwarmSearch::score(const DeviceFrame& frame, const Volume& volume, const Pose& world_from_camera,
                             const Pose& last) {
  recordScore(evaluator_.recorder, frame, volume, world_from_camera, last);
  evaluator_.recorder.submit();
  return recordedScore();
}

}  // namespace rosefusion
