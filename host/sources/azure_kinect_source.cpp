// Azure Kinect cameras through k4a: depth alone, narrow field of view. Compiled where CMake finds the
// library; neither compiled nor tried by the author, who had neither library nor camera: `tried` in
// camera.cpp says so to users.
#include <k4a/k4a.hpp>

#include <chrono>
#include <cmath>

#include "host/core/error.h"
#include "host/sources/camera.h"

namespace rosefusion {
namespace {

constexpr double kAzureUnitsPerMetre = 1000;
constexpr double kAzureFramesPerSecond = 30;

class AzureKinectSource : public FrameSource {
 public:
  explicit AzureKinectSource(const CameraOptions& options)
      : device_(k4a::device::open(options.device.empty()
                                      ? K4A_DEVICE_DEFAULT
                                      : static_cast<std::uint32_t>(std::stoul(options.device)))) {
    k4a_device_configuration_t configuration = K4A_DEVICE_CONFIG_INIT_DISABLE_ALL;
    configuration.depth_mode = K4A_DEPTH_MODE_NFOV_UNBINNED;
    configuration.camera_fps = K4A_FRAMES_PER_SECOND_30;
    device_.start_cameras(&configuration);
    const k4a_calibration_camera_t camera =
        device_.get_calibration(configuration.depth_mode, configuration.color_resolution)
            .depth_camera_calibration;
    const auto& k = camera.intrinsics.parameters.param;
    info_.intrinsics = {camera.resolution_width, camera.resolution_height, k.fx, k.fy, k.cx, k.cy};
    if (options.intrinsics) {
      info_.intrinsics = *options.intrinsics;
      info_.intrinsics.width = camera.resolution_width;
      info_.intrinsics.height = camera.resolution_height;
    }
    requirePlausible(info_.intrinsics, "k4a: the camera");
    info_.format = "Azure Kinect camera";
    info_.path = "k4a:" + device_.get_serialnum();
    info_.intrinsics_source = options.intrinsics ? "the given intrinsics" : "the camera";
    info_.depth_units_per_metre = kAzureUnitsPerMetre;
    info_.warnings.push_back("k4a: the lens's distortion is not corrected; the image's corners may be bent.");
  }

  const SequenceInfo& info() const override { return info_; }

  SourceState next(SourceFrame& out, const StopQuestion& stop) override {
    k4a::capture capture;
    const auto start = std::chrono::steady_clock::now();
    while (!device_.get_capture(&capture, kCameraWait)) {
      if (stop && stop()) return SourceState::Stopped;
      if (std::chrono::steady_clock::now() - start > kCameraGone)
        throw InputError("k4a: no frame came for 10 s; check that the camera is still plugged in.");
    }
    k4a::image depth = capture.get_depth_image();
    out = {};
    out.index = count_++;
    out.usable = static_cast<bool>(depth);
    if (!out.usable) {
      out.problem = "k4a: a capture came without depth.";
      return SourceState::Frame;
    }
    out.frame.timestamp = std::chrono::duration<double>(depth.get_device_timestamp()).count();
    if (last_stamp_ > 0)
      out.dropped = static_cast<std::size_t>(
          std::max(0.0, std::round((out.frame.timestamp - last_stamp_) * kAzureFramesPerSecond) - 1));
    last_stamp_ = out.frame.timestamp;
    cv::Mat(depth.get_height_pixels(), depth.get_width_pixels(), CV_16UC1, depth.get_buffer(),
            static_cast<std::size_t>(depth.get_stride_bytes()))
        .copyTo(out.frame.depth);
    return SourceState::Frame;
  }

 private:
  k4a::device device_;
  SequenceInfo info_;
  std::size_t count_ = 0;
  double last_stamp_ = 0;
};

}  // namespace

std::unique_ptr<FrameSource> openAzureKinect(const CameraOptions& options) {
  try {
    return std::make_unique<AzureKinectSource>(options);
  } catch (const k4a::error& error) {
    throw InputError(std::string("k4a: the camera cannot be opened (") + error.what() +
                     "); check that it is plugged in and that no other program uses it.");
  }
}

}  // namespace rosefusion
