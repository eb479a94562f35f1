// Wall and CPU time of a piece of work, and medians.
#pragma once
#include <algorithm>
#include <chrono>
#include <vector>

#include "host/bench/pass_bench.h"
#include "host/core/system.h"

namespace rosefusion {

inline double cpuMilliseconds() {
  return 1e3 * processorSeconds();
}

template <typename Work>
PassTime timed(Work&& work) {
  const double cpu = cpuMilliseconds();
  const auto start = std::chrono::steady_clock::now();
  work();
  const std::chrono::duration<double, std::milli> wall = std::chrono::steady_clock::now() - start;
  return {wall.count(), cpuMilliseconds() - cpu};
}

inline PassTime operator+(PassTime a, PassTime b) {
  return {a.ms + b.ms, a.cpu_ms + b.cpu_ms};
}

/// `values` must not be empty.
inline double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

inline PassTime median(const std::vector<PassTime>& times) {
  std::vector<double> wall, cpu;
  for (const PassTime& t : times) {
    wall.push_back(t.ms);
    cpu.push_back(t.cpu_ms);
  }
  return {median(wall), median(cpu)};
}

}  // namespace rosefusion
