// ROS 1 bags: records of a header ('name=value' fields) and data, messages in chunks that may be compressed.
#include <algorithm>
#include <map>
#include <set>

#include "host/core/error.h"
#include "host/datasets/byte_reader.h"
#include "host/datasets/compression.h"
#include "host/datasets/file_bytes.h"
#include "host/datasets/ros/message_file.h"

namespace rosefusion::datasets {
namespace {

namespace fs = std::filesystem;

constexpr const char kBagMagic[] = "#ROSBAG V2.0\n";
constexpr std::uint64_t kBagMagicBytes = sizeof kBagMagic - 1;

using Fields = std::map<std::string, std::string>;

Fields fieldsOf(std::span<const std::byte> bytes) {
  Fields out;
  ByteReader reader(bytes);
  while (reader.left() > 0) {
    const std::string field = reader.text();
    const auto equals = field.find('=');
    if (equals == std::string::npos) throw EndOfBytes();
    out[field.substr(0, equals)] = field.substr(equals + 1);
  }
  return out;
}

template <typename T>
T numberOf(const Fields& fields, const char* name) {
  const auto found = fields.find(name);
  if (found == fields.end() || found->second.size() != sizeof(T)) throw EndOfBytes();
  T value;
  std::memcpy(&value, found->second.data(), sizeof(T));
  return value;
}

double secondsOf(std::uint64_t time) {  // the low half holds the seconds, the high half the nanoseconds
  return static_cast<double>(time & 0xffffffffu) + 1e-9 * static_cast<double>(time >> 32);
}

class RosBag : public MessageFile {
  enum Op : std::uint8_t { kMessage = 2, kIndex = 4, kChunk = 5, kConnection = 7 };

 public:
  explicit RosBag(const fs::path& file) : file_(file), bytes_(file) {
    if (!bytes_.beginsWith(std::as_bytes(std::span(kBagMagic, kBagMagicBytes))))
      throw InputError(file.string() + ": cannot be read, or is no ROS bag of version 2.0; copy it again.");
    readRecords();
    std::stable_sort(messages_.begin(), messages_.end(),
                     [](const MessageRef& a, const MessageRef& b) { return a.timestamp < b.timestamp; });
  }

  bool isCdr() const override { return false; }

  std::span<const std::byte> read(const MessageRef& message) override {
    if (message.place == kNoChunk) {
      data_ = recordAt(message.offset).data;
      return data_;
    }
    if (message.place != loaded_) {
      loaded_ = kNoChunk;
      chunk_ = unpacked(recordAt(message.place));
      loaded_ = message.place;
    }
    if (message.offset > chunk_.size()) throw EndOfBytes();
    ByteReader reader(std::span<const std::byte>(chunk_).subspan(message.offset));
    reader.block();  // the header
    return reader.block();
  }

 private:
  struct Record {
    Fields header;
    std::vector<std::byte> data;
    std::uint64_t end = 0;
  };

  std::uint32_t lengthAt(std::uint64_t at) { return ByteReader(bytes_.at(at, 4)).number<std::uint32_t>(); }

  /// Without its data where `with_data` is not set.
  Record recordAt(std::uint64_t at, bool with_data = true) {
    Record out;
    const std::uint32_t header_bytes = lengthAt(at);
    out.header = fieldsOf(bytes_.at(at + 4, header_bytes));
    const std::uint64_t data_at = at + 8 + header_bytes;
    const std::uint32_t data_bytes = lengthAt(data_at - 4);
    if (data_bytes > bytes_.size() - data_at) throw EndOfBytes();
    if (with_data) out.data = bytes_.at(data_at, data_bytes);
    out.end = data_at + data_bytes;
    return out;
  }

  void readRecords() {
    std::uint64_t at = kBagMagicBytes, chunk = kNoChunk;
    bool indexed = true;  // the chunk's messages
    try {
      while (at < bytes_.size()) {
        const Record head = recordAt(at, false);
        const auto op = numberOf<std::uint8_t>(head.header, "op");
        if (op != kIndex && !indexed) scanChunk(chunk, true);
        if (op != kIndex) indexed = true;
        if (op == kConnection) addConnection(recordAt(at));
        if (op == kMessage) addMessage(head.header, kNoChunk, at);
        if (op == kChunk) {
          chunk = at;
          indexed = false;
        }
        if (op == kIndex && chunk != kNoChunk) {
          addIndex(recordAt(at), chunk);
          indexed = true;
        }
        at = head.end;
      }
      if (!indexed) scanChunk(chunk, true);
    } catch (const EndOfBytes&) {
      if (!indexed && chunk != kNoChunk) scanChunk(chunk, true);
      warnings_.push_back(file_.string() + ": is cut or damaged behind its first " +
                          std::to_string(at >> 20) + " MiB; it is read up to there.");
    }
    resolveTopics();
  }

  void addConnection(const Record& record) {
    const auto number = numberOf<std::uint32_t>(record.header, "conn");
    const Fields data = fieldsOf(record.data);
    const auto type = data.find("type");
    const auto topic = record.header.find("topic");
    if (type == data.end() || topic == record.header.end() || connections_.count(number)) return;
    connections_[number] = topics_.size();
    topics_.push_back({topic->second, type->second});
  }
  void addMessage(const Fields& header, std::uint64_t place, std::uint64_t offset) {
    messages_.push_back({numberOf<std::uint32_t>(header, "conn"),
                         secondsOf(numberOf<std::uint64_t>(header, "time")), place, offset});
  }
  void addIndex(const Record& record, std::uint64_t chunk) {
    const auto connection = numberOf<std::uint32_t>(record.header, "conn");
    ByteReader reader(record.data);
    while (reader.left() >= 12) {
      const auto time = reader.number<std::uint64_t>();
      messages_.push_back({connection, secondsOf(time), chunk, reader.number<std::uint32_t>()});
    }
  }

  /// A chunk without an index behind it, as at the end of a recording that was cut; or its connections alone.
  void scanChunk(std::uint64_t at, bool with_messages) {
    try {
      const std::vector<std::byte> bytes = unpacked(recordAt(at));
      ByteReader reader(bytes);
      while (reader.left() > 0) {
        const std::uint64_t offset = bytes.size() - reader.left();
        Record record;
        record.header = fieldsOf(reader.block());
        const auto data = reader.block();
        const auto op = numberOf<std::uint8_t>(record.header, "op");
        if (op == kMessage && with_messages) addMessage(record.header, at, offset);
        if (op == kConnection) {
          record.data.assign(data.begin(), data.end());
          addConnection(record);
        }
      }
    } catch (const EndOfBytes&) {
      // What the chunk still gave is there.
    }
  }

  /// Connections stand in chunks, too, and once more at the end: messages may come before theirs.
  void resolveTopics() {
    std::set<std::uint64_t> scanned;
    for (const MessageRef& m : messages_)
      if (!connections_.count(static_cast<std::uint32_t>(m.topic)) && m.place != kNoChunk &&
          scanned.insert(m.place).second)
        scanChunk(m.place, false);
    std::erase_if(messages_, [&](MessageRef& m) {
      const auto found = connections_.find(static_cast<std::uint32_t>(m.topic));
      if (found == connections_.end()) return true;
      m.topic = found->second;
      return false;
    });
  }

  std::vector<std::byte> unpacked(const Record& chunk) {
    const auto kind = chunk.header.find("compression");
    const std::string compression = kind == chunk.header.end() ? "none" : kind->second;
    const auto size = numberOf<std::uint32_t>(chunk.header, "size");
    if (size > kMostRecordBytes) throw EndOfBytes();
    if (compression == "none") return chunk.data;
    if (compression != "lz4")
      throw InputError(file_.string() + ": its chunks are compressed with " + compression +
                       "; write it anew with 'rosbag decompress'.");
    return unpackedLz4(chunk.data, size);
  }

  fs::path file_;
  FileBytes bytes_;
  std::map<std::uint32_t, std::size_t> connections_;  // to topics_
  std::vector<std::byte> data_, chunk_;
  std::uint64_t loaded_ = kNoChunk;  // the chunk in chunk_
};

}  // namespace

std::unique_ptr<MessageFile> openRosBag(const fs::path& file) {
  return std::make_unique<RosBag>(file);
}

}  // namespace rosefusion::datasets
