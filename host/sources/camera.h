// Depth cameras that are plugged into this machine. Each is compiled where its library is found.
#pragma once
#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host/sources/frame_source.h"

namespace rosefusion {

/// Between questions whether to stop; without a frame, after which a camera counts as gone.
inline constexpr std::chrono::milliseconds kCameraWait{50};
inline constexpr std::chrono::seconds kCameraGone{10};

struct CameraOptions {
  std::string device;  ///< which one, as the library names it; empty: the first
  bool colour = false;
  std::optional<Intrinsics> intrinsics;  ///< width and height 0: those of the camera's images
};

/// A kind of camera. `open` is null where this program was built without the library.
struct CameraKind {
  const char* name;     ///< as in "openni2:" or "openni2:DEVICE"
  const char* library;  ///< to install
  bool tried;           ///< whether its code was ever run with a camera
  std::unique_ptr<FrameSource> (*open)(const CameraOptions&);
};

const std::vector<CameraKind>& cameraKinds();

/// The kind that `text` asks for, and which device; null when it names none.
const CameraKind* cameraKindOf(const std::string& text, std::string& device);

/// Throws InputError when the library is not there, no camera is, or it does not start.
std::unique_ptr<FrameSource> openCamera(const CameraKind& kind, const CameraOptions& options);

std::unique_ptr<FrameSource> openOpenNi2(const CameraOptions& options);
std::unique_ptr<FrameSource> openRealSense(const CameraOptions& options);
std::unique_ptr<FrameSource> openAzureKinect(const CameraOptions& options);

}  // namespace rosefusion
