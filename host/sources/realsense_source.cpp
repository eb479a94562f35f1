// Intel RealSense cameras through librealsense2: depth alone. Compiled where CMake finds the library; neither
// compiled nor tried by the author, who had neither library nor camera: `tried` in camera.cpp says so to
// users.
#include <librealsense2/rs.hpp>

#include "host/core/error.h"
#include "host/sources/camera.h"

namespace rosefusion {
namespace {

class RealSenseSource : public FrameSource {
 public:
  explicit RealSenseSource(const CameraOptions& options) {
    rs2::config config;
    if (!options.device.empty()) config.enable_device(options.device);
    config.enable_stream(RS2_STREAM_DEPTH, RS2_FORMAT_Z16);
    const rs2::pipeline_profile profile = pipeline_.start(config);
    const rs2_intrinsics k =
        profile.get_stream(RS2_STREAM_DEPTH).as<rs2::video_stream_profile>().get_intrinsics();
    info_.intrinsics = {k.width, k.height, k.fx, k.fy, k.ppx, k.ppy};
    if (options.intrinsics) {
      info_.intrinsics = *options.intrinsics;
      info_.intrinsics.width = k.width;
      info_.intrinsics.height = k.height;
    }
    requirePlausible(info_.intrinsics, "realsense: the camera");
    info_.format = "RealSense camera";
    info_.path = std::string("realsense:") + profile.get_device().get_info(RS2_CAMERA_INFO_NAME);
    info_.intrinsics_source = options.intrinsics ? "the given intrinsics" : "the camera";
    info_.depth_units_per_metre = 1 / profile.get_device().first<rs2::depth_sensor>().get_depth_scale();
  }

  const SequenceInfo& info() const override { return info_; }

  SourceState next(SourceFrame& out, const StopQuestion& stop) override {
    rs2::frameset frames;
    for (std::chrono::milliseconds waited{0};
         !pipeline_.try_wait_for_frames(&frames, static_cast<unsigned>(kCameraWait.count()));) {
      if (stop && stop()) return SourceState::Stopped;
      if ((waited += kCameraWait) > kCameraGone)
        throw InputError("realsense: no frame came for 10 s; check that the camera is still plugged in.");
    }
    const rs2::depth_frame depth = frames.get_depth_frame();
    const unsigned long long number = depth.get_frame_number();
    out = {};
    out.index = static_cast<std::size_t>(number);
    if (last_number_ > 0 && number > last_number_ + 1) out.dropped = number - last_number_ - 1;
    last_number_ = number;
    out.frame.timestamp = depth.get_timestamp() * 1e-3;
    cv::Mat(depth.get_height(), depth.get_width(), CV_16UC1, const_cast<void*>(depth.get_data()),
            static_cast<std::size_t>(depth.get_stride_in_bytes()))
        .copyTo(out.frame.depth);
    out.usable = true;
    return SourceState::Frame;
  }

 private:
  rs2::pipeline pipeline_;
  SequenceInfo info_;
  unsigned long long last_number_ = 0;
};

}  // namespace

std::unique_ptr<FrameSource> openRealSense(const CameraOptions& options) {
  try {
    return std::make_unique<RealSenseSource>(options);
  } catch (const rs2::error& error) {
    throw InputError(std::string("realsense: the camera cannot be opened (") + error.what() +
                     "); check that it is plugged in and that no other program uses it.");
  }
}

}  // namespace rosefusion
