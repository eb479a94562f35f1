// Choice of the device, its limits, its memory account, and what happens without one.
#include <algorithm>
#include <cstdlib>
#include <thread>

#include "engine/buffer.h"
#include "engine/passes/sum_check.h"
#include "engine/physical_device.h"
#include "tests/engine/validating_device.h"

namespace rosefusion::testing {
namespace test_device {

class Devices : public ValidatingDevice {
 protected:
  static Device open(const std::string& select, const DeviceLimits& limits_at_most = {}) {
    return Device({.select = select, .validation = true, .limits_at_most = limits_at_most});
  }
  static std::string index() { return std::to_string(device().info().index); }
};

TEST_F(Devices, TheListNamesEveryDeviceAndItsLimits) {
  const auto devices = listDevices();
  ASSERT_FALSE(devices.empty());
  for (std::size_t i = 0; i < devices.size(); ++i) {
    EXPECT_EQ(devices[i].index, static_cast<int>(i));
    EXPECT_FALSE(devices[i].name.empty());
    EXPECT_FALSE(devices[i].driver.empty());
    EXPECT_GT(devices[i].limits.max_storage_buffer_bytes, 0u);
    EXPECT_GT(devices[i].limits.max_allocation_bytes, 0u);
    EXPECT_GT(devices[i].limits.memory_bytes, 0u);
  }
  EXPECT_EQ(devices[device().info().index].name, device().info().name);
  EXPECT_EQ(devices[device().info().index].rejected_because, "");
}

TEST_F(Devices, AreChosenByIndexNameAndType) {
  const DeviceInfo& wanted = device().info();
  EXPECT_EQ(open(index()).info().index, wanted.index);
  EXPECT_EQ(open(wanted.name).info().name, wanted.name);
  std::string part = wanted.name.substr(0, wanted.name.size() / 2);
  std::transform(part.begin(), part.end(), part.begin(), [](unsigned char c) { return std::toupper(c); });
  EXPECT_EQ(open(part).info().name, wanted.name);
  EXPECT_EQ(open(toString(wanted.type)).info().type, wanted.type);
}

TEST_F(Devices, TheEnvironmentChoosesUnlessTheCallerDoes) {
  const char* before = std::getenv("ROSEFUSION_DEVICE");
  const std::string kept = before ? before : "";
  setenv("ROSEFUSION_DEVICE", index().c_str(), 1);
  EXPECT_EQ(open("").info().index, device().info().index);
  setenv("ROSEFUSION_DEVICE", "no such device", 1);
  EXPECT_TRUE(throwsDeviceError([] { open(""); }, DeviceErrorCode::NoDevice, {"no such device"}));
  EXPECT_EQ(open(index()).info().index, device().info().index);
  before ? setenv("ROSEFUSION_DEVICE", kept.c_str(), 1) : unsetenv("ROSEFUSION_DEVICE");
}

DeviceInfo madeUp(const char* name, DeviceType type, bool conformant) {
  DeviceInfo info;
  info.name = name;
  info.type = type;
  info.conformant = conformant;
  return info;
}

// As on Windows' subsystem for Linux: Direct3D 12 calls itself the graphics card, and lacks much of Vulkan.
TEST(DeviceChoice, ADriverThatIsNotConformantComesLast) {
  std::vector<DeviceInfo> devices = {madeUp("dzn", DeviceType::Discrete, false),
                                     madeUp("llvmpipe", DeviceType::Cpu, true)};
  EXPECT_EQ(chooseDevice(devices, ""), 1u);
  EXPECT_EQ(chooseDevice(devices, "dzn"), 0u);
  devices.push_back(madeUp("apu", DeviceType::Integrated, true));
  EXPECT_EQ(chooseDevice(devices, ""), 2u);
  devices = {madeUp("dzn cpu", DeviceType::Cpu, false), madeUp("dzn", DeviceType::Discrete, false)};
  EXPECT_EQ(chooseDevice(devices, ""), 1u);
}

TEST_F(Devices, TheSoftwareDeviceIsConformant) {
  if (device().info().type != DeviceType::Cpu) GTEST_SKIP();
  EXPECT_TRUE(device().info().conformant);
}

TEST_F(Devices, WhenNoneFitsTheSentenceSaysWhyOfEach) {
  const auto refused = throwsDeviceError([] { open("voodoo"); }, DeviceErrorCode::NoDevice,
                                         {"--device", device().info().name.c_str(), "is not 'voodoo'"});
  EXPECT_TRUE(refused);
  for (const DeviceInfo& info : listDevices())
    EXPECT_THAT(refused.message(),
                ::testing::HasSubstr(std::to_string(info.index).append("] ").append(info.name)));
  EXPECT_TRUE(throwsDeviceError([] { open("99"); }, DeviceErrorCode::NoDevice, {"is not '99'"}));
}

TEST_F(Devices, TooSmallLimitsAreNamed) {
  const std::pair<DeviceLimits, const char*> cases[] = {
      {{.max_storage_buffer_bytes = 1 << 20}, "maxStorageBufferRange is 1048576"},
      {{.max_storage_buffers = 4}, "maxPerStageDescriptorStorageBuffers is 4"},
      {{.max_workgroup_invocations = 64}, "maxComputeWorkGroupInvocations is 64"},
      {{.max_push_constant_bytes = 64}, "maxPushConstantsSize is 64"},
      {{.max_shared_memory_bytes = 1024}, "maxComputeSharedMemorySize is 1024"},
  };
  for (const auto& [limits, reason] : cases) {
    EXPECT_NE(listDevices(limits)[device().info().index].rejected_because.find(reason), std::string::npos)
        << reason;
    EXPECT_TRUE(throwsDeviceError([&] { open(index(), limits); }, DeviceErrorCode::NoDevice,
                                  {reason, "rosefusion needs"}));
  }
}

TEST_F(Devices, SeveralWorkSideBySide) {
  Device other = open(index());
  bool first = false, second = false;
  // One device per thread; they share nothing.
  std::thread thread([&] {
    for (int i = 0; i < 5; ++i) first = compensatedSumsWork(other);
  });
  for (int i = 0; i < 5; ++i) second = compensatedSumsWork(device());
  thread.join();
  EXPECT_TRUE(first);
  EXPECT_TRUE(second);
  EXPECT_THAT(other.validationMessages(), ::testing::IsEmpty());
}

TEST_F(Devices, OneMayEndBeforeAnother) {
  auto first = std::make_unique<Device>(deviceUnderTest());
  Device second(deviceUnderTest());
  const Buffer kept(second, 1024, Memory::Upload);
  first.reset();
  EXPECT_TRUE(compensatedSumsWork(second));
  EXPECT_EQ(second.allocatedBytes(), 1024u);
}

TEST_F(Devices, AMovedDeviceKeepsItsBuffers) {
  Device first(deviceUnderTest());
  Buffer buffer(first, 4096, Memory::Upload);
  Device second = std::move(first);
  EXPECT_EQ(second.allocatedBytes(), 4096u);
  buffer.as<int>()[7] = 42;
  buffer = Buffer();
  EXPECT_EQ(second.allocatedBytes(), 0u);
}

TEST_F(Devices, TheMemoryAccountReturnsToItsStart) {
  const std::uint64_t start = device().allocatedBytes();
  {
    Buffer a(device(), 1000, Memory::Device), b(device(), 1, Memory::Upload),
        c(device(), 6, Memory::Readback);
    EXPECT_EQ(a.bytes(), 1000u);
    EXPECT_EQ(b.bytes(), 16u);
    EXPECT_EQ(device().allocatedBytes(), start + 1000 + 16 + 16);
    a = std::move(b);  // the thousand bytes go
    EXPECT_EQ(device().allocatedBytes(), start + 16 + 16);
    Buffer d(std::move(c));
    EXPECT_EQ(device().allocatedBytes(), start + 16 + 16);
  }
  EXPECT_EQ(device().allocatedBytes(), start);
}

TEST_F(Devices, BuffersBeyondTheMemoryAreOutOfMemory) {
  const std::uint64_t start = device().allocatedBytes();
  const DeviceLimits& limits = device().info().limits;
  for (const std::uint64_t bytes :
       {limits.max_allocation_bytes + 1, std::uint64_t(1) << 50, ~std::uint64_t(0)})
    for (const Memory memory : {Memory::Device, Memory::Upload, Memory::Readback})
      EXPECT_TRUE(throwsDeviceError([&] { Buffer(device(), bytes, memory); }, DeviceErrorCode::OutOfMemory,
                                    {"MiB", "volume.voxel_size"}));
  EXPECT_EQ(device().allocatedBytes(), start);
  EXPECT_TRUE(compensatedSumsWork(device())) << "the device is no longer usable";
}

TEST_F(Devices, OnlyMappedBuffersCanBeRead) {
  const Buffer buffer(device(), 64, Memory::Device), empty;
  EXPECT_TRUE(throwsDeviceError([&] { buffer.as<int>(); }, DeviceErrorCode::Programming, {"not mapped"}));
  EXPECT_TRUE(throwsDeviceError([&] { empty.as<int>(); }, DeviceErrorCode::Programming, {"not mapped"}));
}

/// Exits with 0 when both ways to a device throw `code` and say `part`; prints what else happened. For child
/// processes.
[[noreturn]] void exitAfterExpecting(DeviceErrorCode code, const char* part, bool validation) {
  const auto list = throwsDeviceError([] { listDevices(); }, code, {part});
  const auto open = throwsDeviceError([&] { Device device({.validation = validation}); }, code, {part});
  const bool passed = open && (list || validation);
  std::fprintf(stderr, "%s | %s\n", list.message(), open.message());
  std::_Exit(passed ? 0 : 1);  // no leak check of the driver in the child
}

// The loader reads its environment once, so each case runs in a process of its own ("threadsafe": a new one).
class WithoutDriver : public ::testing::Test {
 protected:
  void SetUp() override { GTEST_FLAG_SET(death_test_style, "threadsafe"); }
  static void useDrivers(const char* manifest) {
    setenv("VK_DRIVER_FILES", manifest, 1);
    setenv("VK_ICD_FILENAMES", manifest, 1);
    unsetenv("VK_ADD_DRIVER_FILES");
  }
};

TEST_F(WithoutDriver, TheSentenceSaysWhatToInstall) {
  EXPECT_EXIT(
      {
        useDrivers("/nonexistent/driver.json");
        exitAfterExpecting(DeviceErrorCode::NoDriver, "mesa-vulkan-drivers", false);
      },
      ::testing::ExitedWithCode(0), "");
}

TEST_F(WithoutDriver, ADriverWithoutItsHardwareIsTheSame) {
  EXPECT_EXIT(
      {
        useDrivers(ROSEFUSION_EMPTY_DRIVER);
        exitAfterExpecting(DeviceErrorCode::NoDriver, "finds a device", false);
      },
      ::testing::ExitedWithCode(0), "");
}

TEST_F(WithoutDriver, AnOldLoaderIsNamed) {
  const char* before = std::getenv("LD_LIBRARY_PATH");
  const std::string kept = before ? before : "";
  setenv("LD_LIBRARY_PATH", ROSEFUSION_OLD_LOADER, 1);  // heeded by the new process
  EXPECT_EXIT(exitAfterExpecting(DeviceErrorCode::NoDriver, "Vulkan 1.0.0, rosefusion needs 1.1.0", false),
              ::testing::ExitedWithCode(0), "libvulkan1");
  before ? setenv("LD_LIBRARY_PATH", kept.c_str(), 1) : unsetenv("LD_LIBRARY_PATH");
}

TEST_F(WithoutDriver, AMissingValidationLayerIsNamed) {
  EXPECT_EXIT(
      {
        setenv("VK_LAYER_PATH", "/nonexistent", 1);
        exitAfterExpecting(DeviceErrorCode::NoDriver, "vulkan-validationlayers", true);
      },
      ::testing::ExitedWithCode(0), "");
}

}  // namespace test_device
}  // namespace rosefusion::testing
