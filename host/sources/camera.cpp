#include "host/sources/camera.h"

#include <spdlog/spdlog.h>

#include <string_view>

#include "host/core/error.h"

namespace rosefusion {

const std::vector<CameraKind>& cameraKinds() {
  static const std::vector<CameraKind> kinds{
#ifdef ROSEFUSION_OPENNI2
      {"openni2", "libopenni2-dev", false, openOpenNi2},
#else
      {"openni2", "libopenni2-dev", false, nullptr},
#endif
#ifdef ROSEFUSION_REALSENSE
      {"realsense", "librealsense2-dev", false, openRealSense},
#else
      {"realsense", "librealsense2-dev", false, nullptr},
#endif
#ifdef ROSEFUSION_AZURE_KINECT
      {"k4a", "libk4a1.4-dev", false, openAzureKinect},
#else
      {"k4a", "libk4a1.4-dev", false, nullptr},
#endif
  };
  return kinds;
}

const CameraKind* cameraKindOf(const std::string& text, std::string& device) {
  for (const CameraKind& kind : cameraKinds()) {
    const std::string prefix = std::string(kind.name) + ":";
    if (!text.starts_with(prefix)) continue;
    device = text.substr(prefix.size());
    return &kind;
  }
  return nullptr;
}

std::unique_ptr<FrameSource> openCamera(const CameraKind& kind, const CameraOptions& options) {
  if (!kind.open)
    throw InputError(std::string(kind.name) +
                     ": this rosefusion was built without that camera's library; install " + kind.library +
                     " and build it again.");
  if (!kind.tried)
    spdlog::warn(
        "{}: the code for these cameras compiles, but was never tried with one; please report what happens",
        kind.name);
  return kind.open(options);
}

}  // namespace rosefusion
