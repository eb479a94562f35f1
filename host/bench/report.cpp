#include <nlohmann/json.hpp>

#include "host/bench/pass_bench.h"
#include "host/core/number_text.h"

namespace rosefusion {
namespace {

nlohmann::ordered_json toJson(const PassTime& time, bool cpu_device) {
  nlohmann::ordered_json json = {{"ms", time.ms}};
  if (cpu_device) json["cpu_ms"] = time.cpu_ms;
  return json;
}

nlohmann::ordered_json toJson(const PairedTime& time, bool cpu_device) {
  nlohmann::ordered_json json = toJson(time.device, cpu_device);
  if (time.ratio == 0) return json;
  json["native_ms"] = time.native.ms;
  json["ratio"] = time.ratio;
  if (cpu_device) {
    json["native_cpu_ms"] = time.native.cpu_ms;
    json["cpu_ratio"] = time.cpu_ratio;
  }
  json["differing_share"] = time.differing;
  return json;
}

std::string line(const char* name, const char* format, auto... values) {
  return printed("  %-12s", name) + printed(format, values...) + "\n";
}

std::string line(const char* name, const PassTime& time, bool cpu_device) {
  return cpu_device ? line(name, "%9.2f ms   (%.2f ms of CPU time)", time.ms, time.cpu_ms)
                    : line(name, "%9.2f ms", time.ms);
}

std::string line(const char* name, const PairedTime& time, bool cpu_device) {
  std::string out = line(name, time.device, cpu_device);
  if (time.ratio == 0) return out;
  out += line("  native", time.native, cpu_device);
  return out + (cpu_device ? line("  ratio", "%9.2f      (%.2f by CPU time)", time.ratio, time.cpu_ratio)
                           : line("  ratio", "%9.2f", time.ratio));
}

}  // namespace

nlohmann::ordered_json benchJson(const BenchReport& r) {
  const bool cpu = r.device.type == DeviceType::Cpu;
  const FitnessFigures& f = r.fitness;
  nlohmann::ordered_json fitness = {{"ns_per_lookup", f.ns_per_lookup},
                                    {"native_ns_per_lookup", f.native_ns_per_lookup},
                                    {"ratio", f.ratio},
                                    {"kahan_cost_percent", f.kahan_cost_percent},
                                    {"worst_loss_difference", f.worst_loss_difference},
                                    {"lookups", f.lookups}};
  if (cpu) {
    fitness["cpu_ratio"] = f.cpu_ratio;
    fitness["kahan_cost_cpu_percent"] = f.kahan_cost_cpu_percent;
  }
  nlohmann::ordered_json extract = toJson(r.extract, cpu);
  extract["triangles"] = r.triangles;
  return {
      {"device", {{"name", r.device.name}, {"driver", r.device.driver}, {"type", toString(r.device.type)}}},
      {"native", r.native},
      {"repeat", r.repeat},
      {"volume", {{"voxel_size_m", r.voxel_size}, {"blocks", r.blocks}, {"bytes", r.volume_bytes}}},
      {"fitness", fitness},
      {"preprocess", toJson(r.preprocess, cpu)},
      {"allocate", toJson(r.allocate, cpu)},
      {"integrate", toJson(r.integrate, cpu)},
      {"refine", toJson(r.refine, cpu)},
      {"raycast", toJson(r.raycast, cpu)},
      {"extract", extract}};
}

std::string benchTable(const BenchReport& r) {
  const bool cpu = r.device.type == DeviceType::Cpu;
  const FitnessFigures& f = r.fitness;
  std::string out = r.device.name + ", " + r.device.driver + "; native loops: " + r.native + "\n";
  out += line("volume", "%9u blocks of %.1f cm voxels, %.0f MB", r.blocks, 100 * r.voxel_size,
              static_cast<double>(r.volume_bytes) / 1e6);
  out += line("preprocess", r.preprocess, cpu);
  out += line("allocate", r.allocate, cpu);
  out += line("integrate", r.integrate, cpu);
  out += line("refine", r.refine, cpu);
  out += line("raycast", r.raycast, cpu);
  out += line("extract", r.extract, cpu);
  out += line("fitness", "%9.2f ns per lookup", f.ns_per_lookup);
  out += line("  native", "%9.2f ns per lookup", f.native_ns_per_lookup);
  out += cpu ? line("  ratio", "%9.2f      (%.2f by CPU time)", f.ratio, f.cpu_ratio)
             : line("  ratio", "%9.2f", f.ratio);
  out += cpu ? line("  Kahan", "%+9.1f %%    (%+.1f %% by CPU time)", f.kahan_cost_percent,
                    f.kahan_cost_cpu_percent)
             : line("  Kahan", "%+9.1f %%", f.kahan_cost_percent);
  out += line("  agreement", "%9.1e at most between the losses of device and native loop",
              f.worst_loss_difference);
  return out;
}

}  // namespace rosefusion
