#include "host/synth/sequence.h"

#include <opencv2/core.hpp>

#include "host/synth/noise.h"
#include "host/synth/parallel.h"
#include "host/synth/renderer.h"

namespace rosefusion {

SynthPlan::SynthPlan(const SynthOptions& options) : options_(options) {
  requirePlausible(options);
  scene_ = std::make_unique<Scene>(options.mesh_file.empty() ? makeRoom(options.seed)
                                                             : loadScene(options.mesh_file, options.up));
  tracer_ = std::make_unique<Tracer>(*scene_);
  const FreeSpace space(*tracer_, options.threads,
                        options.mesh_file.empty() ? "procedural room" : options.mesh_file.string());
  truth_ = makeTrajectory(space, options);
}

Frame SynthPlan::renderFrame(std::size_t i, std::vector<std::uint8_t>* seen) const {
  const Pose& pose = truth_[i].world_from_camera;
  Frame frame;
  frame.timestamp = truth_[i].timestamp;
  cv::Mat depth = renderDepth(*tracer_, options_.intrinsics, pose, options_.max_depth, seen);
  const bool noisy = options_.noise != DepthNoise::kNone;
  Rng rng(options_.seed, 1000 + i);  // one stream per frame: the same whichever thread renders it
  if (noisy)
    depth = addHandaNoise(depth, rng,
                          options_.noise == DepthNoise::kSimkinect ? DisparityRounding::kSimkinect
                                                                   : DisparityRounding::kPublished);
  depth.convertTo(frame.depth, CV_16UC1, kSynthDepthUnitsPerMetre);
  if (options_.colour) frame.colour = renderColour(*tracer_, options_.intrinsics, pose);
  if (options_.colour && noisy)
    addColourNoise(frame.colour, rng);  // after the depth's, which it does not change
  return frame;
}

SynthSequence makeSequence(const SynthOptions& options) {
  const SynthPlan plan(options);
  SynthSequence sequence;
  sequence.intrinsics = options.intrinsics;
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
