// Reads numbers and texts out of bytes that a file gave, which may lie about their sizes.
#pragma once
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <stdexcept>
#include <string>

namespace rosefusion::datasets {

/// Of a record or message: a file that says more is damaged.
inline constexpr std::uint64_t kMostRecordBytes = 1u << 30;

/// Thrown by ByteReader where the bytes end too early; whoever knows the file's name turns it into a
/// sentence.
struct EndOfBytes : std::runtime_error {
  EndOfBytes() : std::runtime_error("it ends too early") {}
};

/// Little endian. With `aligned`, numbers lie at multiples of their size and texts end with a zero, as in
/// CDR.
class ByteReader {
 public:
  explicit ByteReader(std::span<const std::byte> bytes, bool aligned = false)
      : bytes_(bytes), aligned_(aligned) {}

  template <typename T>
  T number() {
    if (aligned_) take((sizeof(T) - at_ % sizeof(T)) % sizeof(T));
    T value;
    std::memcpy(&value, take(sizeof(T)).data(), sizeof(T));
    return value;
  }
  std::span<const std::byte> take(std::size_t count) {
    if (count > bytes_.size() - at_) throw EndOfBytes();
    at_ += count;
    return bytes_.subspan(at_ - count, count);
  }
  /// A number of bytes (32 bits), then the bytes.
  std::span<const std::byte> block() { return take(number<std::uint32_t>()); }
  std::string text() {
    const auto bytes = block();
    std::string out(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    if (aligned_ && !out.empty() && out.back() == '\0') out.pop_back();
    return out;
  }
  std::size_t left() const { return bytes_.size() - at_; }

 private:
  std::span<const std::byte> bytes_;
  bool aligned_;
  std::size_t at_ = 0;
};

}  // namespace rosefusion::datasets
