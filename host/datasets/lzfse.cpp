#include "host/datasets/lzfse.h"

#include <array>
#include <bit>
#include <cstdint>
#include <numeric>

#include "host/datasets/byte_reader.h"

namespace rosefusion::datasets {
namespace {

constexpr std::uint32_t kEndOfStream = 0x24787662;   // bvx$
constexpr std::uint32_t kStored = 0x2d787662;        // bvx-
constexpr std::uint32_t kLzvn = 0x6e787662;          // bvxn
constexpr std::uint32_t kFsePlainHead = 0x31787662;  // bvx1
constexpr std::uint32_t kFse = 0x32787662;           // bvx2

/// What is unpacked so far; later blocks may copy from earlier ones.
class Output {
 public:
  explicit Output(std::size_t limit) : limit_(limit) {}
  void append(std::span<const std::byte> literals) {
    if (literals.size() > limit_ - bytes_.size()) throw EndOfBytes();
    bytes_.insert(bytes_.end(), literals.begin(), literals.end());
  }
  /// Byte by byte: what is copied may overlap what is written.
  void repeat(std::size_t length, std::size_t distance) {
    if (distance == 0 || distance > bytes_.size() || length > limit_ - bytes_.size()) throw EndOfBytes();
    for (std::size_t i = 0; i < length; ++i) bytes_.push_back(bytes_[bytes_.size() - distance]);
  }
  std::size_t size() const { return bytes_.size(); }
  std::vector<std::byte> take() { return std::move(bytes_); }

 private:
  std::size_t limit_;
  std::vector<std::byte> bytes_;
};

/// Each opcode gives a number of literals that follow it, and a match: its length and how far back it lies
/// (or as far as the last one).
void unpackLzvn(std::span<const std::byte> payload, Output& out) {
  ByteReader in(payload);
  std::size_t distance = 0;
  while (true) {
    const auto op = in.number<std::uint8_t>();
    std::size_t literals = op >> 6, match = ((op >> 3) & 7) + 3u;
    if (op == 0x06) return;
    if (op == 0x0e || op == 0x16) continue;
    if (op >= 0xf0) {  // a match as far back as the last one
      literals = 0;
      match = op == 0xf0 ? in.number<std::uint8_t>() + 16u : op & 15u;
    } else if (op >= 0xe0) {  // literals alone
      literals = op == 0xe0 ? in.number<std::uint8_t>() + 16u : op & 15u;
      match = 0;
    } else if (op >= 0xa0 && op < 0xc0) {  // 14 bits of distance
      const auto more = in.number<std::uint16_t>();
      literals = (op >> 3) & 3;
      match = ((op & 7u) << 2 | (more & 3u)) + 3;
      distance = more >> 2;
    } else if ((op >= 0x70 && op < 0x80) || op >= 0xd0 || ((op & 7) == 6 && op < 0x40)) {
      throw EndOfBytes();  // not defined
    } else if ((op & 7) == 7) {
      distance = in.number<std::uint16_t>();
    } else if ((op & 7) != 6) {
      distance = (op & 7u) << 8 | in.number<std::uint8_t>();
    }
    out.append(in.take(literals));
    if (match > 0) out.repeat(match, distance);
  }
}

/// Bits of a payload from its end to its begin, most significant first.
class BitsFromEnd {
 public:
  /// `unused`: 0 to 7, of the last byte.
  BitsFromEnd(std::span<const std::byte> bytes, int unused) : bytes_(bytes) {
    if (unused < 0 || unused > 7 || 8 * bytes.size() < static_cast<std::size_t>(unused)) throw EndOfBytes();
    left_ = 8 * bytes.size() - static_cast<std::size_t>(unused);
  }
  std::uint32_t pull(unsigned count) {
    if (count > left_) throw EndOfBytes();
    left_ -= count;
    std::uint64_t word = 0;
    const std::size_t first = left_ / 8;
    std::memcpy(&word, bytes_.data() + first, std::min<std::size_t>(8, bytes_.size() - first));
    return static_cast<std::uint32_t>(word >> (left_ % 8) & ((std::uint64_t{1} << count) - 1));
  }

 private:
  std::span<const std::byte> bytes_;
  std::size_t left_ = 0;
};

/// Symbols of one kind, coded by a state that walks through a table.
class FseTable {
 public:
  /// `frequencies` sum up to `states` or less.
  FseTable(std::span<const std::uint16_t> frequencies, std::size_t states) {
    if (std::accumulate(frequencies.begin(), frequencies.end(), std::size_t{0}) > states) throw EndOfBytes();
    entries_.reserve(states);
    for (std::size_t symbol = 0; symbol < frequencies.size(); ++symbol) {
      const std::uint32_t f = frequencies[symbol];
      if (f == 0) continue;
      const int bits = std::countl_zero(f) - std::countl_zero(static_cast<std::uint32_t>(states));
      const auto wide = static_cast<std::uint32_t>(((2 * states) >> bits) - f);  // those that take all bits
      for (std::uint32_t i = 0; i < f; ++i) {
        const bool all = i < wide;
        const auto next = all ? static_cast<std::int32_t>((f + i) << bits) - static_cast<std::int32_t>(states)
                              : static_cast<std::int32_t>((i - wide) << (bits - 1));
        entries_.push_back(
            {static_cast<std::uint16_t>(symbol), static_cast<std::uint8_t>(all ? bits : bits - 1), next});
      }
    }
  }
  std::size_t decode(std::uint32_t& state, BitsFromEnd& bits) const {
    if (state >= entries_.size()) throw EndOfBytes();
    const Entry& entry = entries_[state];
    state = static_cast<std::uint32_t>(entry.next + static_cast<std::int32_t>(bits.pull(entry.bits)));
    return entry.symbol;
  }

 private:
  struct Entry {
    std::uint16_t symbol;
    std::uint8_t bits;
    std::int32_t next;
  };
  std::vector<Entry> entries_;
};

/// A symbol stands for a range of numbers; the bits behind it say which.
template <std::size_t N>
struct Ranges {
  std::array<std::uint8_t, N> extra{};
  std::array<std::uint32_t, N> base{};
  constexpr explicit Ranges(const std::array<std::uint8_t, N>& extra_bits) : extra(extra_bits) {
    for (std::size_t i = 1; i < N; ++i) base[i] = base[i - 1] + (1u << extra[i - 1]);
  }
};

constexpr std::size_t kLengths = 20, kDistances = 64, kLiterals = 256;
constexpr std::size_t kLengthStates = 64, kDistanceStates = 256, kLiteralStates = 1024;

constexpr std::array<std::uint8_t, kDistances> distanceBits() {
  std::array<std::uint8_t, kDistances> bits{};
  for (std::size_t i = 0; i < kDistances; ++i) bits[i] = static_cast<std::uint8_t>(i / 4);
  return bits;
}

constexpr Ranges<kLengths> kLiteralRuns({0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 2, 3, 5, 8});
constexpr Ranges<kLengths> kMatches({0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 3, 5, 8, 11});
constexpr Ranges<kDistances> kDistanceRanges(distanceBits());

template <std::size_t N>
std::size_t decodeNumber(const FseTable& table, const Ranges<N>& ranges, std::uint32_t& state,
                         BitsFromEnd& bits) {
  // The state's bits and the number's lie in one field, the state's first.
  const std::size_t symbol = table.decode(state, bits);
  return ranges.base[symbol] + bits.pull(ranges.extra[symbol]);
}

struct FseHead {
  std::uint32_t raw_bytes = 0, literals = 0, matches = 0, literal_bytes = 0, match_bytes = 0;
  int literal_unused = 0, match_unused = 0;
  std::array<std::uint32_t, 4> literal_states{};
  std::uint32_t run_state = 0, match_state = 0, distance_state = 0;
  std::array<std::uint16_t, 2 * kLengths + kDistances + kLiterals> frequencies{};
};

/// A frequency in 2 to 14 bits, least significant first; what the lowest bits are says how many.
std::uint16_t frequencyOf(std::uint32_t bits, unsigned& count) {
  static constexpr std::array<std::uint8_t, 32> kCounts{2, 3, 2, 5, 2, 3, 2, 8, 2, 3, 2, 5, 2, 3, 2, 14,
                                                        2, 3, 2, 5, 2, 3, 2, 8, 2, 3, 2, 5, 2, 3, 2, 14};
  static constexpr std::array<std::uint8_t, 32> kValues{0, 2, 1, 4, 0, 3, 1, 0, 0, 2, 1, 5, 0, 3, 1, 0,
                                                        0, 2, 1, 6, 0, 3, 1, 0, 0, 2, 1, 7, 0, 3, 1, 0};
  count = kCounts[bits & 31];
  if (count == 8) return static_cast<std::uint16_t>(8 + (bits >> 4 & 15));
  if (count == 14) return static_cast<std::uint16_t>(24 + (bits >> 4 & 1023));
  return kValues[bits & 31];
}

void unpackFrequencies(std::span<const std::byte> packed, FseHead& head) {
  if (packed.empty()) return;
  std::uint32_t bits = 0;
  unsigned have = 0;
  std::size_t next = 0;
  for (std::uint16_t& frequency : head.frequencies) {
    for (; have <= 24 && next < packed.size(); have += 8)
      bits |= static_cast<std::uint32_t>(packed[next++]) << have;
    unsigned count = 0;
    frequency = frequencyOf(bits, count);
    if (count > have) throw EndOfBytes();
    bits >>= count;
    have -= count;
  }
}

/// Behind the block's magic number.
FseHead packedHeadOf(ByteReader& in) {
  FseHead head;
  head.raw_bytes = in.number<std::uint32_t>();
  std::array<std::uint64_t, 3> fields{};
  for (std::uint64_t& field : fields) field = in.number<std::uint64_t>();
  const auto part = [&](std::size_t field, unsigned begin, unsigned count) {
    return static_cast<std::uint32_t>(fields[field] >> begin & ((std::uint64_t{1} << count) - 1));
  };
  head.literals = part(0, 0, 20);
  head.literal_bytes = part(0, 20, 20);
  head.matches = part(0, 40, 20);
  head.literal_unused = 7 - static_cast<int>(part(0, 60, 3));
  for (unsigned i = 0; i < 4; ++i) head.literal_states[i] = part(1, 10 * i, 10);
  head.match_bytes = part(1, 40, 20);
  head.match_unused = 7 - static_cast<int>(part(1, 60, 3));
  const std::uint32_t head_bytes = part(2, 0, 32);
  head.run_state = part(2, 32, 10);
  head.match_state = part(2, 42, 10);
  head.distance_state = part(2, 52, 10);
  constexpr std::uint32_t kWithoutFrequencies = 32;  // of magic number, size and fields
  if (head_bytes < kWithoutFrequencies) throw EndOfBytes();
  unpackFrequencies(in.take(head_bytes - kWithoutFrequencies), head);
  return head;
}

FseHead plainHeadOf(ByteReader& in) {
  FseHead head;
  head.raw_bytes = in.number<std::uint32_t>();
  in.number<std::uint32_t>();  // bytes of the payload: the sum of both parts
  head.literals = in.number<std::uint32_t>();
  head.matches = in.number<std::uint32_t>();
  head.literal_bytes = in.number<std::uint32_t>();
  head.match_bytes = in.number<std::uint32_t>();
  head.literal_unused = -in.number<std::int32_t>();
  for (std::uint32_t& state : head.literal_states) state = in.number<std::uint16_t>();
  head.match_unused = -in.number<std::int32_t>();
  head.run_state = in.number<std::uint16_t>();
  head.match_state = in.number<std::uint16_t>();
  head.distance_state = in.number<std::uint16_t>();
  for (std::uint16_t& frequency : head.frequencies) frequency = in.number<std::uint16_t>();
  return head;
}

void unpackFse(FseHead head, ByteReader& in, Output& out) {
  constexpr std::uint32_t kMostLiterals = 40000, kMostMatches = 10000;
  if (head.literals > kMostLiterals || head.literals % 4 != 0 || head.matches > kMostMatches)
    throw EndOfBytes();
  const std::span<const std::uint16_t> frequencies(head.frequencies);
  const FseTable runs(frequencies.subspan(0, kLengths), kLengthStates),
      matches(frequencies.subspan(kLengths, kLengths), kLengthStates),
      distances(frequencies.subspan(2 * kLengths, kDistances), kDistanceStates),
      symbols(frequencies.subspan(2 * kLengths + kDistances), kLiteralStates);

  std::vector<std::byte> literals(head.literals);
  BitsFromEnd literal_bits(in.take(head.literal_bytes), head.literal_unused);
  for (std::size_t i = 0; i < literals.size(); ++i)
    literals[i] = static_cast<std::byte>(symbols.decode(head.literal_states[i % 4], literal_bits));

  const std::size_t begin = out.size();
  BitsFromEnd bits(in.take(head.match_bytes), head.match_unused);
  ByteReader next(literals);
  std::size_t distance = 0;
  for (std::uint32_t i = 0; i < head.matches; ++i) {
    const std::size_t run = decodeNumber(runs, kLiteralRuns, head.run_state, bits);
    const std::size_t match = decodeNumber(matches, kMatches, head.match_state, bits);
    // 0: as far as the last one.
    if (const std::size_t far = decodeNumber(distances, kDistanceRanges, head.distance_state, bits); far > 0)
      distance = far;
    out.append(next.take(run));
    if (match > 0) out.repeat(match, distance);
  }
  if (out.size() - begin != head.raw_bytes) throw EndOfBytes();
}

}  // namespace

std::vector<std::byte> unpackedLzfse(std::span<const std::byte> packed, std::size_t size) {
  ByteReader in(packed);
  Output out(size);
  while (true) {
    const auto magic = in.number<std::uint32_t>();
    if (magic == kEndOfStream) return out.take();
    if (magic == kStored) {
      out.append(in.block());
    } else if (magic == kLzvn) {
      const std::size_t wanted = out.size() + in.number<std::uint32_t>();
      unpackLzvn(in.block(), out);
      if (out.size() != wanted) throw EndOfBytes();
    } else if (magic == kFse || magic == kFsePlainHead) {
      const FseHead head = magic == kFse ? packedHeadOf(in) : plainHeadOf(in);
      unpackFse(head, in, out);
    } else {
      throw EndOfBytes();
    }
  }
}

}  // namespace rosefusion::datasets
