#include "host/synth/sequence.h"

#include <opencv2/core.hpp>

#include "host/synth/cast_image.h"
#include "host/synth/depth_simulation.h"
#include "host/synth/noise.h"
#include "host/synth/parallel.h"
#include "host/synth/renderer.h"

namespace rosefusion {
namespace {

Scene makeScene(const SynthOptions& options) {
  if (!options.mesh_file.empty()) return loadScene(options.mesh_file, options.up);
  switch (options.scene) {
    case SceneKind::Desk:
      return makeDesk(options.seed);
    case SceneKind::Object:
      return makeObject(options.seed);
    case SceneKind::Room:
      break;
  }
  return makeRoom(options.seed);
}

/// Takes the depth of all that is not the scene's subject; threads may share `seen`.
void cutOut(cv::Mat& depth, const Tracer& tracer, const Intrinsics& k, const Pose& pose) {
  const Subject& subject = tracer.scene().subject;
  castImage(tracer, k, pose, 100, [&](int row, int column, const Tracer::Hit& hit, const Eigen::Vector3d&) {
    if (hit.triangle < subject.first_triangle || hit.triangle >= subject.end_triangle)
      depth.at<std::uint16_t>(row, column) = 0;
  });
}

}  // namespace

SynthPlan::SynthPlan(const SynthOptions& options) : options_(options) {
  if (options_.sensor.principle != DepthPrinciple::Noise) {
    options_.intrinsics = options_.sensor.output();
    options_.max_depth = options_.sensor.farthest;
    options_.noise = DepthNoise::None;
  }
  requirePlausible(options_);
  const std::string source = options_.mesh_file.empty() ? "procedural room" : options_.mesh_file.string();
  scene_ = std::make_unique<Scene>(makeScene(options_));
  tracer_ = std::make_unique<Tracer>(*scene_);
  truth_ = makeTrajectory(*tracer_, options_, source);
}

Pose SynthPlan::poseAt(std::size_t i, double seconds) const {
  if (seconds == 0) return truth_[i].world_from_camera;
  const bool forward = i == 0 || (seconds > 0 && i + 1 < truth_.size());
  const StampedPose &here = truth_[i], &there = truth_[forward ? i + 1 : i - 1];
  const double share = seconds / (there.timestamp - here.timestamp);
  const Pose step = here.world_from_camera.inverse() * there.world_from_camera;
  Eigen::AngleAxisd turn(step.linear());
  turn.angle() *= share;
  return here.world_from_camera * Eigen::Translation3d(share * step.translation()) * turn;
}

/// CV_32FC1, metres, on the images as they are written.
cv::Mat SynthPlan::measuredDepth(std::size_t i, Rng& rng, std::vector<std::uint8_t>* seen) const {
  const Pose& pose = truth_[i].world_from_camera;
  const Sensor& sensor = options_.sensor;
  if (sensor.principle != DepthPrinciple::Noise) {
    if (seen) renderDepth(*tracer_, options_.intrinsics, pose, options_.max_depth, seen);
    const Pose output_from_depth = sensor.outputFromDepth();
    return simulateDepth(
        sensor, *tracer_, [&](double seconds) -> Pose { return poseAt(i, seconds) * output_from_depth; },
        rng);
  }
  const cv::Mat depth = renderDepth(*tracer_, options_.intrinsics, pose, options_.max_depth, seen);
  if (options_.noise == DepthNoise::None) return depth;
  return addHandaNoise(
      depth, rng,
      options_.noise == DepthNoise::Simkinect ? DisparityRounding::Simkinect : DisparityRounding::Published);
}

Frame SynthPlan::renderFrame(std::size_t i, std::vector<std::uint8_t>* seen) const {
  Frame frame;
  frame.timestamp = truth_[i].timestamp;
  Rng rng(options_.seed, 1000 + i);  // one stream per frame: the same whichever thread renders it
  measuredDepth(i, rng, seen).convertTo(frame.depth, CV_16UC1, kSynthDepthUnitsPerMetre);
  if (options_.cut_out) cutOut(frame.depth, *tracer_, options_.intrinsics, truth_[i].world_from_camera);
  if (!options_.colour) return frame;
  frame.colour = renderColour(*tracer_, options_.intrinsics, truth_[i].world_from_camera);
  if (options_.noise != DepthNoise::None || options_.sensor.principle != DepthPrinciple::Noise)
    addColourNoise(frame.colour, rng);  // after the depth's, which it does not change
  return frame;
}

SynthSequence makeSequence(const SynthOptions& options) {
  const SynthPlan plan(options);
  SynthSequence sequence;
  sequence.intrinsics = plan.options().intrinsics;
  sequence.truth = plan.truth();
  sequence.mesh = plan.scene().mesh;
  sequence.statistics = plan.statistics();
  sequence.frames.resize(plan.truth().size());
  parallelFor(static_cast<int>(sequence.frames.size()), options.threads,
              [&](int i) { sequence.frames[i] = plan.renderFrame(i); });
  return sequence;
}

TriangleMesh seenPart(const TriangleMesh& mesh, const std::vector<std::uint8_t>& seen) {
  TriangleMesh part;
  constexpr std::uint32_t kUnused = 0xFFFFFFFFu;
  std::vector<std::uint32_t> new_index(mesh.vertices.size(), kUnused);
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    if (!seen[i]) continue;
    auto triangle = mesh.triangles[i];
    for (std::uint32_t& v : triangle) {
      if (new_index[v] == kUnused) {
        new_index[v] = static_cast<std::uint32_t>(part.vertices.size());
        part.vertices.push_back(mesh.vertices[v]);
        if (!mesh.normals.empty()) part.normals.push_back(mesh.normals[v]);
        if (!mesh.colours.empty()) part.colours.push_back(mesh.colours[v]);
      }
      v = new_index[v];
    }
    part.triangles.push_back(triangle);
  }
  return part;
}

}  // namespace rosefusion
