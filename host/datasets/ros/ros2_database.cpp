// ROS 2 recordings in SQLite (rosbag2, and the RealSense SDK from 2.58 on).
#include <sqlite3.h>
#include <zstd.h>

#include <map>

#include "host/core/error.h"
#include "host/datasets/byte_reader.h"
#include "host/datasets/compression.h"
#include "host/datasets/ros/message_file.h"

namespace rosefusion::datasets {
namespace {

namespace fs = std::filesystem;

constexpr unsigned char kZstdMagic[] = {0x28, 0xb5, 0x2f, 0xfd};

using Database = std::unique_ptr<sqlite3, decltype(&sqlite3_close)>;
using Statement = std::unique_ptr<sqlite3_stmt, decltype(&sqlite3_finalize)>;

class Ros2Database : public MessageFile {
 public:
  explicit Ros2Database(const fs::path& file) : file_(file), database_(nullptr, &sqlite3_close) {
    sqlite3* opened = nullptr;
    const int result = sqlite3_open_v2(file.c_str(), &opened, SQLITE_OPEN_READONLY, nullptr);
    database_.reset(opened);
    if (result != SQLITE_OK) refuse();
    std::map<std::int64_t, std::size_t> by_id;
    const Statement topics = prepared("SELECT id, name, type FROM topics");
    while (step(topics)) {
      by_id[sqlite3_column_int64(topics.get(), 0)] = topics_.size();
      topics_.push_back({textOf(topics, 1), withoutMsg(textOf(topics, 2))});
    }
    const Statement messages =
        prepared("SELECT id, topic_id, timestamp FROM messages ORDER BY timestamp, id");
    while (step(messages)) {
      const auto topic = by_id.find(sqlite3_column_int64(messages.get(), 1));
      if (topic == by_id.end()) continue;
      messages_.push_back({topic->second, 1e-9 * static_cast<double>(sqlite3_column_int64(messages.get(), 2)),
                           static_cast<std::uint64_t>(sqlite3_column_int64(messages.get(), 0)), 0});
    }
  }

  bool isCdr() const override { return true; }

  std::span<const std::byte> read(const MessageRef& message) override {
    const Statement row = prepared("SELECT data FROM messages WHERE id = ?");
    sqlite3_bind_int64(row.get(), 1, static_cast<sqlite3_int64>(message.place));
    const bool found = sqlite3_step(row.get()) == SQLITE_ROW;
    const auto* bytes = found ? static_cast<const std::byte*>(sqlite3_column_blob(row.get(), 0)) : nullptr;
    const auto count = static_cast<std::size_t>(found ? sqlite3_column_bytes(row.get(), 0) : 0);
    if (count < 4) throw EndOfBytes();
    data_.assign(bytes, bytes + count);
    if (std::memcmp(data_.data(), kZstdMagic, sizeof kZstdMagic) == 0) unpack();
    return data_;
  }

 private:
  [[noreturn]] void refuse() const {
    throw InputError(file_.string() + ": is no ROS 2 recording (" +
                     (database_ ? sqlite3_errmsg(database_.get()) : "no memory") + "); copy it again.");
  }
  Statement prepared(const char* sql) const {
    sqlite3_stmt* statement = nullptr;
    if (sqlite3_prepare_v2(database_.get(), sql, -1, &statement, nullptr) != SQLITE_OK) refuse();
    return {statement, &sqlite3_finalize};
  }
  /// False at the end, and with a warning where the file is damaged from here on.
  bool step(const Statement& statement) {
    const int result = sqlite3_step(statement.get());
    if (result == SQLITE_ROW) return true;
    if (result != SQLITE_DONE)
      warnings_.push_back(file_.string() + ": is damaged (" + sqlite3_errmsg(database_.get()) +
                          "); what could be read of it is used.");
    return false;
  }
  static std::string textOf(const Statement& row, int column) {
    const unsigned char* text = sqlite3_column_text(row.get(), column);
    return text ? reinterpret_cast<const char*>(text) : "";
  }
  static std::string withoutMsg(std::string type) {
    if (const auto at = type.find("/msg/"); at != std::string::npos) type.erase(at, 4);
    return type;
  }
  void unpack() {
    const unsigned long long size = ZSTD_getFrameContentSize(data_.data(), data_.size());
    if (size > kMostRecordBytes) throw EndOfBytes();  // unknown and error are larger still
    data_ = unpackedZstd(data_, size);
  }

  fs::path file_;
  Database database_;
  std::vector<std::byte> data_;
};

}  // namespace

std::unique_ptr<MessageFile> openRos2Database(const fs::path& file) {
  return std::make_unique<Ros2Database>(file);
}

}  // namespace rosefusion::datasets
