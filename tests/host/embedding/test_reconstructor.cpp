// The public class against the pipeline inside: the same poses, blocking or pushed, on a device of its own or
// on the caller's.
#include <cstdlib>
#include <thread>

#include "host/slam/pipeline.h"
#include "rosefusion/vulkan.h"
#include "tests/engine/caller.h"
#include "tests/engine/validating_device.h"
#include "tests/host/core/temporary_folder.h"
#include "tests/host/embedding/frames.h"

namespace rosefusion::testing {
namespace test_reconstructor {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr std::size_t kFrames = 6;

VulkanHandles publicHandles(const Caller& caller) {
  const CallerDevice h = caller.handles();
  return {.get_instance_proc_addr = h.get_instance_proc_addr,
          .instance = h.instance,
          .physical_device = h.physical_device,
          .device = h.device,
          .queue = h.queue};
}

/// What the pipeline itself makes of the frames.
const std::vector<Matrix>& expectedPoses() {
  static const std::vector<Matrix> poses = [] {
    Device device(deviceUnderTest());
    Pipeline pipeline(device, quickSettings(), shortSequence().intrinsics,
                      shortSequence().depth_units_per_metre);
    std::vector<Matrix> out;
    for (std::size_t i = 0; i < kFrames; ++i) {
      const FrameResult result = pipeline.processFrame(shortSequence().frames[i]);
      Eigen::Map<Eigen::Matrix4d>(out.emplace_back().data()) = result.world_from_camera.matrix();
    }
    return out;
  }();
  return poses;
}

template <typename Action>
::testing::AssertionResult throwsError(Action action, Error::Kind kind, const char* part) {
  try {
    action();
  } catch (const Error& error) {
    if (error.kind() == kind && std::string(error.what()).find(part) != std::string::npos)
      return ::testing::AssertionSuccess();
    return ::testing::AssertionFailure() << "kind " << int(error.kind()) << ": " << error.what();
  }
  return ::testing::AssertionFailure() << "nothing was thrown";
}

class Embedded : public ::testing::Test {
 protected:
  void TearDown() override { EXPECT_THAT(caller.messages(), IsEmpty()); }
  Caller caller;
};

TEST_F(Embedded, CallersDeviceGivesTheSamePoses) {
  Reconstructor reconstructor(publicCamera(), publicHandles(caller), quickOptions());
  for (std::size_t i = 0; i < kFrames; ++i) {
    const Result result = reconstructor.process(publicFrame(i));
    EXPECT_EQ(result.world_from_camera, expectedPoses()[i]) << "frame " << i;
    EXPECT_EQ(result.timestamp, publicFrame(i).timestamp);
    EXPECT_GT(result.milliseconds, 0);
  }
  EXPECT_EQ(reconstructor.trajectory().size(), kFrames);
  EXPECT_EQ(reconstructor.trajectory().back().world_from_camera, expectedPoses().back());
  EXPECT_GT(reconstructor.blockCount(), 100u);
  const Mesh mesh = reconstructor.mesh();
  EXPECT_GT(mesh.triangles.size(), 1000u);
  EXPECT_EQ(mesh.normals.size(), mesh.vertices.size());
  EXPECT_EQ(reconstructor.setting("volume.voxel_size"), "0.03");
}

TEST_F(Embedded, PushedFramesGiveTheSamePosesInOrder) {
  Options options = quickOptions();
  options.queue_length = 2;
  Reconstructor reconstructor(publicCamera(), publicHandles(caller), options);
  std::size_t refused = 0, polled = 0;
  const auto poll = [&] {
    while (const auto result = reconstructor.poll())
      EXPECT_EQ(result->world_from_camera, expectedPoses()[polled++]);
  };
  for (std::size_t i = 0; i < kFrames; ++i)
    while (!reconstructor.push(publicFrame(i))) {
      ++refused;
      poll();
      std::this_thread::yield();
    }
  EXPECT_GT(refused, 0u) << "six frames cannot wait in a queue of two";
  reconstructor.wait();
  poll();
  EXPECT_EQ(polled, kFrames);
  EXPECT_FALSE(reconstructor.poll().has_value());
}

TEST_F(Embedded, TwoOnTwoDevicesAtATime) {
  Caller other;
  Reconstructor first(publicCamera(), publicHandles(caller), quickOptions()),
      second(publicCamera(), publicHandles(other), quickOptions());
  for (std::size_t i = 0; i < 3; ++i) {
    ASSERT_TRUE(first.push(publicFrame(i)));
    ASSERT_TRUE(second.push(publicFrame(i)));
  }
  first.wait();
  second.wait();
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(first.poll()->world_from_camera, expectedPoses()[i]);
    EXPECT_EQ(second.poll()->world_from_camera, expectedPoses()[i]);
  }
  EXPECT_THAT(other.messages(), IsEmpty());
}

TEST_F(Embedded, AKnownPoseIsWhereTrackingGoesOn) {
  Reconstructor reconstructor(publicCamera(), publicHandles(caller), quickOptions());
  Matrix moved = kIdentity;
  moved[12] = 5;  // x
  reconstructor.integrate(publicFrame(0), moved);
  const Result next = reconstructor.process(publicFrame(1));
  EXPECT_NE(next.status, Status::Lost) << next.reason;
  EXPECT_NEAR(next.world_from_camera[12], expectedPoses()[1][12] + 5, 0.03);
  EXPECT_EQ(reconstructor.trajectory().front().world_from_camera, moved);
}

TEST_F(Embedded, OdometryReachesTheTracker) {
  const Options options{
      .settings = {{"swarm.levels", "1024/16 512/8 256/4"}, {"tracking.templates_per_level", "3"}}};
  const SynthSequence& sequence = shortSequence();
  Reconstructor reconstructor(publicCamera(), publicHandles(caller), options);
  Device device(deviceUnderTest());
  Settings settings = loadSettings("default");
  for (const Setting& s : options.settings) setField(settings, s.key, s.value, "test");
  Pipeline pipeline(device, settings, sequence.intrinsics, sequence.depth_units_per_metre);
  for (const std::size_t i : {0, 1, 15}) {
    const CameraMotion motion{
        sequence.truth[i ? 1 : 0].world_from_camera.inverse() * sequence.truth[i].world_from_camera, i == 15};
    Frame frame = sequence.frames[i];
    frame.motion = motion;
    DepthFrame told = publicFrame(i);
    told.motion = MotionPrior{};
    Eigen::Map<Eigen::Matrix4d>(told.motion->last_camera_from_camera.data()) =
        motion.last_camera_from_camera.matrix();
    told.motion->has_translation = motion.has_translation;
    const Matrix pose = reconstructor.process(told).world_from_camera;
    EXPECT_EQ(Eigen::Map<const Eigen::Matrix4d>(pose.data()),
              pipeline.processFrame(frame).world_from_camera.matrix())
        << "frame " << i;
  }
}

TEST_F(Embedded, WhatCannotBeIsRefusedInWords) {
  const auto make = [&](const Camera& camera, const Options& options) {
    Reconstructor(camera, publicHandles(caller), options);
  };
  Options typo = quickOptions();
  typo.settings.push_back({"volume.voxel_sise", "0.01"});
  EXPECT_TRUE(throwsError([&] { make(publicCamera(), typo); }, Error::Kind::BadInput, "volume.voxel_size"));
  EXPECT_TRUE(throwsError([&] { make({}, quickOptions()); }, Error::Kind::BadInput, "camera"));
  VulkanHandles incomplete = publicHandles(caller);
  incomplete.queue = VK_NULL_HANDLE;
  EXPECT_TRUE(throwsError([&] { Reconstructor(publicCamera(), incomplete, quickOptions()); },
                          Error::Kind::Misuse, "must not be null"));
  Reconstructor reconstructor(publicCamera(), publicHandles(caller), quickOptions());
  DepthFrame small = publicFrame(0);
  small.depth = small.depth.first(100);
  EXPECT_TRUE(throwsError([&] { reconstructor.process(small); }, Error::Kind::BadInput, "320 x 240"));
  EXPECT_TRUE(throwsError([&] { reconstructor.push(small); }, Error::Kind::BadInput, "320 x 240"));
  Matrix scaled = kIdentity;
  scaled[0] = 2;
  EXPECT_TRUE(
      throwsError([&] { reconstructor.integrate(publicFrame(0), scaled); }, Error::Kind::BadInput, "rigid"));
  DepthFrame stretched = publicFrame(0);
  stretched.motion = MotionPrior{scaled, false};
  EXPECT_TRUE(throwsError([&] { reconstructor.process(stretched); }, Error::Kind::BadInput, "rigid"));
  EXPECT_TRUE(
      throwsError([&] { reconstructor.setting("swarm.leves"); }, Error::Kind::BadInput, "swarm.levels"));
  reconstructor.push(publicFrame(0));
  reconstructor.push(publicFrame(1));
  EXPECT_TRUE(throwsError([&] { reconstructor.process(publicFrame(2)); }, Error::Kind::Misuse, "wait()"));
  reconstructor.wait();
  EXPECT_NE(reconstructor.process(publicFrame(2)).status, Status::Lost);
}

TEST_F(Embedded, AFailureInTheQueueIsThrownByPoll) {
  Options small = quickOptions();
  small.settings.push_back({"volume.memory_limit_mb", "17"});
  small.settings.push_back({"volume.voxel_size", "0.01"});
  small.settings.push_back({"volume.truncation", "0.03"});
  small.queue_length = 16;
  Reconstructor reconstructor(publicCamera(), publicHandles(caller), small);
  for (std::size_t i = 0; i < shortSequence().frames.size(); ++i) reconstructor.push(publicFrame(i));
  reconstructor.wait();
  EXPECT_TRUE(throwsError(
      [&] {
        while (reconstructor.poll()) continue;
      },
      Error::Kind::OutOfMemory, "volume.voxel_size"));
  EXPECT_NO_THROW(reconstructor.mesh());
}

TEST(Standalone, HasADeviceOfItsOwn) {
  Options options = quickOptions();
  const char* chosen = std::getenv("ROSEFUSION_DEVICE");
  options.device = chosen ? chosen : "llvmpipe";
  Reconstructor reconstructor(publicCamera(), options);
  EXPECT_EQ(reconstructor.process(publicFrame(0)).status, Status::Tracked);
  EXPECT_FALSE(reconstructor.device().empty());
  options.device = "voodoo";
  EXPECT_TRUE(throwsError([&] { Reconstructor(publicCamera(), options); }, Error::Kind::NoDevice, "voodoo"));
}

/// Text that the process wrote to standard output and error meanwhile.
template <typename Action>
std::string printedBy(Action action) {
  ::testing::internal::CaptureStdout();
  ::testing::internal::CaptureStderr();
  action();
  return ::testing::internal::GetCapturedStdout() + ::testing::internal::GetCapturedStderr();
}

TEST(Standalone, SpeaksToTheCallersLogAndNowhereElse) {
  const TemporaryFolder cache;
  const char* before = std::getenv("XDG_CACHE_HOME");
  const std::string cache_home = before ? before : "";
  setenv("XDG_CACHE_HOME", cache.path().c_str(), 1);
  Options options = quickOptions();
  options.device = "llvmpipe";
  EXPECT_EQ(printedBy([&] { Reconstructor(publicCamera(), options); }), "") << "templates are generated";

  std::vector<std::pair<LogLevel, std::string>> heard;
  options.log = [&](LogLevel level, const std::string& sentence) { heard.emplace_back(level, sentence); };
  const std::filesystem::path file = std::filesystem::directory_iterator(cache / "rosefusion")->path();
  std::filesystem::resize_file(file.extension() == ".lock" ? file.parent_path() / file.stem() : file, 1000);
  EXPECT_EQ(printedBy([&] { Reconstructor(publicCamera(), options); }), "") << "a damaged file of templates";
  ASSERT_EQ(heard.size(), 2u);
  EXPECT_EQ(heard[0].first, LogLevel::Warning);
  EXPECT_THAT(heard[0].second, HasSubstr(cache.path().string()));
  EXPECT_EQ(heard[1].first, LogLevel::Info);
  EXPECT_THAT(heard[1].second, HasSubstr("generating"));
  if (cache_home.empty())
    unsetenv("XDG_CACHE_HOME");
  else
    setenv("XDG_CACHE_HOME", cache_home.c_str(), 1);
}

}  // namespace test_reconstructor
}  // namespace rosefusion::testing
