#include "host/sources/wire.h"

#include <bit>
#include <cmath>
#include <cstring>

#include "host/core/error.h"

namespace rosefusion::wire {
namespace {

static_assert(std::endian::native == std::endian::little);

constexpr std::uint32_t kMinSide = 8;
constexpr std::size_t kMaxRefusalBytes = 512;

struct Start {
  std::uint32_t magic;
  std::uint16_t version, type;
  std::uint64_t session;
};

template <typename T>
T read(std::span<const std::byte> bytes) {
  T out;
  std::memcpy(&out, bytes.data(), sizeof(T));
  return out;
}

template <typename T>
std::vector<std::byte> bytesOf(const T& value) {
  std::vector<std::byte> out(sizeof(T));
  std::memcpy(out.data(), &value, sizeof(T));
  return out;
}

/// Empty when the header may be believed.
std::string problemOf(const Header& h, std::size_t bytes) {
  const auto type = static_cast<Type>(h.type);
  if (type != Type::Probe && type != Type::Frame && type != Type::End)
    return "its type " + std::to_string(h.type) + " is unknown";
  if (h.flags & ~kLive || h.reserved != 0) return "it has unknown flags";
  if (h.width < kMinSide || h.height < kMinSide || h.width > kMaxSide || h.height > kMaxSide)
    return "its images are " + std::to_string(h.width) + "x" + std::to_string(h.height) + " pixels";
  if (std::uint64_t(h.depth_bytes) + h.colour_bytes + sizeof(Header) != bytes)
    return "its sizes do not add up: " + std::to_string(bytes) + " bytes came";
  if ((type == Type::Frame) != (h.depth_bytes > 0) || (type != Type::Frame && h.colour_bytes > 0))
    return "it has images where none belong, or lacks its depth";
  if (!std::isfinite(h.timestamp)) return "its time stamp is no number";
  if (!(h.seconds_per_stamp >= 1e-9 && h.seconds_per_stamp <= 1e3)) return "its stamps have no usable unit";
  if (!(h.depth_units_per_metre >= 1 && h.depth_units_per_metre <= 1e6))
    return "its depth scale is out of range";
  return "";
}

}  // namespace

Intrinsics Message::intrinsics() const {
  return {static_cast<int>(header.width),
          static_cast<int>(header.height),
          header.fx,
          header.fy,
          header.cx,
          header.cy};
}

std::optional<Message> parse(std::span<const std::byte> bytes, std::string& problem) {
  problem.clear();
  if (bytes.size() < sizeof(Start) || read<std::uint32_t>(bytes) != kMagic) {
    problem = "it is none of rosefusion's";
    return std::nullopt;
  }
  if (const auto start = read<Start>(bytes); start.version != kVersion) {
    problem = "its version is " + std::to_string(start.version) + ", and this program knows " +
              std::to_string(kVersion) + "; use the same program at both ends";
    return std::nullopt;
  }
  if (bytes.size() < sizeof(Header)) {
    problem = "it is truncated";
    return std::nullopt;
  }
  Message message{read<Header>(bytes), {}, {}};
  problem = problemOf(message.header, bytes.size());
  if (!problem.empty()) return std::nullopt;
  try {
    requirePlausible(message.intrinsics(), "its camera");
  } catch (const InputError& error) {
    problem = error.what();
    return std::nullopt;
  }
  message.depth = bytes.subspan(sizeof(Header), message.header.depth_bytes);
  message.colour = bytes.subspan(sizeof(Header) + message.header.depth_bytes);
  return message;
}

std::vector<std::byte> pack(Header header, std::span<const std::byte> depth,
                            std::span<const std::byte> colour) {
  header.depth_bytes = static_cast<std::uint32_t>(depth.size());
  header.colour_bytes = static_cast<std::uint32_t>(colour.size());
  std::vector<std::byte> out = bytesOf(header);
  out.reserve(out.size() + depth.size() + colour.size());
  out.insert(out.end(), depth.begin(), depth.end());
  out.insert(out.end(), colour.begin(), colour.end());
  return out;
}

std::vector<std::byte> pack(const Ack& ack) {
  return bytesOf(ack);
}

std::vector<std::byte> packRefusal(std::uint64_t session, const std::string& sentence) {
  std::vector<std::byte> out =
      bytesOf(Start{kMagic, kVersion, static_cast<std::uint16_t>(Type::Refusal), session});
  const auto text = std::as_bytes(std::span(sentence).first(std::min(sentence.size(), kMaxRefusalBytes)));
  out.insert(out.end(), text.begin(), text.end());
  return out;
}

Answer parseAnswer(std::span<const std::byte> bytes, std::uint64_t session) {
  Answer answer;
  if (bytes.size() < sizeof(Start)) return answer;
  const auto start = read<Start>(bytes);
  if (start.magic != kMagic || start.session != session) return answer;
  if (start.type == static_cast<std::uint16_t>(Type::Ack) && start.version == kVersion &&
      bytes.size() == sizeof(Ack))
    answer.ack = read<Ack>(bytes);
  if (start.type == static_cast<std::uint16_t>(Type::Refusal)) {
    for (const std::byte b :
         bytes.subspan(sizeof(Start)).first(std::min(bytes.size() - sizeof(Start), kMaxRefusalBytes)))
      answer.refusal += b >= std::byte{32} && b < std::byte{127} ? static_cast<char>(b) : '?';
    if (answer.refusal.empty()) answer.refusal = "without a reason";
  }
  return answer;
}

}  // namespace rosefusion::wire
