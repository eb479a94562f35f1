// The self-test of a device's sums, when a pipeline is made.
#pragma once
#include <filesystem>
#include <functional>

#include "engine/device.h"
#include "host/core/log.h"

namespace rosefusion {

/// Whether sums with compensation are exact on the device: what `file` says of it with this driver, else what
/// `test` finds, which is then written there. A file that cannot be read or written costs a test each time.
/// Says so to `log` where they are not.
bool sumsAreExact(const std::filesystem::path& file, const DeviceInfo& device,
                  const std::function<bool()>& test, const Log& log);

}  // namespace rosefusion
