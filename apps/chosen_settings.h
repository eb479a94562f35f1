// What --config, --sensor and --set ask of the reconstruction.
#pragma once
#include <string>
#include <vector>

#include "host/settings/settings.h"

namespace rosefusion {

/// A preset or file with a sensor's noise (depth.sensor, where one is named) and assignments ("key=value")
/// over it; old names of settings are told of on standard error. Throws InputError, also for settings that do
/// not go together.
Settings chosenSettings(const std::string& config, const std::vector<std::string>& assignments,
                        const std::string& sensor = {});

}  // namespace rosefusion
