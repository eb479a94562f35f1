#include "host/slam/device_sums.h"

#include <fstream>
#include <optional>
#include <string>
#include <system_error>

namespace rosefusion {
namespace {

constexpr const char* kExact = "exact: ";
constexpr const char* kInexact = "not exact: ";

/// The last line that is of this device and driver counts.
std::optional<bool> knownSums(const std::filesystem::path& file, const std::string& device) {
  std::optional<bool> exact;
  std::ifstream lines(file);
  for (std::string line; std::getline(lines, line);) {
    if (line == kExact + device) exact = true;
    if (line == kInexact + device) exact = false;
  }
  return exact;
}

}  // namespace

bool sumsAreExact(const std::filesystem::path& file, const DeviceInfo& device,
                  const std::function<bool()>& test, const Log& log) {
  const std::string name = device.name + ", " + device.driver + ", Vulkan " + device.api_version;
  std::optional<bool> exact = knownSums(file, name);
  if (!exact) {
    exact = test();
    std::error_code ignored;
    std::filesystem::create_directories(file.parent_path(), ignored);
    // One short line in one write: two processes that find the same disturb each other not.
    std::ofstream(file, std::ios::app) << (*exact ? kExact : kInexact) + name + "\n";
  }
  if (!*exact && log)
    log(Severity::Warning,
        device.name + ": this driver (" + device.driver +
            ") does not add exactly, and tracking loses accuracy; update it, or choose another "
            "device with --device.");
  return *exact;
}

}  // namespace rosefusion
