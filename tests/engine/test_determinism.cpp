// The same input twice gives the same bytes, on one device and on two.
#include <cmath>
#include <cstring>

#include "engine/passes/fitness.h"
#include "tests/engine/scene_run.h"
#include "tests/engine/validating_device.h"

namespace rosefusion::testing {
namespace test_determinism {

/// Everything that the passes leave, as bytes.
std::string resultsOf(Device& device, const Sequence& sequence) {
  SceneRun run(device, sequence, {.voxel_size = 0.02f, .truncation = 0.06f, .colour = true});
  run.fuseAll();
  std::vector<glm::vec4> templates;
  for (int i = 0; i < 2 * 500; ++i) templates.emplace_back(std::sin(i), std::sin(3 * i), std::sin(5 * i), 0);
  SelectPointsPass points(device, onDevice(sequence.camera));
  const glm::mat4 motion = onDevice(sequence.poses[0].inverse() * sequence.poses.back());
  points.record(run.recorder, run.preprocess.frame(), {2, 1, 0}, &motion);
  FitnessPass fitness(device, templates, Loss::Absolute);
  fitness.record(run.recorder, run.volume, points,
                 {onDevice(sequence.poses.back()), glm::vec4(0.1f), glm::vec4(0.1f), 0, 500});
  run.recorder.submit();

  std::string bytes;
  const auto append = [&](const auto& values) {
    bytes.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(values[0]));
  };
  const VolumeContents contents = run.volume.download();
  append(contents.blocks);
  append(contents.tsdf);
  append(contents.weight);
  append(contents.colour);
  append(readBack<float>(device, points.points(), 4 * std::size_t(points.selected())));
  append(fitness.losses());
  return bytes;
}

class Determinism : public ValidatingDevice {};

TEST_F(Determinism, TheSameInputGivesTheSameBytes) {
  const Sequence sequence = makeSequence(kOddCamera, 5, 71);
  const std::string first = resultsOf(device(), sequence);
  EXPECT_GT(first.size(), 1u << 20);
  for (int repeat = 0; repeat < 3; ++repeat)
    EXPECT_TRUE(resultsOf(device(), sequence) == first) << "repeat " << repeat;
  Device other(deviceUnderTest());
  EXPECT_TRUE(resultsOf(other, sequence) == first) << "on another Device";
  EXPECT_THAT(other.validationMessages(), ::testing::IsEmpty());
}

TEST_F(Determinism, ComparisonSeesOneUnitOfDepth) {
  Sequence sequence = makeSequence(kOddCamera, 2, 71);
  const std::string first = resultsOf(device(), sequence);
  for (auto& depth : sequence.images[1].depth) depth += depth > 0 && depth < 65535;
  EXPECT_FALSE(resultsOf(device(), sequence) == first);
}

}  // namespace test_determinism
}  // namespace rosefusion::testing
