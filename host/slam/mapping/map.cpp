#include "host/slam/mapping/map.h"

#include <algorithm>
#include <stdexcept>

#include "host/slam/mapping/frame_integrator.h"

namespace rosefusion {

Map::Map(Device& device, const Settings& settings, const Intrinsics& camera)
    : volume(device, volumeOptions(settings.volume)),
      coarse(device, settings.volume),
      keyframes(camera),
      free_space(camera, settings.depth, keyframes),
      open_stretches(settings.tracking.uncertain_deviation) {}

std::size_t Map::insert(const StampedPose& pose) {
  const auto at = std::upper_bound(trajectory.begin(), trajectory.end(), pose,
                                   [](const auto& a, const auto& b) { return a.timestamp < b.timestamp; });
  const auto number = static_cast<std::size_t>(at - trajectory.begin());
  trajectory.insert(at, pose);
  keyframes.renumber(number);
  open_stretches.renumber(number);
  return number;
}

void Map::move(std::span<const Pose> corrected) {
  if (corrected.size() != trajectory.size())
    throw std::logic_error("Not every pose is corrected; this is a mistake in the program.");
  for (std::size_t i = 0; i < corrected.size(); ++i) trajectory[i].world_from_camera = corrected[i];
  keyframes.move(corrected);
  coarse.expire();
}

void Map::clear() {
  volume.clear();
  coarse.clear();
  keyframes.clear();
  trajectory.clear();
  open_stretches.clear();
}

}  // namespace rosefusion
