#include "host/datasets/ros/ros_messages.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <sstream>

#include "host/datasets/text_table.h"

namespace rosefusion::datasets {
namespace {

constexpr std::uint32_t kMostMessageSide = 16384;  // pixels

/// After CDR's four bytes, which say little endian and no more, as every machine this runs on.
ByteReader begin(std::span<const std::byte> message, bool cdr) {
  if (!cdr) return ByteReader(message);
  if (message.size() < 4) throw EndOfBytes();
  return ByteReader(message.subspan(4), true);
}

void skipHeader(ByteReader& reader, bool cdr) {
  if (!cdr) reader.number<std::uint32_t>();  // seq
  reader.number<std::uint32_t>();            // seconds
  reader.number<std::uint32_t>();            // nanoseconds
  reader.text();                             // frame_id
}

struct Image {
  std::uint32_t width = 0, height = 0, step = 0;
  std::string encoding;
  bool big_endian = false;
  std::span<const std::byte> data;
};

/// Throws EndOfBytes where rows of `pixel_bytes` a pixel do not fit.
Image imageOf(ByteReader& reader, bool cdr) {
  skipHeader(reader, cdr);
  Image out;
  out.height = reader.number<std::uint32_t>();
  out.width = reader.number<std::uint32_t>();
  out.encoding = reader.text();
  out.big_endian = reader.number<std::uint8_t>() != 0;
  out.step = reader.number<std::uint32_t>();
  out.data = reader.block();
  if (out.width == 0 || out.height == 0 || out.width > kMostMessageSide || out.height > kMostMessageSide)
    throw EndOfBytes();
  return out;
}

const std::byte* rowOf(const Image& image, std::uint32_t row, std::size_t pixel_bytes) {
  const std::size_t begin = std::size_t(row) * image.step, bytes = image.width * pixel_bytes;
  if (image.step < bytes || begin + bytes > image.data.size()) throw EndOfBytes();
  return image.data.data() + begin;
}

template <typename T>
T swapped(T value) {
  auto* bytes = reinterpret_cast<unsigned char*>(&value);
  std::reverse(bytes, bytes + sizeof(T));
  return value;
}

template <typename T, typename Convert>
cv::Mat depthFrom(const Image& image, const Convert& convert) {
  cv::Mat out(static_cast<int>(image.height), static_cast<int>(image.width), CV_16UC1);
  std::vector<T> row(image.width);
  for (std::uint32_t v = 0; v < image.height; ++v) {
    std::memcpy(row.data(), rowOf(image, v, sizeof(T)), sizeof(T) * row.size());
    auto* to = out.ptr<std::uint16_t>(static_cast<int>(v));
    for (std::uint32_t u = 0; u < image.width; ++u)
      to[u] = convert(image.big_endian ? swapped(row[u]) : row[u]);
  }
  return out;
}

struct Compressed {
  std::string format;
  std::span<const std::byte> data;
};

Compressed compressedOf(ByteReader& reader, bool cdr) {
  skipHeader(reader, cdr);
  Compressed out;
  out.format = reader.text();
  out.data = reader.block();
  return out;
}

cv::Mat decoded(std::span<const std::byte> bytes, int flags) {
  if (bytes.empty()) return {};
  const cv::Mat wrapped(1, static_cast<int>(bytes.size()), CV_8U, const_cast<std::byte*>(bytes.data()));
  try {
    return cv::imdecode(wrapped, flags);
  } catch (const cv::Exception&) {
    return {};
  }
}

/// The plugin compressed_depth_image_transport: 12 bytes (kind, and how inverse depths were rounded), then a
/// PNG.
std::optional<DepthMessage> compressedDepthOf(const Compressed& image) {
  if (image.format.find("compressedDepth") == std::string::npos) return {};
  ByteReader reader(image.data);
  reader.number<std::uint32_t>();
  const auto a = reader.number<float>(), b = reader.number<float>();
  const cv::Mat png = decoded(reader.take(reader.left()), cv::IMREAD_UNCHANGED);
  if (png.type() != CV_16UC1) throw EndOfBytes();
  if (image.format.find("32FC1") == std::string::npos) return DepthMessage{png, false};
  cv::Mat depth(png.size(), CV_16UC1);
  for (int v = 0; v < png.rows; ++v)
    for (int u = 0; u < png.cols; ++u) {
      const float inverse = png.at<std::uint16_t>(v, u);
      depth.at<std::uint16_t>(v, u) =
          inverse > 0 ? unitsOf(static_cast<double>(a / (inverse - b))) : std::uint16_t(0);
    }
  return DepthMessage{depth, true};
}

}  // namespace

std::optional<Distortion> CameraInfoMessage::lens() const {
  auto d = distortion;
  while (!d.empty() && d.back() == 0) d.pop_back();
  if (d.empty()) return Distortion{};
  // ROS has taken models, their names and the order of coefficients from OpenCV; beyond eight come thin
  // prisms.
  const std::size_t most = distortion_model == "plumb_bob"             ? 5
                           : distortion_model == "rational_polynomial" ? 8
                                                                       : 0;
  if (d.size() > most || !std::ranges::all_of(d, [](double v) { return std::isfinite(v); })) return {};
  d.resize(8);
  return Distortion{d[0], d[1], d[2], d[3], d[4], d[5], d[6], d[7]};
}

CameraInfoMessage cameraInfoOf(std::span<const std::byte> message, bool cdr) {
  ByteReader reader = begin(message, cdr);
  skipHeader(reader, cdr);
  CameraInfoMessage out;
  out.height = reader.number<std::uint32_t>();
  out.width = reader.number<std::uint32_t>();
  out.distortion_model = reader.text();
  const auto count = reader.number<std::uint32_t>();
  if (count > 64) throw EndOfBytes();
  for (std::uint32_t i = 0; i < count; ++i) out.distortion.push_back(reader.number<double>());
  for (double& value : out.k) value = reader.number<double>();
  if (out.width > kMostMessageSide || out.height > kMostMessageSide) throw EndOfBytes();
  return out;
}

CameraInfoMessage cameraInfoOfText(const std::string& text) {
  std::map<std::string, std::string> fields;
  std::istringstream in(text);
  for (std::string field; std::getline(in, field, ';');)
    if (const auto equals = field.find('='); equals != std::string::npos)
      fields[field.substr(0, equals)] = field.substr(equals + 1);
  const auto number = [&](const char* name) {
    double value = 0;
    if (!parseNumber(fields[name], value)) throw EndOfBytes();
    return value;
  };
  const auto side = [&](const char* name) {
    const double value = number(name);
    if (!(value >= 1 && value <= kMostMessageSide)) throw EndOfBytes();
    return static_cast<std::uint32_t>(value);
  };
  CameraInfoMessage out;
  out.width = side("width");
  out.height = side("height");
  out.k = {number("fx"), 0, number("ppx"), 0, number("fy"), number("ppy"), 0, 0, 1};
  return out;
}

std::string textOf(std::span<const std::byte> message, bool cdr) {
  return begin(message, cdr).text();
}

float floatOf(std::span<const std::byte> message, bool cdr) {
  return begin(message, cdr).number<float>();
}

std::optional<DepthMessage> depthOf(std::span<const std::byte> message, bool cdr, const std::string& type) {
  ByteReader reader = begin(message, cdr);
  if (type == "sensor_msgs/CompressedImage") return compressedDepthOf(compressedOf(reader, cdr));
  if (type != "sensor_msgs/Image") return {};
  const Image image = imageOf(reader, cdr);
  if (image.encoding == "16UC1" || image.encoding == "mono16" || image.encoding == "Z16")
    return DepthMessage{depthFrom<std::uint16_t>(image, [](std::uint16_t value) { return value; }), false};
  if (image.encoding == "32FC1")
    return DepthMessage{depthFrom<float>(image, [](float metres) { return unitsOf(metres); }), true};
  return {};
}

cv::Mat colourOf(std::span<const std::byte> message, bool cdr, const std::string& type) {
  ByteReader reader = begin(message, cdr);
  if (type == "sensor_msgs/CompressedImage") {
    const Compressed image = compressedOf(reader, cdr);
    return image.format.find("compressedDepth") == std::string::npos ? decoded(image.data, cv::IMREAD_COLOR)
                                                                     : cv::Mat();
  }
  if (type != "sensor_msgs/Image") return {};
  const Image image = imageOf(reader, cdr);
  const bool rgb = image.encoding == "rgb8";
  if (!rgb && image.encoding != "bgr8") return {};
  cv::Mat out(static_cast<int>(image.height), static_cast<int>(image.width), CV_8UC3);
  for (std::uint32_t v = 0; v < image.height; ++v)
    std::memcpy(out.ptr(static_cast<int>(v)), rowOf(image, v, 3), std::size_t(image.width) * 3);
  if (rgb) cv::cvtColor(out, out, cv::COLOR_RGB2BGR);
  return out;
}

}  // namespace rosefusion::datasets
