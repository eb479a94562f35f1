// Cameras of OpenNI2 (Kinect-like ones of PrimeSense, Asus, Orbbec) and its .oni recordings: depth alone.
#include <OpenNI.h>
#include <spdlog/spdlog.h>

#include <cmath>

#include "host/core/error.h"
#include "host/sources/camera.h"

namespace rosefusion {
namespace {

using openni::OpenNI;
using openni::Status;

constexpr double kOpenNi2UnitsPerMetre = 1000;

std::string reason() {
  std::string text = OpenNI::getExtendedError();
  while (!text.empty() && std::isspace(static_cast<unsigned char>(text.back()))) text.pop_back();
  return text.empty() ? "OpenNI2 gives no reason" : text;
}

void require(Status status, const std::string& what) {
  if (status != openni::STATUS_OK) throw InputError("openni2: " + what + " (" + reason() + ").");
}

/// OpenNI2 itself, while there is a camera.
struct Library {
  Library() { require(OpenNI::initialize(), "the library does not start; install libopenni2-0"); }
  ~Library() { OpenNI::shutdown(); }
};

class OpenNi2Source : public FrameSource {
 public:
  explicit OpenNi2Source(const CameraOptions& options) {
    if (options.device.empty()) requireAnyCamera();
    require(device_.open(options.device.empty() ? openni::ANY_DEVICE : options.device.c_str()),
            "the camera cannot be opened; is another program using it, or may you not use the USB device");
    require(depth_.create(device_, openni::SENSOR_DEPTH), "the camera has no depth");
    chooseMode();
    depth_.setMirroringEnabled(false);
    require(depth_.start(), "the camera does not start");
    describe(options);
  }
  ~OpenNi2Source() override {
    depth_.stop();
    depth_.destroy();
    device_.close();
  }

  const SequenceInfo& info() const override { return info_; }

  SourceState next(SourceFrame& out, const StopQuestion& stop) override {
    openni::VideoStream* streams[] = {&depth_};
    int ready = 0;
    for (std::chrono::milliseconds waited{0};; waited += kCameraWait) {
      if (stop && stop()) return SourceState::Stopped;
      if (OpenNI::waitForAnyStream(streams, 1, &ready, static_cast<int>(kCameraWait.count())) ==
          openni::STATUS_OK)
        break;
      if (waited >= kCameraGone)
        throw InputError("openni2: no frame came for 10 s; check that the camera is still plugged in.");
    }
    openni::VideoFrameRef frame;
    require(depth_.readFrame(&frame), "a frame cannot be read");
    out = {};
    const int number = frame.getFrameIndex();
    if (last_number_ > 0 && number > last_number_ + 1)
      out.dropped = static_cast<std::size_t>(number - last_number_ - 1);
    last_number_ = number;
    out.index = static_cast<std::size_t>(std::max(number, 0));
    out.frame.timestamp = static_cast<double>(frame.getTimestamp()) * 1e-6;
    out.usable = frame.getWidth() == info_.intrinsics.width && frame.getHeight() == info_.intrinsics.height;
    if (out.usable)
      cv::Mat(frame.getHeight(), frame.getWidth(), CV_16UC1, const_cast<void*>(frame.getData()),
              static_cast<std::size_t>(frame.getStrideInBytes()))
          .copyTo(out.frame.depth);
    else
      out.problem = "openni2: a frame has another size than the camera promised.";
    return SourceState::Frame;
  }

 private:
  static void requireAnyCamera() {
    openni::Array<openni::DeviceInfo> found;
    OpenNI::enumerateDevices(&found);
    if (found.getSize() == 0)
      throw InputError(
          "openni2: no camera is there; plug one in, or name an .oni recording, as in openni2:file.oni.");
  }

  /// The largest picture in millimetres at 30 Hz or more; the fastest of those.
  void chooseMode() {
    const openni::SensorInfo* sensor = device_.getSensorInfo(openni::SENSOR_DEPTH);
    if (!sensor) return;
    const auto& modes = sensor->getSupportedVideoModes();
    const auto rank = [](const openni::VideoMode& m) {
      const bool usable = m.getPixelFormat() == openni::PIXEL_FORMAT_DEPTH_1_MM;
      return usable ? std::pair{m.getFps() >= 30 ? m.getResolutionX() : 0, m.getFps()} : std::pair{-1, 0};
    };
    int best = -1;
    for (int i = 0; i < modes.getSize(); ++i)
      if (rank(modes[i]).first >= 0 && (best < 0 || rank(modes[i]) > rank(modes[best]))) best = i;
    if (best < 0) throw InputError("openni2: the camera gives no depth in millimetres.");
    depth_.setVideoMode(modes[best]);
  }

  void describe(const CameraOptions& options) {
    const openni::VideoMode mode = depth_.getVideoMode();
    Intrinsics k;
    k.width = mode.getResolutionX();
    k.height = mode.getResolutionY();
    k.fx = k.width / 2.0 / std::tan(depth_.getHorizontalFieldOfView() / 2);
    k.fy = k.height / 2.0 / std::tan(depth_.getVerticalFieldOfView() / 2);
    k.cx = (k.width - 1) / 2.0;
    k.cy = (k.height - 1) / 2.0;
    if (options.intrinsics) {
      const int width = k.width, height = k.height;
      k = *options.intrinsics;
      k.width = width;
      k.height = height;
    }
    requirePlausible(k, options.intrinsics ? "the given intrinsics" : "openni2: the camera");
    const openni::DeviceInfo& device = device_.getDeviceInfo();
    info_.format = "OpenNI2 camera";
    info_.path = std::string("openni2:") + device.getVendor() + " " + device.getName();
    info_.intrinsics = k;
    info_.intrinsics_source = "the camera's field of view";
    info_.intrinsics_assumed = !options.intrinsics;
    info_.depth_units_per_metre = kOpenNi2UnitsPerMetre;
    spdlog::info("openni2: {}x{} at {} Hz", k.width, k.height, mode.getFps());
  }

  Library library_;
  openni::Device device_;
  openni::VideoStream depth_;
  SequenceInfo info_;
  int last_number_ = 0;
};

}  // namespace

std::unique_ptr<FrameSource> openOpenNi2(const CameraOptions& options) {
  return std::make_unique<OpenNi2Source>(options);
}

}  // namespace rosefusion
