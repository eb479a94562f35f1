// What goes into a reconstruction and comes out of it: plain values, no other library.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "rosefusion/export.h"

namespace rosefusion {

/// A rigid transform as a 4 x 4 matrix, column by column as in GLSL: element (row, column) at
/// 4 * column + row. Translations in metres; cameras look along z, x right, y down.
using Matrix = std::array<double, 16>;
inline constexpr Matrix kIdentity = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};

/// A pinhole camera. Pixels; pixel centres have integer coordinates.
struct Camera {
  int width = 0;
  int height = 0;
  double fx = 0;
  double fy = 0;
  double cx = 0;
  double cy = 0;
  double depth_units_per_metre = 1000;  ///< a depth value over this is metres along the optical axis
};

/// How the camera moved, as another sensor than its own depth says: a gyroscope, wheels, a robot's arm.
struct MotionPrior {
  Matrix last_camera_from_camera = kIdentity;  ///< the camera now, in the frame of the camera before
  bool has_translation = false;                ///< false: only the rotation is known, and read
};

/// One image of the sensor. The spans are the caller's and are read before the call that takes them returns.
struct DepthFrame {
  std::span<const std::uint16_t> depth;  ///< width x height, row by row; 0 and 65535 are invalid
  double timestamp = 0;                  ///< seconds, growing
  std::span<const std::uint8_t> rgb;     ///< 3 bytes per pixel, registered to the depth; empty: none
  /// Since the frame handed over before this one, whatever became of that. One more start of the search,
  /// which a better one may beat; it holds what the depth leaves open. Not read with a tracking.method of the
  /// paper's, nor where the pose is known.
  std::optional<MotionPrior> motion;
};

/// Relocalised: found in the model after a loss, where two frames agree, or after a sudden change; not fused
/// until the next frames agree.
enum class Status { Tracked, Uncertain, Relocalised, Lost };

/// What became of one frame.
struct Result {
  double timestamp = 0;
  /// World: the camera of the first frame, or that of the first known pose. When lost: the last pose that was
  /// not.
  Matrix world_from_camera = kIdentity;
  Status status = Status::Lost;
  std::string reason;   ///< plain words; empty when tracked
  double residual = 0;  ///< mean distance of depth and model, 0 to 1 (the truncation)
  double overlap = 0;   ///< share of the pixels that the last frame saw, 0 to 1
  /// Of the pose, row by row, 6 x 6: a shift in the world, metres, then a turn about the camera by its
  /// rotation vector in the world, radians. What the depth's noise leaves open; zero where lost and at the
  /// first frame.
  std::array<double, 36> covariance{};
  double milliseconds = 0;  ///< from depth image to fused volume, waiting in the queue left out
  /// The model was begun anew with the frame before this one, whose camera is now the world: what it had
  /// begun with fits neither, such as an incomplete first image. All poses told before are void.
  bool began_anew = false;
};

struct TimedPose {
  double timestamp = 0;
  Matrix world_from_camera = kIdentity;
};

/// World frame, metres. normals and colours (red, green, blue) are as long as vertices, or empty.
struct Mesh {
  std::vector<std::array<float, 3>> vertices;
  std::vector<std::array<float, 3>> normals;  ///< unit length, towards free space
  std::vector<std::array<std::uint8_t, 3>> colours;
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< counter-clockwise seen from free space
};

/// A setting of the README's table, such as {"volume.voxel_size", "0.01"}.
struct Setting {
  std::string key;
  std::string value;
};

enum class LogLevel { Info, Warning };

struct Options {
  std::string preset = "default";  ///< "default", "paper", or the path of a YAML file
  std::vector<Setting> settings;   ///< over the preset, in this order
  std::string device;            ///< index, part of a name or type; empty: $ROSEFUSION_DEVICE, else the best
  std::size_t queue_length = 4;  ///< frames that Reconstructor::push keeps waiting
  /// Hears one sentence at a time of what is worth knowing beside results and errors, on the constructor's
  /// thread and before it returns; what it throws comes out of the constructor. Empty: silence; the library
  /// never writes to standard output or error.
  std::function<void(LogLevel, const std::string& sentence)> log;
};

/// The one exception of the library. what() is one sentence that names the cause and the remedy.
class ROSEFUSION_API Error : public std::runtime_error {
 public:
  enum class Kind {
    BadInput,      ///< a setting, a camera, the size of an image
    NoDevice,      ///< no Vulkan driver, or no device that fits
    MissingLimit,  ///< the device lacks something; the sentence names all of it
    OutOfMemory,   ///< of the device, or volume.memory_limit_mb; what was fused before stays whole
    DeviceLost,    ///< by the driver; nothing can be done but to make a new Reconstructor
    Misuse,        ///< the caller broke a rule of these headers
  };
  Error(Kind kind, const std::string& sentence);
  ~Error() override;
  Kind kind() const { return kind_; }

 private:
  Kind kind_;
};

}  // namespace rosefusion
