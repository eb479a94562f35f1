// Bytes of a file at any place, never more than it has.
#pragma once
#include <filesystem>
#include <fstream>
#include <vector>

#include "host/datasets/byte_reader.h"

namespace rosefusion::datasets {

/// One reading thread at a time.
class FileBytes {
 public:
  /// A file that cannot be opened has no bytes.
  explicit FileBytes(const std::filesystem::path& file) : in_(file, std::ios::binary) {
    std::error_code unreadable;
    const auto size = std::filesystem::file_size(file, unreadable);
    if (in_ && !unreadable) size_ = size;
  }
  std::uint64_t size() const { return size_; }
  /// Throws EndOfBytes where the file ends before, or the disk does not give them.
  std::vector<std::byte> at(std::uint64_t place, std::uint64_t count) {
    if (count > kMostRecordBytes || place > size_ || count > size_ - place) throw EndOfBytes();
    std::vector<std::byte> out(count);
    in_.clear();
    in_.seekg(static_cast<std::streamoff>(place));
    if (!in_.read(reinterpret_cast<char*>(out.data()), static_cast<std::streamsize>(count)))
      throw EndOfBytes();
    return out;
  }
  bool beginsWith(std::span<const std::byte> magic) {
    if (size_ < magic.size()) return false;
    const std::vector<std::byte> begin = at(0, magic.size());
    return std::memcmp(begin.data(), magic.data(), magic.size()) == 0;
  }

 private:
  std::ifstream in_;
  std::uint64_t size_ = 0;
};

}  // namespace rosefusion::datasets
