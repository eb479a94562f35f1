#include "apps/chosen_settings.h"

#include <spdlog/spdlog.h>

namespace rosefusion {

Settings chosenSettings(const std::string& config, const std::vector<std::string>& assignments,
                        const std::string& sensor) {
  const Log log = [](Severity, const std::string& sentence) { spdlog::warn("{}", sentence); };
  Settings settings = loadSettings(config, log);
  if (!sensor.empty()) setField(settings, "depth.sensor", sensor, "--sensor", log);
  for (const std::string& assignment : assignments) applyAssignment(settings, assignment, log);
  requireConsistent(settings);
  return settings;
}

}  // namespace rosefusion
