// A recording of messages on named topics, such as a ROS bag: an index in memory, messages read one at a
// time.
#pragma once
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace rosefusion::datasets {

struct Topic {
  std::string name;
  std::string type;  ///< without package version, such as sensor_msgs/Image
};

inline constexpr std::uint64_t kNoChunk =
    ~std::uint64_t(0);  ///< MessageRef::place of messages outside of any

struct MessageRef {
  std::size_t topic = 0;    ///< index into MessageFile::topics()
  double timestamp = 0;     ///< seconds, when it was recorded
  std::uint64_t place = 0;  ///< for the file's own use, such as the chunk that it lies in
  std::uint64_t offset = 0;
};

/// One reading thread at a time.
class MessageFile {
 public:
  virtual ~MessageFile() = default;
  const std::vector<Topic>& topics() const { return topics_; }
  const std::vector<MessageRef>& messages() const { return messages_; }  ///< by time
  /// Of messages: CDR (ROS 2) instead of ROS 1's packed bytes.
  virtual bool isCdr() const = 0;
  /// Valid until the next call. Throws EndOfBytes for a damaged message, InputError for an unknown
  /// compression.
  virtual std::span<const std::byte> read(const MessageRef& message) = 0;
  const std::vector<std::string>& warnings() const { return warnings_; }

 protected:
  std::vector<Topic> topics_;
  std::vector<MessageRef> messages_;
  std::vector<std::string> warnings_;
};

/// ROS 1 (ROSBAG V2.0), as rosbag and the RealSense SDK write it. A recording that was cut is read up to
/// there, with a warning. Throws InputError for a file that is none.
std::unique_ptr<MessageFile> openRosBag(const std::filesystem::path& file);
/// ROS 2 in SQLite (.db3), and in MCAP; the same.
std::unique_ptr<MessageFile> openRos2Database(const std::filesystem::path& file);
std::unique_ptr<MessageFile> openMcap(const std::filesystem::path& file);

}  // namespace rosefusion::datasets
