// The library on a device whose commands fail: failing_layer.cpp. A frame that failed can be given again, and
// nothing of it is then in the model twice or missing; a lost device is refused with a sentence from then on.
#include <dlfcn.h>
#include <gmock/gmock.h>
#include <pthread.h>

#include <atomic>
#include <cerrno>
#include <cstdlib>
#include <functional>
#include <numeric>
#include <random>

#include "host/embedding/reconstructor_impl.h"
#include "tests/host/embedding/frames.h"

namespace {
std::atomic<bool> no_more_threads = false;
}

/// In place of the system's, for all libraries of this process.
extern "C" __attribute__((visibility("default"))) int pthread_create(pthread_t* thread,
                                                                     const pthread_attr_t* attributes,
                                                                     void* (*work)(void*),
                                                                     void* with) noexcept {
  static const auto real = reinterpret_cast<decltype(&pthread_create)>(dlsym(RTLD_NEXT, "pthread_create"));
  return no_more_threads ? EAGAIN : real(thread, attributes, work, with);
}

namespace rosefusion::testing {
namespace test_library_faults {

using ::testing::HasSubstr;

constexpr int kHostMemory = -1, kDeviceMemory = -2, kLost = -4, kMapFailed = -5, kFragmented = -12;
constexpr std::size_t kFrames = 4;
constexpr const char* kEachFrame[] = {
    "vkQueueSubmit",      "vkWaitForFences",          "vkResetFences",    "vkBeginCommandBuffer",
    "vkEndCommandBuffer", "vkAllocateDescriptorSets", "vkAllocateMemory", "vkCreateBuffer",
    "vkBindBufferMemory", "vkCreateBufferView",       "vkMapMemory",      "vkCreateComputePipelines"};

void (*failCall)(const char*, std::uint64_t, int) = nullptr;
std::uint64_t (*callsOf)(const char*) = nullptr;

struct Layer : ::testing::Environment {
  void SetUp() override {
    setenv("VK_LAYER_PATH", ROSEFUSION_FAULTS, 1);
    setenv("VK_INSTANCE_LAYERS", "VK_LAYER_ROSEFUSION_faults", 1);
    void* layer = dlopen(ROSEFUSION_FAULTS "/libfailing_layer.so", RTLD_NOW);
    ASSERT_NE(layer, nullptr) << dlerror();
    failCall = reinterpret_cast<decltype(failCall)>(dlsym(layer, "failCall"));
    callsOf = reinterpret_cast<decltype(callsOf)>(dlsym(layer, "callsOf"));
  }
};
const auto* const layer = ::testing::AddGlobalTestEnvironment(new Layer);

Matrix poseOf(std::size_t i) {
  const SynthSequence& sequence = shortSequence();
  Matrix out;
  Eigen::Map<Eigen::Matrix4d>(out.data()) =
      (sequence.truth[0].world_from_camera.inverse() * sequence.truth[i].world_from_camera).matrix();
  return out;
}

/// Twice as much where a frame was fused twice, and less where it is missing.
double weightOf(Reconstructor& reconstructor) {
  const VolumeContents contents = reconstructor.impl().pipeline.volume().download();
  return std::accumulate(contents.weight.begin(), contents.weight.end(), 0.0);
}

struct Model {
  std::size_t poses = 0, triangles = 0, blocks = 0;
  double weight = 0;
  bool operator==(const Model&) const = default;
};
Model modelOf(Reconstructor& reconstructor) {
  return {reconstructor.trajectory().size(), reconstructor.mesh().triangles.size(),
          reconstructor.blockCount(), weightOf(reconstructor)};
}
std::ostream& operator<<(std::ostream& out, const Model& m) {
  return out << m.poses << " poses, " << m.triangles << " triangles, " << m.blocks << " blocks, weight "
             << m.weight;
}

/// Whether `action` failed, in words; what was thrown must be `kind`.
bool fails(const std::function<void()>& action, Error::Kind kind, const std::string& where) {
  try {
    action();
    return false;
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), kind) << where << ": " << error.what();
    EXPECT_THAT(error.what(), HasSubstr("; ")) << where;
  }
  return true;
}

/// Fuses kFrames of known pose; before one of them `command` begins to fail at its `call`-th call from then
/// on.
Model fused(const std::string& command, std::size_t at, std::uint64_t call, int result, int& failures) {
  Reconstructor reconstructor(publicCamera(), coarseOptions());
  const std::string where = command + ", frame " + std::to_string(at) + ", call " + std::to_string(call);
  for (std::size_t i = 0; i < kFrames; ++i) {
    if (i == at) failCall(command.c_str(), call, result);
    const auto integrate = [&] { reconstructor.integrate(publicFrame(i), poseOf(i)); };
    if (!fails(integrate, Error::Kind::OutOfMemory, where)) continue;
    ++failures;
    EXPECT_NO_THROW(integrate()) << where;
  }
  failCall(command.c_str(), 0, 0);
  return modelOf(reconstructor);
}

TEST(LibraryFaults, AFailedFrameGivenAgainIsFusedOnce) {
  int failures = 0;
  const Model expected = fused("none", 0, 0, 0, failures);
  ASSERT_GT(expected.triangles, 100u);
  std::mt19937 random(1);
  for (const char* command : kEachFrame)
    for (const std::size_t at : {std::size_t(0), std::size_t(1), kFrames - 1}) {
      const int result = random() % 2 ? kDeviceMemory : kHostMemory;
      const std::uint64_t call = 1 + random() % 4;
      EXPECT_EQ(fused(command, at, call, command == std::string("vkResetFences") ? kDeviceMemory : result,
                      failures),
                expected)
          << command << ", frame " << at << ", call " << call;
    }
  EXPECT_GT(failures, 12);
}

TEST(LibraryFaults, TrackingGoesOnAfterAFailure) {
  std::mt19937 random(2);
  Reconstructor reconstructor(publicCamera(), coarseOptions());
  reconstructor.process(publicFrame(0));
  int failures = 0;
  std::size_t poses = 1;
  for (const char* command : kEachFrame) {
    const std::size_t i = 1 + poses % (kFrames - 1);
    failCall(command, 1 + random() % 6, command == std::string("vkMapMemory") ? kMapFailed : kDeviceMemory);
    const auto process = [&] {
      EXPECT_NE(reconstructor.process(publicFrame(i)).status, Status::Lost) << command;
    };
    if (fails(process, Error::Kind::OutOfMemory, command)) {
      ++failures;
      EXPECT_NO_THROW(process()) << command;
    }
    failCall(command, 0, 0);
    EXPECT_EQ(reconstructor.trajectory().size(), ++poses) << command;
  }
  EXPECT_GT(failures, 4);
}

TEST(LibraryFaults, PushedFramesTellOfFailuresWhenPolled) {
  Reconstructor reconstructor(publicCamera(), coarseOptions());
  reconstructor.process(publicFrame(0));
  failCall("vkAllocateDescriptorSets", 40, kFragmented);
  for (std::size_t i = 1; i < kFrames; ++i) ASSERT_TRUE(reconstructor.push(publicFrame(i)));
  reconstructor.wait();
  int failures = 0, results = 0;
  for (std::size_t i = 1; i < kFrames; ++i)
    if (!fails([&] { results += reconstructor.poll().has_value(); }, Error::Kind::OutOfMemory, "poll"))
      continue;
    else
      ++failures;
  EXPECT_EQ(failures, 1);
  EXPECT_EQ(results, 2);
}

TEST(LibraryFaults, AThreadThatCannotBeHadIsAskedForAgain) {
  Reconstructor reconstructor(publicCamera(), coarseOptions());
  no_more_threads = true;
  EXPECT_TRUE(fails([&] { reconstructor.push(publicFrame(0)); }, Error::Kind::OutOfMemory, "push"));
  reconstructor.wait();  // for nothing: the frame was not taken
  EXPECT_NE(reconstructor.process(publicFrame(0)).status, Status::Lost);
  no_more_threads = false;
  EXPECT_TRUE(reconstructor.push(publicFrame(1)));
  reconstructor.wait();
  EXPECT_TRUE(reconstructor.poll().has_value());
  EXPECT_FALSE(reconstructor.poll().has_value());
}

TEST(LibraryFaults, ALostDeviceIsRefusedInWords) {
  std::mt19937 random(3);
  for (const char* command : {"vkQueueSubmit", "vkWaitForFences"}) {
    Reconstructor reconstructor(publicCamera(), coarseOptions());
    reconstructor.process(publicFrame(0));
    failCall(command, 1 + random() % 20, kLost);
    const auto process = [&] {
      for (std::size_t i = 1; i < kFrames; ++i) reconstructor.process(publicFrame(i));
    };
    EXPECT_TRUE(fails(process, Error::Kind::DeviceLost, command));
    const std::size_t poses = reconstructor.trajectory().size();  // of frames before the loss
    EXPECT_LT(poses, kFrames);
    EXPECT_TRUE(fails(process, Error::Kind::DeviceLost, command));
    EXPECT_TRUE(fails([&] { reconstructor.mesh(); }, Error::Kind::DeviceLost, command));
    EXPECT_EQ(reconstructor.trajectory().size(), poses) << command;
  }
}

TEST(LibraryFaults, AFailedConstructorLeavesNothingBehind) {
  std::mt19937 random(4);
  for (const char* command :
       {"vkCreateDevice", "vkCreateCommandPool", "vkCreateDescriptorPool", "vkCreateFence",
        "vkCreateShaderModule", "vkCreateComputePipelines", "vkAllocateMemory", "vkQueueSubmit",
        "vkWaitForFences", "vkEnumeratePhysicalDevices"}) {
    failCall(command, command == std::string("vkCreateDevice") ? 1 : 1 + random() % 4, kHostMemory);
    fails([] { Reconstructor unused(publicCamera(), coarseOptions()); },
          command == std::string("vkEnumeratePhysicalDevices") ? Error::Kind::NoDevice
                                                               : Error::Kind::OutOfMemory,
          command);
    failCall(command, 0, 0);
  }
  EXPECT_NO_THROW(Reconstructor(publicCamera(), coarseOptions()).process(publicFrame(0)));
}

}  // namespace test_library_faults
}  // namespace rosefusion::testing
