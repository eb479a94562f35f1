#include "host/bench/native_pairs.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "host/core/number_text.h"

namespace rosefusion {

PairedTime NativePairs::figures() const {
  std::vector<double> ratios, cpu_ratios;
  for (std::size_t i = 0; i < device_.size(); ++i) {
    ratios.push_back(device_[i].ms / native_[i].ms);
    cpu_ratios.push_back(device_[i].cpu_ms / native_[i].cpu_ms);
  }
  return {median(device_), median(native_), median(ratios), median(cpu_ratios), 0};
}

double shareApart(std::span<const float> device, std::span<const float> native, double tolerance) {
  const std::size_t both = std::min(device.size(), native.size()),
                    all = std::max(device.size(), native.size());
  std::size_t apart = all - both;
  for (std::size_t i = 0; i < both; ++i)
    if (!(std::abs(double(device[i]) - native[i]) <= tolerance)) ++apart;
  return all ? static_cast<double>(apart) / static_cast<double>(all) : 0;
}

double requireShare(const std::string& device_name, const char* pass, double apart, double allowed) {
  if (apart <= allowed) return apart;
  throw std::runtime_error(printed(
      "%s: of the results of %s %.3g %% are other than the native loop's, where %.3g %% are allowed; do not "
      "trust this device's results.",
      device_name.c_str(), pass, 100 * apart, 100 * allowed));
}

}  // namespace rosefusion
