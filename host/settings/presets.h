// The presets of apps/presets, embedded when the library is built.
#pragma once
#include <span>
#include <string_view>

namespace rosefusion {

struct Preset {
  std::string_view name;
  std::string_view yaml;
};

std::span<const Preset> presets();

}  // namespace rosefusion
