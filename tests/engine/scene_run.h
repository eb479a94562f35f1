// The engine's passes on the reference scene, and its results in the reference's types.
#pragma once
#include <gtest/gtest.h>

#include <glm/mat4x4.hpp>
#include <optional>
#include <vector>

#include "engine/passes/allocate.h"
#include "engine/passes/integrate.h"
#include "engine/passes/preprocess.h"
#include "engine/passes/select_points.h"
#include "tests/reference/integrate.h"
#include "tests/reference/scene.h"

namespace rosefusion {

/// How GoogleTest shows the parameter of the tests below.
inline void PrintTo(const Intrinsics& camera, std::ostream* out) {
  *out << camera.width << " x " << camera.height;
}

}  // namespace rosefusion

namespace rosefusion::testing {

/// Two cameras: a plain one, and one with odd sizes and a negative fy as in ICL-NUIM. All numbers are exact
/// floats.
inline const Intrinsics kPlainCamera{160, 120, 130.5, 130.25, 79.5, 59.5};
inline const Intrinsics kOddCamera{161, 121, 140.25, -138.5, 80.25, 59.125};

/// Names the two in parameterised tests.
inline const auto kBothCameras = ::testing::Values(kPlainCamera, kOddCamera);
inline std::string cameraName(const ::testing::TestParamInfo<Intrinsics>& info) {
  return info.param == kPlainCamera ? "Plain" : "OddNegativeFy";
}

inline shader::CameraIntrinsics onDevice(const Intrinsics& camera) {
  return {glm::vec4(camera.fx, camera.fy, camera.cx, camera.cy),
          glm::ivec4(camera.width, camera.height, 0, 0)};
}

inline glm::mat4 onDevice(const Pose& pose) {
  glm::mat4 out;
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 4; ++row) out[column][row] = static_cast<float>(pose.matrix()(row, column));
  return out;
}

inline SensorNoise onDevice(const reference::DepthNoise& noise) {
  return {static_cast<float>(noise.floor), static_cast<float>(noise.growth),
          static_cast<float>(noise.bias_growth)};
}

/// The first `count` elements of a device buffer.
template <typename T>
std::vector<T> readBack(Device& device, const Buffer& buffer, std::size_t count) {
  if (count == 0) return {};
  const Buffer mapped(device, sizeof(T) * count, Memory::Readback);
  Recorder recorder(device);
  recorder.copy(buffer, mapped, sizeof(T) * count);
  recorder.submit();
  const auto values = mapped.as<T>().first(count);
  return {values.begin(), values.end()};
}

/// The sequence that the tests fuse: frames of the scene with 3 % invalid pixels.
struct Sequence {
  Intrinsics camera;
  reference::DepthSensor sensor;
  std::vector<Pose> poses;
  std::vector<reference::Image> images;
};

inline Sequence makeSequence(const Intrinsics& camera, int frames, std::uint32_t seed) {
  const reference::Scene scene = reference::makeScene(seed);
  Sequence sequence{.camera = camera, .sensor = {.metres_per_unit = double(1 / 5000.0f)}};
  sequence.poses = reference::cameraPath(frames, seed);
  for (int i = 0; i < frames; ++i)
    sequence.images.push_back(render(scene, camera, sequence.poses[i], 5000, 0.03, seed + i));
  return sequence;
}

/// Passes preprocess, allocate and integrate with their volume.
struct SceneRun {
  Device& device;
  Sequence sequence;
  PreprocessPass preprocess;
  AllocatePass allocate;
  IntegratePass integrate;
  Volume volume;
  Recorder recorder;

  SceneRun(Device& on, const Sequence& input, const VolumeOptions& options,
           std::uint32_t request_capacity = 1u << 16)
      : device(on),
        sequence(input),
        preprocess(on, onDevice(input.camera)),
        allocate(on, request_capacity),
        integrate(on),
        volume(on, options),
        recorder(on) {}

  void load(std::size_t frame) {
    const auto& sensor = sequence.sensor;
    const reference::Image& image = sequence.images[frame];
    preprocess.record(recorder, image.depth, sensor.metres_per_unit, sensor.min_depth, sensor.max_depth,
                      static_cast<float>(sensor.edge_sigmas), onDevice(sensor.noise));
    if (volume.options().colour) {
      std::ranges::copy(image.rgb, preprocess.colourWords().begin());
      preprocess.recordColour(recorder);
    }
    recorder.submit();
  }
  /// Of the loaded frame.
  void allocateBlocks(const Pose& world_from_camera) {
    do {
      allocate.record(recorder, volume, preprocess.frame(), onDevice(sequence.camera),
                      onDevice(world_from_camera));
      recorder.submit();
    } while (allocate.finish(recorder, volume));
    recorder.submit();
  }
  void integrateDepth(const Pose& world_from_camera) {
    const double far = sequence.sensor.max_depth + volume.options().truncation;
    integrate.record(recorder, volume, preprocess.frame(), onDevice(sequence.camera),
                     onDevice(world_from_camera.inverse()), far, onDevice(sequence.sensor.noise));
    recorder.submit();
  }
  void fuse(std::size_t frame) {
    load(frame);
    allocateBlocks(sequence.poses[frame]);
    integrateDepth(sequence.poses[frame]);
  }
  void fuseAll() {
    for (std::size_t i = 0; i < sequence.images.size(); ++i) fuse(i);
  }
  reference::PointImage referenceImage(std::size_t frame) const {
    return reference::preprocess(sequence.images[frame].depth, sequence.camera, sequence.sensor);
  }
};

/// Coordinates of the volume's blocks, without slot 0.
inline std::vector<reference::Block> blocksOf(const Volume& volume) {
  std::vector<reference::Block> blocks;
  for (const glm::ivec4& b : volume.blocks().subspan(1)) blocks.push_back({b.x, b.y, b.z});
  return blocks;
}

/// Without slot 0, which must have stayed unobserved; `contents` must outlive the result.
inline reference::TsdfContents inReferenceTypes(const VolumeContents& contents) {
  for (int i = 0; i < 512; ++i)
    EXPECT_TRUE(contents.tsdf[i] == 1 && contents.weight[i] == 0) << "slot 0 was written";
  reference::TsdfContents out;
  for (std::size_t i = 1; i < contents.blocks.size(); ++i)
    out.blocks.push_back({contents.blocks[i].x, contents.blocks[i].y, contents.blocks[i].z});
  out.tsdf = std::span(contents.tsdf).subspan(512);
  out.weight = std::span(contents.weight).subspan(512);
  if (!contents.colour.empty()) out.colour = std::span(contents.colour).subspan(512);
  return out;
}

/// Passes when the comparison found what it must find: for references made wrong on purpose.
inline ::testing::AssertionResult differs(const reference::Comparison& result) {
  return (result.mismatched > 0 ? ::testing::AssertionSuccess() : ::testing::AssertionFailure())
         << result.mismatched << " of " << result.compared << " mismatched, worst " << result.worst
         << " tolerances";
}

/// Passes when all compared values agree, there are some, and no more than `skipped_share` were left out.
inline ::testing::AssertionResult agrees(const reference::Comparison& result, double skipped_share = 0) {
  const double total = static_cast<double>(result.compared + result.skipped);
  const std::string figures = std::to_string(result.compared) + " compared, " +
                              std::to_string(result.skipped) + " skipped, " +
                              std::to_string(result.mismatched) + " mismatched, worst " +
                              std::to_string(result.worst) + " tolerances";
  if (result.compared == 0) return ::testing::AssertionFailure() << "nothing was compared; " << figures;
  if (result.mismatched > 0) return ::testing::AssertionFailure() << figures << "; first: " << result.first;
  if (result.skipped > skipped_share * total)
    return ::testing::AssertionFailure() << "too many skipped; " << figures;
  return ::testing::AssertionSuccess() << figures;
}

}  // namespace rosefusion::testing
