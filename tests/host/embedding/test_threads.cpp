// The public classes from several threads at a time, and ended while they are at work. Preset tsan runs it
// too.
#include <atomic>
#include <cstdlib>
#include <optional>
#include <thread>
#include <vector>

#include "rosefusion/vulkan.h"
#include "tests/engine/validating_device.h"
#include "tests/host/embedding/caller_handles.h"
#include "tests/host/embedding/frames.h"

namespace rosefusion::testing {
namespace test_threads {

using ::testing::HasSubstr;

/// Coarse, so that many frames take little time.
Options coarseOptions() {
  Options options = quickOptions();
  options.settings[0].value = "512/8";
  options.settings[2].value = "0.06";
  options.settings[3].value = "0.18";
  return options;
}

Options ownDevice() {
  Options options = coarseOptions();
  options.device = std::getenv("ROSEFUSION_DEVICE") ? std::getenv("ROSEFUSION_DEVICE") : "llvmpipe";
  return options;
}

DepthFrame at(std::size_t i) {
  return publicFrame(i % 4);
}

VulkanHandles sharedHandles(Caller& caller) {
  VulkanHandles handles = handlesOf(caller);
  handles.lock_queue = [&] { caller.queue_mutex.lock(); };
  handles.unlock_queue = [&] { caller.queue_mutex.unlock(); };
  return handles;
}

/// Threads that all begin at a time and are waited for at the end.
class Together {
 public:
  ~Together() {
    go_ = true;
    for (std::thread& thread : threads_) thread.join();
  }
  template <typename Work>
  void add(Work work) {
    threads_.emplace_back([this, work] {
      while (!go_) std::this_thread::yield();
      work();
    });
  }

 private:
  std::atomic<bool> go_{false};
  std::vector<std::thread> threads_;
};

TEST(Threads, EveryMemberMayBeCalledFromAnyThread) {
  constexpr int kEach = 6;
  Caller caller;
  std::atomic<int> taken = 0, polled = 0, fused = 0, tracked = 0;
  {
    Reconstructor shared(publicCamera(), sharedHandles(caller), coarseOptions());
    const Reconstructor& looked_at = shared;
    shared.process(at(0));
    // While pushed frames wait, other frames are refused; each thread tries until it was let in.
    const auto untilLetIn = [](const auto& action) {
      for (;;) try {
          return action();
        } catch (const Error& error) {
          ASSERT_EQ(error.kind(), Error::Kind::Misuse) << error.what();
          std::this_thread::yield();
        }
    };
    {
      Together threads;
      threads.add([&] {
        for (int i = 0; i < kEach; i += shared.push(at(i)) ? 1 : 0) std::this_thread::yield();
        taken = kEach;
      });
      threads.add([&] {
        while (taken < kEach || polled < kEach)
          if (shared.poll())
            ++polled;
          else
            std::this_thread::yield();
      });
      for (int n = 0; n < 2; ++n) {
        threads.add([&] {
          for (int i = 0; i < kEach; ++i)
            untilLetIn([&] { tracked += shared.process(at(i)).status != Status::Lost; });
        });
        threads.add([&] {
          for (int i = 0; i < kEach; ++i)
            untilLetIn([&] {
              shared.integrate(at(0), kIdentity);
              ++fused;
            });
        });
      }
      threads.add([&] {
        for (int i = 0; i < 3; ++i) {
          shared.wait();
          const Mesh mesh = shared.mesh();  // of few frames it may be empty
          EXPECT_EQ(mesh.normals.size(), mesh.vertices.size());
        }
      });
      for (int n = 0; n < 2; ++n)
        threads.add([&] {
          while (polled < kEach) {
            EXPECT_GE(looked_at.trajectory().size(), 1u);
            EXPECT_GT(looked_at.blockCount(), 0u);
            EXPECT_EQ(looked_at.setting("volume.voxel_size"), "0.06");
            EXPECT_FALSE(looked_at.device().empty());
            EXPECT_GT(volumeBuffers(looked_at).block_count, 0u);
            EXPECT_TRUE(missingFor(handlesOf(caller)).empty());
            EXPECT_GT(vulkanRequirements().api_version, 0u);
            EXPECT_THROW(looked_at.setting("swarm.leves"), Error);
          }
        });
      threads.add([&] {
        const Camera small{80, 60, 40, 40, 39.5, 29.5};
        View view(looked_at, small, 1);
        const ViewImages images{caller.makeImage(VK_FORMAT_R8G8B8A8_UNORM, VK_IMAGE_ASPECT_COLOR_BIT, 80, 60),
                                caller.makeImage(VK_FORMAT_R32_SFLOAT, VK_IMAGE_ASPECT_COLOR_BIT, 80, 60)};
        while (polled < kEach)
          caller.frame([&](VkCommandBuffer commands) { view.record(commands, 0, {}, images); });
      });
    }
    EXPECT_EQ(polled, kEach);
    EXPECT_EQ(fused, 2 * kEach);
    EXPECT_FALSE(shared.poll().has_value());
    EXPECT_GT(shared.mesh().triangles.size(), 100u);
    EXPECT_GE(shared.trajectory().size(), std::size_t(fused + tracked));
    EXPECT_LE(shared.trajectory().size(), std::size_t(1 + 5 * kEach));
  }
  EXPECT_THAT(caller.messages(), ::testing::IsEmpty());
}

TEST(Threads, SeveralAreMadeUsedAndEndedAtATime) {
  const Matrix expected = [] {
    Reconstructor alone(publicCamera(), ownDevice());
    alone.process(at(0));
    return alone.process(at(1)).world_from_camera;
  }();
  Together threads;
  for (int n = 0; n < 3; ++n)
    threads.add([&] {
      for (int i = 0; i < 2; ++i) {
        Reconstructor own(publicCamera(), ownDevice());
        own.process(at(0));
        EXPECT_EQ(own.process(at(1)).world_from_camera, expected);
        EXPECT_GT(own.mesh().triangles.size(), 100u);
      }
    });
}

TEST(Threads, EndingWaitsForTheFrameUnderWay) {
  Caller caller;
  Options options = coarseOptions();
  options.queue_length = 64;
  for (int n = 0; n < 6; ++n) {
    std::optional<Reconstructor> ended(std::in_place, publicCamera(), sharedHandles(caller), options);
    for (std::size_t i = 0; i < 64; ++i) ASSERT_TRUE(ended->push(at(i)));
    // At the beginning of a frame, within it, or between two.
    for (int polled = 0; polled < n / 2; polled += ended->poll() ? 1 : 0) std::this_thread::yield();
    if (n % 2) std::this_thread::sleep_for(std::chrono::milliseconds(3 * n));
    std::thread other([&] { ended.reset(); });  // need not be the thread that made it
    other.join();
    EXPECT_TRUE(caller.works());
  }
  EXPECT_THAT(caller.messages(), ::testing::IsEmpty());
}

TEST(Threads, AMovedOneKeepsItsFrames) {
  Caller caller;
  Reconstructor first(publicCamera(), sharedHandles(caller), coarseOptions());
  for (std::size_t i = 0; i < 3; ++i) ASSERT_TRUE(first.push(at(i)));
  Reconstructor second = std::move(first);
  Reconstructor replaced(publicCamera(), sharedHandles(caller), coarseOptions());
  ASSERT_TRUE(replaced.push(at(0)));
  replaced = std::move(second);  // ends what was there, in the middle of a frame
  replaced.wait();
  for (std::size_t i = 0; i < 3; ++i) EXPECT_TRUE(replaced.poll().has_value()) << i;
  EXPECT_FALSE(replaced.poll().has_value());
  EXPECT_THAT(caller.messages(), ::testing::IsEmpty());
}

TEST(Threads, AThrowingLogEndsTheConstructor) {
  struct Stop {};
  Options options = ownDevice();
  options.settings.push_back({"tracker.method", "pst"});  // an old name, which the log is told of
  Together threads;
  for (int n = 0; n < 2; ++n)
    threads.add([&] {
      Options its = options;
      int heard = 0;
      its.log = [&](LogLevel, const std::string&) {
        ++heard;
        throw Stop();
      };
      EXPECT_THROW(Reconstructor(publicCamera(), its), Stop);
      EXPECT_EQ(heard, 1);
      its.log = [&](LogLevel, const std::string&) { ++heard; };
      EXPECT_NE(Reconstructor(publicCamera(), its).process(at(0)).status, Status::Lost);
      EXPECT_EQ(heard, 2);
    });
}

TEST(Threads, AThrowingQueueLockLosesNoFrame) {
  struct Stop : std::runtime_error {
    using std::runtime_error::runtime_error;
  };
  Caller caller;
  VulkanHandles handles = handlesOf(caller);
  std::atomic<int> until = -1;  // submits until one throws
  handles.lock_queue = [&] {
    if (until >= 0 && until-- == 0) throw Stop("the caller's");
    caller.queue_mutex.lock();
  };
  handles.unlock_queue = [&] { caller.queue_mutex.unlock(); };
  Reconstructor reconstructor(publicCamera(), handles, coarseOptions()),
      untouched(publicCamera(), handlesOf(caller), coarseOptions());
  for (std::size_t i = 0; i < 4; ++i) {
    until = static_cast<int>(i);
    EXPECT_THROW(reconstructor.process(at(i)), Stop) << i;
    until = -1;
    EXPECT_EQ(reconstructor.process(at(i)).world_from_camera, untouched.process(at(i)).world_from_camera)
        << i;
  }
  until = 1;
  ASSERT_TRUE(reconstructor.push(at(0)));
  reconstructor.wait();
  EXPECT_THROW(reconstructor.poll(), Stop);
  until = 0;
  EXPECT_THROW(reconstructor.mesh(), Stop);
  until = -1;
  EXPECT_GT(reconstructor.mesh().triangles.size(), 100u);
  EXPECT_THAT(caller.messages(), ::testing::IsEmpty());
}

}  // namespace test_threads
}  // namespace rosefusion::testing
