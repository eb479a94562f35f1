#include "host/datasets/npy.h"

#include <charconv>
#include <cstdint>
#include <cstring>
#include <vector>

namespace rosefusion::datasets {
namespace {

constexpr std::string_view kMagic = "\x93NUMPY";
constexpr int kMostSide = 16384;  // pixels

/// What stands behind 'key': in the header, which is a Python dictionary as text.
std::string_view valueOf(std::string_view header, std::string_view key) {
  const std::size_t at = header.find(key);
  if (at == header.npos) return {};
  header.remove_prefix(at + key.size());
  const std::size_t begin = header.find_first_not_of("': ");
  return begin == header.npos ? std::string_view{} : header.substr(begin);
}

std::vector<int> shapeOf(std::string_view tuple) {
  std::vector<int> shape;
  tuple = tuple.substr(0, tuple.find(')'));
  while (true) {
    const std::size_t digit = tuple.find_first_of("0123456789");
    if (digit == tuple.npos) return shape;
    int size = 0;
    const auto end = std::from_chars(tuple.data() + digit, tuple.data() + tuple.size(), size);
    if (end.ec != std::errc{}) return {};
    shape.push_back(size);
    tuple.remove_prefix(static_cast<std::size_t>(end.ptr - tuple.data()));
  }
}

}  // namespace

bool isNpy(std::string_view bytes) {
  return bytes.starts_with(kMagic);
}

cv::Mat decodedNpy(std::string_view bytes) {
  // Magic, version (two bytes), the header's length (two bytes in version 1, else four), header, data.
  if (!isNpy(bytes) || bytes.size() < 12) return {};
  const std::size_t length_bytes = bytes[6] == 1 ? 2 : 4;
  std::uint32_t length = 0;
  std::memcpy(&length, bytes.data() + 8, length_bytes);
  const std::size_t begin = 8 + length_bytes;
  if (length > bytes.size() - begin) return {};
  const std::string_view header = bytes.substr(begin, length), data = bytes.substr(begin + length);
  const std::string_view kind = valueOf(header, "'descr'");
  const int type = kind.starts_with("<u2")   ? CV_16UC1
                   : kind.starts_with("<f4") ? CV_32FC1
                   : kind.starts_with("<f8") ? CV_64FC1
                                             : -1;
  std::vector<int> shape = shapeOf(valueOf(header, "'shape'"));
  if (shape.size() == 3 && shape[2] == 1) shape.pop_back();
  if (type < 0 || shape.size() != 2 || shape[0] < 1 || shape[1] < 1 || shape[0] > kMostSide ||
      shape[1] > kMostSide || !valueOf(header, "'fortran_order'").starts_with("False"))
    return {};
  cv::Mat image(shape[0], shape[1], type);
  const std::size_t size = image.total() * image.elemSize();
  if (data.size() < size) return {};
  std::memcpy(image.data, data.data(), size);
  return image;
}

}  // namespace rosefusion::datasets
