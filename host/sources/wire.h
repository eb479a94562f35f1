// What goes over the network: messages of fixed, little-endian layout. Pure: bytes in, checked values out.
#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "host/core/camera.h"

namespace rosefusion::wire {

inline constexpr std::uint32_t kMagic = 0x46534F52;  // "ROSF"
inline constexpr std::uint16_t kVersion = 1;
inline constexpr std::uint32_t kMaxSide = 4096;  ///< pixels of an image's width or height
/// Larger messages are refused before they are read: an image of kMaxSide squared would not fit, one of 8
/// megapixels does.
inline constexpr std::int64_t kMaxMessageBytes = 64 << 20;

/// The sender says Probe (here I am, and what I send), Frame and End; the receiver Ack and Refusal.
enum class Type : std::uint16_t { Probe = 1, Frame = 2, End = 3, Ack = 4, Refusal = 5 };

inline constexpr std::uint32_t kLive = 1;  ///< flag: frames may be dropped; otherwise each one must arrive

/// Of every message of the sender. Field by field at the offsets that follow from this order, without
/// padding.
struct Header {
  std::uint32_t magic = kMagic;
  std::uint16_t version = kVersion;
  std::uint16_t type = 0;
  std::uint64_t session = 0;  ///< random, one per stream
  std::uint64_t sequence =
      0;  ///< of frames and the end, from 0; a probe: the oldest that the sender still has
  std::uint32_t flags = 0;
  std::uint32_t depth_bytes = 0;   ///< compressed; follow the header
  std::uint32_t colour_bytes = 0;  ///< compressed; follow the depth; 0: no colour
  std::uint32_t width = 0, height = 0;
  std::uint32_t reserved = 0;
  double timestamp = 0;          ///< seconds
  double seconds_per_stamp = 1;  ///< see SequenceInfo
  double fx = 0, fy = 0, cx = 0, cy = 0;
  double depth_units_per_metre = 0;
  std::uint64_t frames = 0;  ///< in all; 0: not known
};
static_assert(sizeof(Header) == 112);

/// The receiver's answer to each message.
struct Ack {
  std::uint32_t magic = kMagic;
  std::uint16_t version = kVersion;
  std::uint16_t type = static_cast<std::uint16_t>(Type::Ack);
  std::uint64_t session = 0;
  std::uint64_t expected = 0;    ///< all before it have arrived
  std::uint64_t window_end = 0;  ///< sequences from here on must wait
};
static_assert(sizeof(Ack) == 32);

/// A sender's message whose every field is in range and whose sizes add up; the images are still compressed.
struct Message {
  Header header;
  std::span<const std::byte> depth, colour;  ///< within the bytes that were parsed

  Type type() const { return static_cast<Type>(header.type); }
  bool live() const { return header.flags & kLive; }
  Intrinsics intrinsics() const;
};

/// Nothing when the bytes are no valid message; `problem` is then a sentence's end such as "its version is 7,
/// and this program knows 1". Allocates nothing that the bytes ask for.
std::optional<Message> parse(std::span<const std::byte> bytes, std::string& problem);
std::vector<std::byte> pack(Header header, std::span<const std::byte> depth = {},
                            std::span<const std::byte> colour = {});

/// The sender's view of the receiver's answers.
struct Answer {
  std::optional<Ack> ack;
  std::string refusal;  ///< a sentence
};
Answer parseAnswer(std::span<const std::byte> bytes, std::uint64_t session);
std::vector<std::byte> pack(const Ack& ack);
std::vector<std::byte> packRefusal(std::uint64_t session, const std::string& sentence);

}  // namespace rosefusion::wire
