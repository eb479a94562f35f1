// The messages of ROS that hold images, of ROS 1 and ROS 2 (CDR).
#pragma once
#include <array>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "host/datasets/byte_reader.h"
#include "host/datasets/float_depth.h"
#include "host/datasets/undistortion.h"

namespace rosefusion::datasets {

struct CameraInfoMessage {
  std::uint32_t width = 0, height = 0;
  std::string distortion_model;
  std::vector<double> distortion;
  std::array<double, 9> k{};  ///< row by row

  /// All zeros where the lens does not distort; none where its model is not known.
  std::optional<Distortion> lens() const;
};

/// sensor_msgs/CameraInfo. Throws EndOfBytes; so do the others.
CameraInfoMessage cameraInfoOf(std::span<const std::byte> message, bool cdr);

/// The RealSense SDK's own: 'width=..;height=..;fx=..;ppx=..;fy=..;ppy=..;model=..;coeffs=a,b,c,d,e'. Throws
/// EndOfBytes where a number is missing.
CameraInfoMessage cameraInfoOfText(const std::string& text);

/// std_msgs/String.
std::string textOf(std::span<const std::byte> message, bool cdr);

/// std_msgs/Float32.
float floatOf(std::span<const std::byte> message, bool cdr);

/// Of sensor_msgs/Image (16UC1, mono16, 32FC1) or sensor_msgs/CompressedImage (compressedDepth).
struct DepthMessage {
  cv::Mat depth;        ///< CV_16UC1
  bool metres = false;  ///< it was of floating metres: kUnitsOfMetres a metre
};

/// None where it is no depth image. `type`: the topic's.
std::optional<DepthMessage> depthOf(std::span<const std::byte> message, bool cdr, const std::string& type);

/// BGR (CV_8UC3); empty where it is no colour image of 8 bits.
cv::Mat colourOf(std::span<const std::byte> message, bool cdr, const std::string& type);

}  // namespace rosefusion::datasets
