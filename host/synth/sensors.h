// The depth cameras that can be simulated, as their makers describe them.
#pragma once
#include <string>
#include <vector>

#include "host/core/camera.h"

namespace rosefusion {

/// How a camera comes by its depth.
enum class DepthPrinciple {
  Noise,            ///< true depth with noise (DepthNoise), no holes
  Stereo,           ///< two infrared views of a projected pattern, matched
  StructuredLight,  ///< one view of a projector's code, with the projector's shadows
  TimeOfFlight,     ///< phase of modulated light, averaged over each pixel's footprint
  PhoneLidar,       ///< a few hundred points, spread along the edges of the colour image
};

/// Onto which image depth is carried.
enum class Registration {
  None,    ///< none: it stays the depth camera's own
  Points,  ///< the colour camera's; each depth falls onto one pixel, so that a larger image has holes
  Areas,   ///< the colour camera's; each depth fills the pixels that its own covers (librealsense's align)
};

/// What of its image a camera sees.
enum class FieldOfView { Whole, Hexagon, Circle };

/// Lengths in metres, times in seconds, image sizes and focal lengths in pixels.
struct Sensor {
  std::string name = "kinect1";
  DepthPrinciple principle = DepthPrinciple::Noise;
  Intrinsics depth{};  ///< of the depth camera; kNoise: not used, the sequence's own
  double nearest = 0, farthest = 10, fps = 30;
  double baseline = 0;      ///< stereo: between both views; structured light: camera to projector, along +x
  double exposure = 0;      ///< from the middle of the first phase or row to that of the last
  bool row_by_row = false;  ///< time of flight: rows are exposed one after the other, not phases
  double modulation_hz = 0;
  double signal = 0;  ///< time of flight: electrons a phase from a white wall at 1 m
  FieldOfView field = FieldOfView::Whole;
  Registration registration = Registration::None;
  Intrinsics colour{};     ///< of the colour camera
  double colour_at_x = 0;  ///< where it stands beside the depth camera, along +x

  /// Of the images as they are written.
  const Intrinsics& output() const { return registration == Registration::None ? depth : colour; }
  /// Of the depth camera in the frame of the images as they are written.
  Pose outputFromDepth() const;
};

/// All that there are, kinect1 first.
const std::vector<Sensor>& sensors();
/// Throws InputError, which names all there are, for another name.
const Sensor& sensorNamed(const std::string& name);
/// "none", "points", "areas"; throws InputError for another word.
Registration registrationFrom(const std::string& word);
const char* toString(Registration registration);

}  // namespace rosefusion
