// The engine on an application's own Vulkan device: nothing of it is lost, everything it lacks is named.
#include <cstring>
#include <set>
#include <thread>

#include "engine/buffer.h"
#include "engine/passes/sum_check.h"
#include "tests/engine/caller.h"
#include "tests/engine/validating_device.h"

namespace rosefusion::testing {
namespace test_caller_device {

class CallerDevices : public ::testing::Test {
 protected:
  void TearDown() override { EXPECT_THAT(caller.messages(), ::testing::IsEmpty()); }
  Caller caller;
};

TEST_F(CallerDevices, WithoutAnyFeatureOrExtensionIsEnough) {
  EXPECT_THAT(missingOf(caller.handles()), ::testing::IsEmpty());
  Device device(caller.handles());
  EXPECT_TRUE(compensatedSumsWork(device));
  EXPECT_EQ(device.info().rejected_because, "");
  EXPECT_EQ(device.info().index, -1);
}

TEST_F(CallerDevices, ItsHandlesOutliveTheEngine) {
  for (int i = 0; i < 2; ++i) {
    Device device(caller.handles());
    EXPECT_TRUE(compensatedSumsWork(device));
  }
  EXPECT_TRUE(caller.works());
}

TEST_F(CallerDevices, TwoEnginesWorkSideBySide) {
  Caller other;
  Device first(caller.handles()), second(other.handles()), third(caller.handles());  // two on one device
  bool on_first = false, on_second = false, on_third = false;
  std::thread thread([&] { on_second = compensatedSumsWork(second); });
  on_first = compensatedSumsWork(first);
  on_third = compensatedSumsWork(third);
  thread.join();
  EXPECT_TRUE(on_first && on_second && on_third);
  EXPECT_THAT(other.messages(), ::testing::IsEmpty());
}

TEST_F(CallerDevices, TheQueueIsUsedUnderTheCallersLock) {
  CallerDevice handles = caller.handles();
  int locked = 0, unlocked = 0;
  handles.lock_queue = [&] { EXPECT_EQ(++locked, unlocked + 1); };
  handles.unlock_queue = [&] { EXPECT_EQ(++unlocked, locked); };
  Device device(handles);
  EXPECT_TRUE(compensatedSumsWork(device));
  EXPECT_GT(locked, 0);
  EXPECT_EQ(locked, unlocked);
}

TEST_F(CallerDevices, APipelineCacheIsUsedAndKept) {
  VkPipelineCacheCreateInfo info{VK_STRUCTURE_TYPE_PIPELINE_CACHE_CREATE_INFO};
  CallerDevice handles = caller.handles();
  caller.command<PFN_vkCreatePipelineCache>("vkCreatePipelineCache")(caller.device, &info, nullptr,
                                                                     &handles.pipeline_cache);
  const auto size = [&] {
    std::size_t bytes = 0;
    caller.command<PFN_vkGetPipelineCacheData>("vkGetPipelineCacheData")(
        caller.device, handles.pipeline_cache, &bytes, nullptr);
    return bytes;
  };
  {
    Device device(handles);
    EXPECT_TRUE(compensatedSumsWork(device));
  }
  EXPECT_GT(size(), 0u);
  caller.command<PFN_vkDestroyPipelineCache>("vkDestroyPipelineCache")(caller.device, handles.pipeline_cache,
                                                                       nullptr);
}

// What the engine creates, it creates through vkGetDeviceProcAddr; here each command that takes allocation
// callbacks is replaced by one that notes whether it was given the caller's.
struct Watched {
  static inline PFN_vkGetInstanceProcAddr get;
  static inline PFN_vkGetDeviceProcAddr get_device;
  static inline const VkAllocationCallbacks* expected;
  static inline std::set<std::string> right, wrong;
};

template <int kCommand>
struct Watch {
  static inline PFN_vkVoidFunction real;
  static inline std::string name;
  // vkCreate... and vkAllocateMemory: (device, info, callbacks, out).
  static VkResult VKAPI_CALL create(VkDevice device, const void* info, const VkAllocationCallbacks* callbacks,
                                    void* out) {
    const bool same = callbacks && callbacks->pUserData == Watched::expected->pUserData;
    (same ? Watched::right : Watched::wrong).insert(name);
    using Create = VkResult(VKAPI_PTR*)(VkDevice, const void*, const VkAllocationCallbacks*, void*);
    return reinterpret_cast<Create>(real)(device, info, callbacks, out);
  }
};

constexpr const char* kCreating[] = {
    "vkCreateBuffer",         "vkAllocateMemory",     "vkCreateDescriptorSetLayout",
    "vkCreatePipelineLayout", "vkCreateShaderModule", "vkCreateCommandPool",
    "vkCreateDescriptorPool", "vkCreateFence",        "vkCreatePipelineCache"};

template <int kCommand = 0>
PFN_vkVoidFunction watch(const char* name, PFN_vkVoidFunction real) {
  if constexpr (kCommand == std::size(kCreating)) {
    return real;
  } else {
    if (std::strcmp(name, kCreating[kCommand]) != 0) return watch<kCommand + 1>(name, real);
    Watch<kCommand>::real = real;
    Watch<kCommand>::name = name;
    return reinterpret_cast<PFN_vkVoidFunction>(&Watch<kCommand>::create);
  }
}

PFN_vkVoidFunction VKAPI_CALL watchingDeviceProc(VkDevice device, const char* name) {
  if (std::strcmp(name, "vkGetDeviceProcAddr") == 0)
    return reinterpret_cast<PFN_vkVoidFunction>(&watchingDeviceProc);
  return watch(name, Watched::get_device(device, name));
}
PFN_vkVoidFunction VKAPI_CALL watchingInstanceProc(VkInstance instance, const char* name) {
  if (std::strcmp(name, "vkGetDeviceProcAddr") != 0) return Watched::get(instance, name);
  Watched::get_device = reinterpret_cast<PFN_vkGetDeviceProcAddr>(Watched::get(instance, name));
  return reinterpret_cast<PFN_vkVoidFunction>(&watchingDeviceProc);
}

TEST_F(CallerDevices, CallersAllocatorMakesAndFreesAll) {
  CallerDevice handles = caller.handles();
  handles.allocator = &caller.callbacks();
  Watched::get = handles.get_instance_proc_addr;
  Watched::expected = handles.allocator;
  handles.get_instance_proc_addr = watchingInstanceProc;
  {
    Device device(handles);
    handles.allocator = nullptr;  // the callbacks were copied
    EXPECT_TRUE(compensatedSumsWork(device));
  }
  EXPECT_THAT(Watched::wrong, ::testing::IsEmpty());
  EXPECT_EQ(Watched::right.size(), std::size(kCreating)) << "the engine makes one of each";
  EXPECT_GT(caller.allocations(), 0);
  EXPECT_EQ(caller.liveAllocations(), 0);
}

// A device with three memory types, over the one of Mesa's software device: a small heap of its own, and the
// host's, where what is cached is not coherent.
struct Heaps {
  static inline PFN_vkGetInstanceProcAddr get;
  static inline PFN_vkGetDeviceProcAddr get_device;
  static inline PFN_vkGetPhysicalDeviceMemoryProperties properties;
  static inline PFN_vkGetBufferMemoryRequirements requirements;
  static inline PFN_vkAllocateMemory allocate;
  static inline PFN_vkInvalidateMappedMemoryRanges invalidate;
  static inline std::vector<std::uint32_t> asked;  // for which types, in this order
  static inline int invalidated;
  static constexpr std::uint64_t kOwn = 1 << 20;  // bytes

  static void VKAPI_CALL threeTypes(VkPhysicalDevice physical, VkPhysicalDeviceMemoryProperties* out) {
    properties(physical, out);
    out->memoryTypeCount = 3;
    out->memoryHeapCount = 2;
    out->memoryHeaps[1] = {out->memoryHeaps[0].size, 0};
    out->memoryHeaps[0] = {kOwn, VK_MEMORY_HEAP_DEVICE_LOCAL_BIT};
    out->memoryTypes[0] = {VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT, 0};
    out->memoryTypes[1] = {VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT, 1};
    out->memoryTypes[2] = {VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_CACHED_BIT, 1};
  }
  static void VKAPI_CALL anyType(VkDevice device, VkBuffer buffer, VkMemoryRequirements* out) {
    requirements(device, buffer, out);
    out->memoryTypeBits = 7;
  }
  static VkResult VKAPI_CALL noted(VkDevice device, const VkMemoryAllocateInfo* info,
                                   const VkAllocationCallbacks* callbacks, VkDeviceMemory* out) {
    asked.push_back(info->memoryTypeIndex);
    if (info->memoryTypeIndex == 0 && info->allocationSize > kOwn / 2) return VK_ERROR_OUT_OF_DEVICE_MEMORY;
    VkMemoryAllocateInfo real = *info;
    real.memoryTypeIndex = 0;
    return allocate(device, &real, callbacks, out);
  }
  static VkResult VKAPI_CALL counted(VkDevice device, std::uint32_t count,
                                     const VkMappedMemoryRange* ranges) {
    ++invalidated;
    return invalidate(device, count, ranges);
  }
  template <typename Command>
  static PFN_vkVoidFunction replace(Command& real, PFN_vkVoidFunction found, Command by) {
    real = reinterpret_cast<Command>(found);
    return reinterpret_cast<PFN_vkVoidFunction>(by);
  }
  static PFN_vkVoidFunction VKAPI_CALL deviceProc(VkDevice device, const char* name) {
    const PFN_vkVoidFunction found = get_device(device, name);
    const std::string command = name;
    if (command == "vkGetBufferMemoryRequirements") return replace(requirements, found, &anyType);
    if (command == "vkAllocateMemory") return replace(allocate, found, &noted);
    if (command == "vkInvalidateMappedMemoryRanges") return replace(invalidate, found, &counted);
    return found;
  }
  static PFN_vkVoidFunction VKAPI_CALL proc(VkInstance instance, const char* name) {
    const PFN_vkVoidFunction found = get(instance, name);
    const std::string command = name;
    if (command == "vkGetPhysicalDeviceMemoryProperties") return replace(properties, found, &threeTypes);
    if (command == "vkGetDeviceProcAddr") return replace(get_device, found, &deviceProc);
    return found;
  }
};

TEST_F(CallerDevices, WhereAHeapIsFullOrTooSmallAnotherServes) {
  CallerDevice handles = caller.handles();
  Heaps::get = handles.get_instance_proc_addr;
  handles.get_instance_proc_addr = Heaps::proc;
  Device device(handles);
  Heaps::asked.clear();
  const Buffer fits(device, Heaps::kOwn / 4, Memory::Device);
  const Buffer full(device, Heaps::kOwn - 4096, Memory::Device);
  const Buffer larger(device, 2 * Heaps::kOwn, Memory::Device);
  EXPECT_THAT(Heaps::asked, ::testing::ElementsAre(0, 0, 1, 1));
}

TEST_F(CallerDevices, IncoherentMemoryIsInvalidatedForReading) {
  CallerDevice handles = caller.handles();
  Heaps::get = handles.get_instance_proc_addr;
  handles.get_instance_proc_addr = Heaps::proc;
  Device device(handles);
  Heaps::asked.clear();
  Heaps::invalidated = 0;
  const Buffer read(device, 1024, Memory::Readback), written(device, 1024, Memory::Upload);
  EXPECT_THAT(Heaps::asked, ::testing::ElementsAre(2, 1));
  written.as<int>();
  EXPECT_EQ(Heaps::invalidated, 0);
  read.as<int>();
  EXPECT_EQ(Heaps::invalidated, 1);
  EXPECT_TRUE(compensatedSumsWork(device));
  EXPECT_GT(Heaps::invalidated, 1);
}

// A poorer device: what the driver says, with less of two limits and without a compute queue.
struct Poor {
  static inline PFN_vkGetInstanceProcAddr get;
  static inline PFN_vkGetPhysicalDeviceProperties properties;
  static inline PFN_vkGetPhysicalDeviceQueueFamilyProperties families;

  static void VKAPI_CALL poorProperties(VkPhysicalDevice physical, VkPhysicalDeviceProperties* out) {
    properties(physical, out);
    out->limits.maxPerStageDescriptorStorageBuffers = 7;
    out->limits.maxPushConstantsSize = 96;
  }
  static void VKAPI_CALL poorFamilies(VkPhysicalDevice physical, std::uint32_t* count,
                                      VkQueueFamilyProperties* out) {
    families(physical, count, out);
    for (std::uint32_t i = 0; out && i < *count; ++i) out[i].queueFlags &= ~VK_QUEUE_COMPUTE_BIT;
  }
  static PFN_vkVoidFunction VKAPI_CALL proc(VkInstance instance, const char* name) {
    const PFN_vkVoidFunction real = get(instance, name);
    if (std::strcmp(name, "vkGetPhysicalDeviceProperties") == 0) {
      properties = reinterpret_cast<PFN_vkGetPhysicalDeviceProperties>(real);
      return reinterpret_cast<PFN_vkVoidFunction>(&poorProperties);
    }
    if (std::strcmp(name, "vkGetPhysicalDeviceQueueFamilyProperties") == 0) {
      families = reinterpret_cast<PFN_vkGetPhysicalDeviceQueueFamilyProperties>(real);
      return reinterpret_cast<PFN_vkVoidFunction>(&poorFamilies);
    }
    return real;
  }
};

TEST_F(CallerDevices, AllThatIsMissingIsNamedBeforeAnyWork) {
  CallerDevice handles = caller.handles();
  Poor::get = handles.get_instance_proc_addr;
  handles.get_instance_proc_addr = Poor::proc;
  handles.device = nullptr;  // not made yet
  handles.queue = nullptr;
  using ::testing::HasSubstr;
  EXPECT_THAT(missingOf(handles), ::testing::UnorderedElementsAre(
                                      HasSubstr("maxPerStageDescriptorStorageBuffers is 7"),
                                      HasSubstr("maxPushConstantsSize is 96"), HasSubstr("no compute queue"),
                                      HasSubstr("queue family 0 has no compute")));
  handles.device = caller.device;
  handles.queue = caller.queue;
  handles.allocator = &caller.callbacks();
  EXPECT_TRUE(throwsDeviceError([&] { Device device(handles); }, DeviceErrorCode::MissingLimit,
                                {"maxPerStageDescriptorStorageBuffers is 7", "maxPushConstantsSize is 96"}));
  EXPECT_EQ(caller.allocations(), 0) << "nothing is made on a device that cannot be used";
}

TEST_F(CallerDevices, AnOldInstanceOrAWrongFamilyIsNamed) {
  CallerDevice handles = caller.handles();
  handles.api_version = VK_API_VERSION_1_0;
  EXPECT_THAT(missingOf(handles), ::testing::ElementsAre(::testing::HasSubstr("made for Vulkan 1.0")));
  handles = caller.handles();
  handles.queue_family = 7;
  EXPECT_THAT(missingOf(handles), ::testing::ElementsAre(::testing::HasSubstr("no queue family 7")));
}

TEST_F(CallerDevices, HandlesThatAreMissingAreRefused) {
  for (int i = 0; i < 5; ++i) {
    CallerDevice handles = caller.handles();
    if (i == 0) handles.get_instance_proc_addr = nullptr;
    if (i == 1) handles.instance = nullptr;
    if (i == 2) handles.physical_device = nullptr;
    if (i == 3) handles.device = nullptr;
    if (i == 4) handles.queue = nullptr;
    EXPECT_TRUE(throwsDeviceError([&] { Device device(handles); }, DeviceErrorCode::Programming,
                                  {"must not be null"}));
  }
}

}  // namespace test_caller_device
}  // namespace rosefusion::testing
