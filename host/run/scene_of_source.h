// What a source's first images show, before anything is made for them.
#pragma once
#include <optional>

#include "host/settings/automatic.h"
#include "host/sources/peeked_source.h"

namespace rosefusion {

/// None where no setting asks for it, or where hardly a pixel has depth.
std::optional<SceneMeasures> sceneOf(PeekedSource& source, const Settings& settings,
                                     const StopQuestion& stop = {});

}  // namespace rosefusion
