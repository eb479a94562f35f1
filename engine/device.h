// A Vulkan device: its choice, its limits, its memory account.
#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace rosefusion {

enum class DeviceType { Discrete, Integrated, Virtual, Cpu, Other };
const char* toString(DeviceType type);

struct DeviceLimits {
  std::uint64_t max_storage_buffer_bytes = 0;  ///< largest range one binding may cover
  std::uint32_t max_storage_buffers = 0;       ///< per compute stage
  std::uint32_t max_texels = 0;                ///< of one texel buffer
  std::uint32_t max_workgroup_invocations = 0;
  std::uint32_t max_workgroup_count_x = 0;
  std::uint32_t max_push_constant_bytes = 0;
  std::uint32_t max_shared_memory_bytes = 0;
  std::uint32_t subgroup_size = 0;  ///< reported only; no pass depends on it
  /// That buffers can fill: of the device's own heaps, or of all where it shares the host's memory; no more
  /// than what other programs leave, where the driver knows (VK_EXT_memory_budget).
  std::uint64_t memory_bytes = 0;
  std::uint64_t max_allocation_bytes = 0;  ///< of one buffer
};

struct DeviceInfo {
  int index = 0;  ///< position in the loader's list, usable as DeviceOptions::select; -1: a caller's device
  std::string name;
  std::string driver;
  std::string api_version;
  DeviceType type = DeviceType::Other;
  bool conformant = true;  ///< false: the driver says that it does not pass Vulkan's tests
  DeviceLimits limits;
  std::string rejected_because;  ///< empty when rosefusion can run on it
  /// Whether what the host writes lies in another memory than the shaders' own.
  bool hasOwnMemory() const { return type == DeviceType::Discrete || type == DeviceType::Virtual; }
  /// Whether a kernel can bind all chunks of the volume's pools. Where it cannot (Raspberry Pi: 8 buffers), a
  /// volume has one chunk, as large as a storage binding can be.
  bool bindsAllChunks() const { return limits.max_storage_buffers >= 16; }
  /// Whether shaders read through texel buffers: on software devices, where llvmpipe is much faster so, and
  /// where these hold at least as much as any storage binding. GPUs were only ever measured without.
  bool readsTexels() const { return type == DeviceType::Cpu && 4ull * limits.max_texels >= (128u << 20); }
};

/// All devices the loader knows, the unusable ones with the reason. Throws DeviceError (NoDriver) without a
/// loader or without a device. `limits_at_most`: as in DeviceOptions.
std::vector<DeviceInfo> listDevices(const DeviceLimits& limits_at_most = {});

struct DeviceOptions {
  /// Index, part of the name (any case), or type (discrete, integrated, virtual, cpu). Empty:
  /// $ROSEFUSION_DEVICE if set, else the best type present, a hardware GPU before the CPU; before all, one
  /// whose driver is conformant.
  std::string select;
  bool validation = false;  ///< load VK_LAYER_KHRONOS_validation; its absence is a DeviceError
  /// Non-zero values make the device report no more than that: tests see what smaller devices would do.
  DeviceLimits limits_at_most;
};

/// What a Device was given to do since it was made.
struct DeviceWork {
  std::uint64_t submits = 0;
  std::uint64_t dispatches = 0;
  std::uint64_t copied_bytes = 0;  ///< between buffers
};

struct CallerDevice;  // engine/caller_device.h

/// An instance, a logical device and one compute queue, its own or a caller's. Movable; several may live in
/// one process and are independent. Buffers, kernels and recorders may be made and used on several threads,
/// each of them on one at a time.
class Device {
 public:
  explicit Device(const DeviceOptions& options = {});
  /// On the caller's handles, none of which it owns. Throws DeviceError: Programming for null handles,
  /// MissingLimit naming all that the device lacks.
  explicit Device(const CallerDevice& caller);
  ~Device();
  Device(Device&&) noexcept;
  Device& operator=(Device&&) noexcept;

  const DeviceInfo& info() const;
  /// Bytes of device memory held by this Device's buffers now.
  std::uint64_t allocatedBytes() const;
  DeviceWork work() const;
  /// What the validation layer said so far (warnings and errors); tests fail when it is not empty. On a
  /// caller's device the caller hears it.
  const std::vector<std::string>& validationMessages() const;

  struct Impl;
  Impl& impl() const { return *impl_; }

 private:
  std::unique_ptr<Impl> impl_;
};

}  // namespace rosefusion
