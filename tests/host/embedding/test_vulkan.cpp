// The model in an application's images, command buffers and shaders.
#include <algorithm>
#include <bit>
#include <chrono>
#include <cmath>
#include <cstring>
#include <optional>
#include <set>
#include <thread>
#include <utility>

#include "engine/buffer.h"
#include "rosefusion/vulkan.h"
#include "tests/engine/validating_device.h"
#include "tests/host/embedding/caller_handles.h"
#include "tests/host/embedding/caller_shader.h"
#include "tests/host/embedding/frames.h"

namespace rosefusion::testing {
namespace test_vulkan {

constexpr std::uint32_t kWidth = 80, kHeight = 60;
constexpr std::uint32_t kLookup[] = {
#include "lookup.inc"
};

class EmbeddedVulkan : public ::testing::Test {
 protected:
  void TearDown() override { EXPECT_THAT(caller.messages(), ::testing::IsEmpty()); }

  VulkanHandles handles() const { return handlesOf(caller); }
  Camera viewCamera() const {
    Camera camera = publicCamera();
    const double scale = double(kWidth) / camera.width;
    return {kWidth, kHeight, camera.fx * scale, camera.fy * scale, 39.5, 29.5};
  }
  ViewImages makeImages() {
    return {caller.makeImage(VK_FORMAT_R8G8B8A8_UNORM, VK_IMAGE_ASPECT_COLOR_BIT, kWidth, kHeight),
            caller.makeImage(VK_FORMAT_R32_SFLOAT, VK_IMAGE_ASPECT_COLOR_BIT, kWidth, kHeight)};
  }
  std::vector<float> depthsOf(const ViewImages& images) {
    std::vector<float> out;
    for (const std::uint32_t word : caller.read(images.depth, VK_IMAGE_ASPECT_COLOR_BIT, kWidth, kHeight))
      out.push_back(std::bit_cast<float>(word));
    return out;
  }

  Caller caller;
};

/// Median difference, in metres, between a view from the first camera and the depth image that was fused.
double differenceFromFirstImage(const std::vector<float>& depths) {
  const cv::Mat& truth = shortSequence().frames[0].depth;
  std::vector<double> differences;
  for (std::uint32_t v = 0; v < kHeight; ++v)
    for (std::uint32_t u = 0; u < kWidth; ++u) {
      const double z = truth.at<std::uint16_t>(4 * v + 1, 4 * u + 1) / shortSequence().depth_units_per_metre;
      const float drawn = depths[v * kWidth + u];
      if (z > 0 && drawn > 0) differences.push_back(std::abs(z - drawn));
    }
  EXPECT_GT(differences.size(), kWidth * kHeight / 2);
  std::nth_element(differences.begin(), differences.begin() + differences.size() / 2, differences.end());
  return differences[differences.size() / 2];
}

TEST_F(EmbeddedVulkan, AViewShowsTheModelInMetres) {
  Reconstructor reconstructor(publicCamera(), handles(), quickOptions());
  reconstructor.process(publicFrame(0));
  const ViewImages images = makeImages();
  {
    View view(reconstructor, viewCamera(), 1);
    caller.frame([&](VkCommandBuffer commands) { view.record(commands, 0, {}, images); });
    EXPECT_THROW(view.record(nullptr, 0, {}, images), Error);
    caller.frame(
        [&](VkCommandBuffer commands) { EXPECT_THROW(view.record(commands, 1, {}, images), Error); });
  }
  EXPECT_LT(differenceFromFirstImage(depthsOf(images)), 0.02);
}

TEST_F(EmbeddedVulkan, ViewsAreDrawnWhileFramesAreTracked) {
  VulkanHandles shared = handles();
  shared.lock_queue = [&] { caller.queue_mutex.lock(); };
  shared.unlock_queue = [&] { caller.queue_mutex.unlock(); };
  Options options = quickOptions();
  options.queue_length = 16;
  Reconstructor reconstructor(publicCamera(), shared, options);
  const ViewImages images = makeImages();
  std::size_t pushed = 0;
  {
    View view(reconstructor, viewCamera(), 1);
    while (pushed < 8) pushed += reconstructor.push(publicFrame(pushed));
    bool tracking = true;
    for (int frames = 0; tracking; ++frames) {
      tracking = reconstructor.trajectory().size() < pushed && frames < 1000;
      const VkCommandBuffer commands = caller.beginFrame();
      view.record(commands, 0, {}, images);
      caller.endFrame(commands);
    }
    reconstructor.wait();
  }
  EXPECT_EQ(reconstructor.trajectory().size(), pushed);
  EXPECT_LT(differenceFromFirstImage(depthsOf(images)), 0.03);
}

/// Where a frame was, seen from the first.
Matrix knownPose(std::size_t frame) {
  const auto& truth = shortSequence().truth;
  const Pose pose = truth[0].world_from_camera.inverse() * truth[frame].world_from_camera;
  Matrix matrix;
  Eigen::Map<Eigen::Matrix4d>(matrix.data()) = pose.matrix();
  return matrix;
}

TEST_F(EmbeddedVulkan, FusionInCallersCommandsIsIntegrates) {
  Reconstructor ours(publicCamera(), handles(), quickOptions()),
      callers(publicCamera(), handles(), quickOptions());
  Fusion fusion(callers);
  const auto fuse = [&](std::size_t i, const auto& depth) {
    ours.integrate(publicFrame(i), knownPose(i));
    do {
      caller.frame([&](VkCommandBuffer commands) { fusion.recordSearch(commands, depth, knownPose(i)); });
    } while (fusion.grow());
    caller.frame([&](VkCommandBuffer commands) { fusion.recordFusion(commands); });
  };
  caller.frame([&](VkCommandBuffer commands) { EXPECT_THROW(fusion.recordFusion(commands), Error); });
  fuse(0, publicFrame(0));
  caller.frame([&](VkCommandBuffer commands) {
    EXPECT_THROW(fusion.recordFusion(commands), Error) << "a frame is fused once";
  });

  Device device(caller.handles());  // for buffers only
  constexpr std::size_t kBefore = 8;
  const auto inBuffer = [&](std::size_t i) {
    const auto depth = publicFrame(i).depth;
    Buffer buffer(device, kBefore + depth.size_bytes(), Memory::Upload);
    std::memcpy(buffer.as<char>().data() + kBefore, depth.data(), depth.size_bytes());
    return buffer;
  };
  const Buffer second = inBuffer(3), third = inBuffer(5);
  fuse(3, DeviceDepth{.buffer = second.handle(), .offset = kBefore, .timestamp = publicFrame(3).timestamp});

  const auto width = static_cast<std::uint32_t>(publicCamera().width),
             height = static_cast<std::uint32_t>(publicCamera().height);
  const VkImage image = caller.makeImage(VK_FORMAT_R16_UINT, VK_IMAGE_ASPECT_COLOR_BIT, width, height);
  caller.frame([&](VkCommandBuffer commands) {
    const VkBufferImageCopy whole{kBefore,           0, 0, {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1}, {},
                                  {width, height, 1}};
    caller.command<PFN_vkCmdCopyBufferToImage>("vkCmdCopyBufferToImage")(
        commands, third.handle(), image, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &whole);
    caller.transition(commands, image, VK_IMAGE_ASPECT_COLOR_BIT, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
                      VK_IMAGE_LAYOUT_GENERAL);
  });
  fuse(5,
       DeviceDepth{.image = image, .layout = VK_IMAGE_LAYOUT_GENERAL, .timestamp = publicFrame(5).timestamp});
  EXPECT_THROW(caller.frame([&](VkCommandBuffer commands) {
    fusion.recordSearch(commands, DeviceDepth{}, knownPose(6));
  }),
               Error);

  const Mesh expected = ours.mesh(), found = callers.mesh();
  EXPECT_GT(found.triangles.size(), 1000u);
  EXPECT_EQ(found.vertices, expected.vertices);
  EXPECT_EQ(found.triangles, expected.triangles);
  EXPECT_EQ(callers.trajectory().back().world_from_camera, ours.trajectory().back().world_from_camera);
  EXPECT_EQ(callers.process(publicFrame(6)).world_from_camera,
            ours.process(publicFrame(6)).world_from_camera);
}

TEST_F(EmbeddedVulkan, FusionIsRefusedWhereLoopsMovePoses) {
  Options options = quickOptions();
  options.settings.push_back({"loops.enabled", "true"});
  std::optional<Reconstructor> reconstructor;
  try {
    reconstructor.emplace(publicCamera(), handles(), options);
  } catch (const Error& error) {
    GTEST_SKIP() << error.what();
  }
  try {
    Fusion fusion(*reconstructor);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), Error::Kind::BadInput);
    EXPECT_THAT(error.what(), ::testing::HasSubstr("loops.enabled"));
  }
}

TEST_F(EmbeddedVulkan, TheCallersShaderReadsTheModel) {
  Options options = quickOptions();
  options.settings.push_back({"mesh.min_weight", "0.1"});  // one frame
  Reconstructor reconstructor(publicCamera(), handles(), options);
  reconstructor.process(publicFrame(0));
  const Mesh mesh = reconstructor.mesh();
  Device device(caller.handles());  // for buffers only
  const auto count = static_cast<std::uint32_t>(mesh.vertices.size());
  ASSERT_GT(count, 1000u);
  Buffer points(device, 3 * 16ull * count, Memory::Upload),
      distances(device, 3 * 4ull * count, Memory::Readback);
  constexpr float kAside = 0.03f;  // along the ray, as the volume measures: a third of the truncation
  for (std::uint32_t i = 0; i < 3 * count; ++i) {  // on the surface, in front of it, behind it
    const auto& v = mesh.vertices[i / 3];
    const float aside = i % 3 == 1 ? -kAside : i % 3 == 2 ? kAside : 0;
    const float factor = 1 + aside / std::hypot(v[0], v[1], v[2]);
    for (int axis = 0; axis < 3; ++axis) points.as<float>()[4 * i + axis] = factor * v[axis];
  }
  const VolumeBuffers volume = volumeBuffers(reconstructor);
  EXPECT_EQ(volume.block_count, reconstructor.blockCount());
  std::vector<VkBuffer> buffers = {volume.layout, volume.table};
  buffers.insert(buffers.end(), volume.tsdf.begin(), volume.tsdf.end());
  buffers.insert(buffers.end(), volume.weight.begin(), volume.weight.end());
  buffers.push_back(points.handle());
  buffers.push_back(distances.handle());
  runShader(caller, kLookup, volume.chunks, buffers, (3 * count + 63) / 64);
  const auto median = [&](std::uint32_t place) {
    std::vector<float> values;
    for (std::uint32_t i = place; i < 3 * count; i += 3) values.push_back(distances.as<float>()[i]);
    std::nth_element(values.begin(), values.begin() + count / 2, values.end());
    return values[count / 2];
  };
  EXPECT_NEAR(median(0), 0, 0.1);
  EXPECT_NEAR(median(1), 1 / 3.0, 0.1);
  EXPECT_NEAR(median(2), -1 / 3.0, 0.1);
}

TEST_F(EmbeddedVulkan, SemaphoresOrderFramesAndTheCallersWork) {
  const VkSemaphoreCreateInfo info{VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO};
  VkSemaphore before, after;
  const auto create = caller.command<PFN_vkCreateSemaphore>("vkCreateSemaphore");
  create(caller.device, &info, nullptr, &before);
  create(caller.device, &info, nullptr, &after);
  {
    Reconstructor reconstructor(publicCamera(), handles(), quickOptions());
    VkSubmitInfo signal{VK_STRUCTURE_TYPE_SUBMIT_INFO};
    signal.signalSemaphoreCount = 1;
    signal.pSignalSemaphores = &before;
    const auto submit = caller.command<PFN_vkQueueSubmit>("vkQueueSubmit");
    submit(caller.queue, 1, &signal, VK_NULL_HANDLE);
    const Semaphores semaphores{{{before, 0}}, {{after, 0}}};
    EXPECT_EQ(reconstructor.process(publicFrame(0), &semaphores).status, Status::Tracked);
    // The layer and the device would both complain of a wait for what nobody signals.
    const VkPipelineStageFlags stage = VK_PIPELINE_STAGE_ALL_COMMANDS_BIT;
    VkSubmitInfo wait{VK_STRUCTURE_TYPE_SUBMIT_INFO};
    wait.waitSemaphoreCount = 1;
    wait.pWaitSemaphores = &after;
    wait.pWaitDstStageMask = &stage;
    submit(caller.queue, 1, &wait, VK_NULL_HANDLE);
    EXPECT_TRUE(caller.works());
  }
  const auto destroy = caller.command<PFN_vkDestroySemaphore>("vkDestroySemaphore");
  destroy(caller.device, before, nullptr);
  destroy(caller.device, after, nullptr);
}

TEST(EmbeddedTimeline, AFrameWaitsForAValueAndSetsTheNext) {
  Caller caller(true, true);
  VkSemaphoreTypeCreateInfo type{VK_STRUCTURE_TYPE_SEMAPHORE_TYPE_CREATE_INFO};
  type.semaphoreType = VK_SEMAPHORE_TYPE_TIMELINE;
  const VkSemaphoreCreateInfo info{VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO, &type};
  VkSemaphore semaphore;
  caller.command<PFN_vkCreateSemaphore>("vkCreateSemaphore")(caller.device, &info, nullptr, &semaphore);
  const auto value = [&] {
    std::uint64_t now = 0;
    caller.command<PFN_vkGetSemaphoreCounterValueKHR>("vkGetSemaphoreCounterValueKHR")(caller.device,
                                                                                       semaphore, &now);
    return now;
  };
  {
    Reconstructor reconstructor(publicCamera(), handlesOf(caller), quickOptions());
    const Semaphores semaphores{{{semaphore, 1}}, {{semaphore, 2}}};
    ASSERT_TRUE(reconstructor.push(publicFrame(0), &semaphores));
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    EXPECT_TRUE(reconstructor.trajectory().empty()) << "nothing runs before the value is reached";
    VkSemaphoreSignalInfo signal{VK_STRUCTURE_TYPE_SEMAPHORE_SIGNAL_INFO, nullptr, semaphore, 1};
    caller.command<PFN_vkSignalSemaphoreKHR>("vkSignalSemaphoreKHR")(caller.device, &signal);
    reconstructor.wait();
    EXPECT_EQ(reconstructor.poll()->status, Status::Tracked);
    EXPECT_TRUE(caller.works());
    EXPECT_EQ(value(), 2u);
  }
  caller.command<PFN_vkDestroySemaphore>("vkDestroySemaphore")(caller.device, semaphore, nullptr);
  EXPECT_THAT(caller.messages(), ::testing::IsEmpty());
}

TEST_F(EmbeddedVulkan, TwoShareTheCallersQueueUnderItsLock) {
  VulkanHandles shared = handles();
  int submits = 0;
  shared.lock_queue = [&] {
    caller.queue_mutex.lock();
    ++submits;
  };
  shared.unlock_queue = [&] { caller.queue_mutex.unlock(); };
  Reconstructor first(publicCamera(), shared, quickOptions()), second(publicCamera(), shared, quickOptions());
  for (std::size_t i = 0; i < 3; ++i) {
    ASSERT_TRUE(first.push(publicFrame(i)));
    ASSERT_TRUE(second.push(publicFrame(i)));
  }
  for (int i = 0; i < 20; ++i) caller.frame([](VkCommandBuffer) {});
  first.wait();
  second.wait();
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_EQ(first.poll()->world_from_camera, second.poll()->world_from_camera);
  EXPECT_GT(submits, 0);
}

// Notes which pipeline caches pipelines are made with.
struct Watched {
  static inline PFN_vkGetInstanceProcAddr get;
  static inline PFN_vkGetDeviceProcAddr get_device;
  static inline PFN_vkCreateComputePipelines create;
  static inline std::set<VkPipelineCache> caches;

  static VkResult VKAPI_CALL createPipelines(VkDevice device, VkPipelineCache cache, std::uint32_t count,
                                             const VkComputePipelineCreateInfo* infos,
                                             const VkAllocationCallbacks* allocator, VkPipeline* out) {
    caches.insert(cache);
    return create(device, cache, count, infos, allocator, out);
  }
  static PFN_vkVoidFunction VKAPI_CALL deviceProc(VkDevice device, const char* name) {
    if (std::strcmp(name, "vkGetDeviceProcAddr") == 0)
      return reinterpret_cast<PFN_vkVoidFunction>(&deviceProc);
    const PFN_vkVoidFunction real = get_device(device, name);
    if (std::strcmp(name, "vkCreateComputePipelines") != 0) return real;
    create = reinterpret_cast<PFN_vkCreateComputePipelines>(real);
    return reinterpret_cast<PFN_vkVoidFunction>(&createPipelines);
  }
  static PFN_vkVoidFunction VKAPI_CALL proc(VkInstance instance, const char* name) {
    const PFN_vkVoidFunction real = get(instance, name);
    if (std::strcmp(name, "vkGetDeviceProcAddr") != 0) return real;
    get_device = reinterpret_cast<PFN_vkGetDeviceProcAddr>(real);
    return reinterpret_cast<PFN_vkVoidFunction>(&deviceProc);
  }
};

TEST_F(EmbeddedVulkan, CallbacksAndPipelineCacheAreTheCallers) {
  VulkanHandles h = handles();
  h.allocator = &caller.callbacks();
  const VkPipelineCacheCreateInfo info{VK_STRUCTURE_TYPE_PIPELINE_CACHE_CREATE_INFO};
  caller.command<PFN_vkCreatePipelineCache>("vkCreatePipelineCache")(caller.device, &info, nullptr,
                                                                     &h.pipeline_cache);
  Watched::get = std::exchange(h.get_instance_proc_addr, Watched::proc);
  {
    Reconstructor reconstructor(publicCamera(), h, quickOptions());
    View view(reconstructor, viewCamera(), 1);
    reconstructor.process(publicFrame(0));
    reconstructor.mesh();
    EXPECT_GT(caller.liveAllocations(), 0);
  }
  EXPECT_EQ(caller.liveAllocations(), 0);
  EXPECT_THAT(Watched::caches, ::testing::ElementsAre(h.pipeline_cache));
  EXPECT_TRUE(caller.works());
  caller.command<PFN_vkDestroyPipelineCache>("vkDestroyPipelineCache")(caller.device, h.pipeline_cache,
                                                                       nullptr);
}

}  // namespace test_vulkan
}  // namespace rosefusion::testing
