// Times the engine's passes on a generated sequence that is fused with its true poses.
#pragma once
#include <cstdint>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "engine/device.h"
#include "host/settings/settings.h"

namespace rosefusion {

struct BenchOptions {
  Settings settings;
  int frames = 24;  ///< of the generated sequence: 2.4 s of the paper's fast motion, 640 x 480
  std::uint64_t seed = 1;
  int repeat = 15;  ///< measurements of each figure; the median is reported
};

/// One measured pass. CPU time is of the whole process, so that on a CPU device it holds the pass's own work
/// and, unlike wall time, hardly depends on what else the machine does.
struct PassTime {
  double ms = 0;
  double cpu_ms = 0;
};

/// A pass beside its native loop on the same data, both on all cores.
struct PairedTime {
  PassTime device, native;
  double ratio = 0;      ///< device / native, median of neighbouring measurements; 0: there is no native loop
  double cpu_ratio = 0;  ///< the same by CPU time; meaningful for CPU devices
  double differing = 0;  ///< largest share of results that differ by more than rounding
};

/// The fitness pass, all levels of one round of the swarm together, against nativeLosses on the same data.
struct FitnessFigures {
  double ns_per_lookup = 0;
  double native_ns_per_lookup = 0;
  double ratio = 0;      ///< median of the ratios of neighbouring measurements
  double cpu_ratio = 0;  ///< the same by CPU time; meaningful for CPU devices
  double kahan_cost_percent = 0;
  double kahan_cost_cpu_percent = 0;
  double worst_loss_difference = 0;  ///< largest |device - native| of all losses
  std::uint64_t lookups = 0;         ///< of one measurement
};

struct BenchReport {
  DeviceInfo device;
  std::string native;  ///< instruction set and threads of the native loops
  double voxel_size = 0;
  std::uint32_t blocks = 0;
  std::uint64_t volume_bytes = 0;
  int repeat = 0;
  FitnessFigures fitness;
  PairedTime preprocess;
  PassTime allocate;
  PairedTime integrate;  ///< without native loop where colour is fused
  PairedTime refine;
  PairedTime raycast;  ///< without native loop where the volume has colour
  PassTime extract;
  std::uint64_t triangles = 0;  ///< that extract gave
};

/// `progress` is told what is being measured. Throws std::runtime_error when a pass's results are not its
/// native loop's, DeviceError and InputError as Pipeline does.
BenchReport benchPasses(Device& device, const BenchOptions& options,
                        const std::function<void(const std::string&)>& progress = {});

nlohmann::ordered_json benchJson(const BenchReport& report);
/// A table for people.
std::string benchTable(const BenchReport& report);

}  // namespace rosefusion
