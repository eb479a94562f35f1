// MCAP recordings (ROS 2): records of an opcode, a length and content; messages alone or in compressed
// chunks.
#include <algorithm>
#include <map>

#include "host/core/error.h"
#include "host/datasets/byte_reader.h"
#include "host/datasets/compression.h"
#include "host/datasets/file_bytes.h"
#include "host/datasets/ros/message_file.h"

namespace rosefusion::datasets {
namespace {

namespace fs = std::filesystem;

constexpr unsigned char kMcapMagic[] = {0x89, 'M', 'C', 'A', 'P', '0', '\r', '\n'};
constexpr std::uint64_t kHeadBytes = 9;  // opcode and length

class Mcap : public MessageFile {
  enum Op : std::uint8_t { kSchema = 3, kChannel = 4, kMessage = 5, kChunk = 6, kDataEnd = 15 };

 public:
  explicit Mcap(const fs::path& file) : file_(file), bytes_(file) {
    if (!bytes_.beginsWith(std::as_bytes(std::span(kMcapMagic))))
      throw InputError(file.string() + ": cannot be read, or is no MCAP file; copy it again.");
    std::uint64_t at = sizeof kMcapMagic;
    try {
      while (at < bytes_.size()) {
        const auto [op, begin, bytes] = headAt(at);
        if (op == kDataEnd) break;
        if (op == kChunk) {
          const std::vector<std::byte> chunk = chunkAt(begin, bytes);
          walk(chunk, at);
        } else if (op == kSchema || op == kChannel) {
          add(op, bytes_.at(begin, bytes), kNoChunk, at);
        } else if (op == kMessage) {
          add(op, bytes_.at(begin, std::min<std::uint64_t>(bytes, 22)), kNoChunk, at);
        }
        at = begin + bytes;
      }
    } catch (const EndOfBytes&) {
      warnings_.push_back(file.string() + ": is cut or damaged behind its first " + std::to_string(at >> 20) +
                          " MiB; it is read up to there.");
    }
    std::stable_sort(messages_.begin(), messages_.end(),
                     [](const MessageRef& a, const MessageRef& b) { return a.timestamp < b.timestamp; });
  }

  bool isCdr() const override { return true; }

  std::span<const std::byte> read(const MessageRef& message) override {
    if (message.place == kNoChunk) {
      const auto [op, begin, bytes] = headAt(message.offset);
      chunk_ = bytes_.at(begin, bytes);
      loaded_ = kNoChunk;
      ByteReader reader(chunk_);
      reader.take(22);
      return reader.take(reader.left());
    }
    if (message.place != loaded_) {
      loaded_ = kNoChunk;
      const auto [op, begin, bytes] = headAt(message.place);
      chunk_ = chunkAt(begin, bytes);
      loaded_ = message.place;
    }
    if (message.offset > chunk_.size()) throw EndOfBytes();
    ByteReader reader(std::span<const std::byte>(chunk_).subspan(message.offset));
    reader.take(1);
    const auto length = reader.number<std::uint64_t>();
    if (length < 22) throw EndOfBytes();
    return reader.take(length).subspan(22);  // after channel, sequence and two times
  }

 private:
  struct Head {
    std::uint8_t op;
    std::uint64_t begin, bytes;
  };
  Head headAt(std::uint64_t at) {
    const std::vector<std::byte> bytes = bytes_.at(at, kHeadBytes);
    ByteReader reader(bytes);
    const auto op = reader.number<std::uint8_t>();
    const auto length = reader.number<std::uint64_t>();
    if (length > bytes_.size() - at - kHeadBytes) throw EndOfBytes();
    return {op, at + kHeadBytes, length};
  }

  std::vector<std::byte> chunkAt(std::uint64_t begin, std::uint64_t bytes) {
    const std::vector<std::byte> record = bytes_.at(begin, bytes);
    ByteReader reader(record);
    reader.take(16);  // first and last time
    const auto size = reader.number<std::uint64_t>();
    reader.take(4);  // checksum
    const std::string compression = reader.text();
    const auto packed_bytes = reader.number<std::uint64_t>();
    const auto packed = reader.take(packed_bytes);
    if (size > kMostRecordBytes) throw EndOfBytes();
    if (compression.empty()) return {packed.begin(), packed.end()};
    if (compression == "lz4") return unpackedLz4(packed, size);
    if (compression == "zstd") return unpackedZstd(packed, size);
    throw InputError(file_.string() + ": its chunks are compressed with " + compression +
                     "; write it anew with 'mcap compress --compression zstd'.");
  }

  void walk(const std::vector<std::byte>& chunk, std::uint64_t place) {
    ByteReader reader(chunk);
    while (reader.left() >= kHeadBytes) {
      const std::uint64_t offset = chunk.size() - reader.left();
      const auto op = reader.number<std::uint8_t>();
      const auto length = reader.number<std::uint64_t>();
      add(op, reader.take(length), place, offset);
    }
  }

  void add(std::uint8_t op, std::span<const std::byte> content, std::uint64_t place, std::uint64_t offset) {
    ByteReader reader(content);
    if (op == kSchema) {
      const auto id = reader.number<std::uint16_t>();
      std::string name = reader.text();
      if (const auto at = name.find("/msg/"); at != std::string::npos) name.erase(at, 4);
      schemas_[id] = name;
    } else if (op == kChannel) {
      const auto id = reader.number<std::uint16_t>();
      const auto schema = schemas_.find(reader.number<std::uint16_t>());
      const std::string name = reader.text();
      if (reader.text() != "cdr" || channels_.count(id)) return;
      channels_[id] = topics_.size();
      topics_.push_back({name, schema == schemas_.end() ? "" : schema->second});
    } else if (op == kMessage) {
      const auto channel = channels_.find(reader.number<std::uint16_t>());
      reader.take(4);  // sequence
      const auto time = reader.number<std::uint64_t>();
      if (channel != channels_.end())
        messages_.push_back({channel->second, 1e-9 * static_cast<double>(time), place, offset});
    }
  }

  fs::path file_;
  FileBytes bytes_;
  std::map<std::uint16_t, std::string> schemas_;
  std::map<std::uint16_t, std::size_t> channels_;  // to topics_
  std::vector<std::byte> chunk_;
  std::uint64_t loaded_ = kNoChunk;  // the chunk in chunk_
};

}  // namespace

std::unique_ptr<MessageFile> openMcap(const fs::path& file) {
  return std::make_unique<Mcap>(file);
}

}  // namespace rosefusion::datasets
