#include "host/datasets/azure/azure_calibration.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "host/core/error.h"

namespace rosefusion::datasets {
namespace {

/// Of the sensor that an image shows, in shares of its width and height.
struct Part {
  double left, top, width, height;
};

std::optional<Part> depthPart(const cv::Size& size) {
  if (size.width == size.height) return Part{0, 0, 1, 1};
  // 640 x 576 of 1024 x 1024 from (192, 180) on, or half of each.
  if (9 * size.width == 10 * size.height) return Part{0.1875, 0.17578125, 0.625, 0.5625};
  return {};
}

/// The sensor's middle rows; it is 4:3.
std::optional<Part> colourPart(const cv::Size& size) {
  const double height = 4.0 * size.height / (3.0 * size.width);
  if (height > 1) return {};
  return Part{0, (1 - height) / 2, 1, height};
}

std::array<double, 14> parametersOf(const nlohmann::json& camera) {
  const auto all = camera.at("Intrinsics").at("ModelParameters").get<std::vector<double>>();
  std::array<double, 14> p;
  if (all.size() < p.size() ||
      !std::all_of(all.begin(), all.end(), [](double v) { return std::isfinite(v) && std::abs(v) < 1e6; }))
    throw std::runtime_error("ModelParameters are not 14 numbers");
  std::copy_n(all.begin(), p.size(), p.begin());
  return p;
}

/// Its coordinates are shares of the sensor's, and a pixel's centre lies half a pixel from its corner there.
LensCamera cameraOf(const nlohmann::json& camera, const cv::Size& size, const Part& part) {
  const std::array<double, 14> p = parametersOf(camera);
  const double width = size.width / part.width,
               height = size.height / part.height;  // of the sensor, in pixels
  LensCamera out;
  out.values = {size.width,
                size.height,
                p[2] * width,
                p[3] * height,
                (p[0] - part.left) * width - 0.5,
                (p[1] - part.top) * height - 0.5};
  Distortion& lens = out.lens;
  lens.k1 = p[4], lens.k2 = p[5], lens.k3 = p[6], lens.k4 = p[7], lens.k5 = p[8], lens.k6 = p[9];
  lens.centre_x = p[10], lens.centre_y = p[11], lens.p2 = p[12], lens.p1 = p[13];
  const std::string model = camera.at("Intrinsics").at("ModelType");
  if (model.ends_with("Rational6KT"))
    lens.xy_factor = 1;
  else if (!model.ends_with("BrownConrady"))
    throw std::runtime_error("its lens' model, " + model + ", is not known");
  constexpr double kRadius = 1.7;  // where none is given; tan 60 degrees is 1.73
  const double radius = camera.value("MetricRadius", 0.0);
  lens.radius = radius > 0 ? radius : kRadius;
  const auto turn = camera.at("Rt").at("Rotation").get<std::vector<double>>();
  const auto shift = camera.at("Rt").at("Translation").get<std::vector<double>>();
  if (turn.size() != 9 || shift.size() != 3) throw std::runtime_error("Rt is not 9 and 3 numbers");
  out.camera_from_depth.linear() = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>(turn.data());
  out.camera_from_depth.translation() = Eigen::Vector3d(shift.data());
  const Eigen::Matrix3d off = out.camera_from_depth.linear() * out.camera_from_depth.linear().transpose() -
                              Eigen::Matrix3d::Identity();
  if (!(off.norm() < 1e-3 && out.camera_from_depth.translation().norm() < 1))
    throw std::runtime_error("Rt is no rotation and translation");
  return out;
}

LensCamera readCamera(std::span<const std::byte> calibration, const char* purpose, const cv::Size& size,
                      const std::optional<Part>& part, const std::string& name) {
  if (!part)
    throw InputError(name + ": images of " + std::to_string(size.width) + "x" + std::to_string(size.height) +
                     " are of none of the Azure Kinect's modes; give --intrinsics FX,FY,CX,CY.");
  try {
    const auto* text = reinterpret_cast<const char*>(calibration.data());
    std::size_t length = calibration.size();
    while (length > 0 && text[length - 1] == '\0') --length;
    const auto all = nlohmann::json::parse(text, text + length);
    for (const auto& camera : all.at("CalibrationInformation").at("Cameras"))
      if (camera.at("Purpose").get<std::string>().ends_with(purpose)) return cameraOf(camera, size, *part);
    throw std::runtime_error("it has no such camera");
  } catch (const std::exception& error) {
    throw InputError(name + ": its calibration cannot be read (" + error.what() +
                     "); give --intrinsics FX,FY,CX,CY.");
  }
}

}  // namespace

LensCamera azureDepthCamera(std::span<const std::byte> calibration, cv::Size size, const std::string& name) {
  return readCamera(calibration, "CameraPurposeDepth", size, depthPart(size), name);
}

LensCamera azureColourCamera(std::span<const std::byte> calibration, cv::Size size, const std::string& name) {
  return readCamera(calibration, "CameraPurposePhotoVideo", size, colourPart(size), name);
}

}  // namespace rosefusion::datasets
