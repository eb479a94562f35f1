// Blocks of bytes that recordings keep compressed.
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace rosefusion::datasets {

/// An LZ4 frame, or a zstd frame, of at most `size` bytes when unpacked. Throws EndOfBytes for damaged ones.
std::vector<std::byte> unpackedLz4(std::span<const std::byte> packed, std::uint64_t size);
std::vector<std::byte> unpackedZstd(std::span<const std::byte> packed, std::uint64_t size);
/// A zlib stream of at most `size` bytes when unpacked.
std::vector<std::byte> unpackedZlib(std::span<const std::byte> packed, std::uint64_t size);

}  // namespace rosefusion::datasets
