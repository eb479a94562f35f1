// Apple's LZFSE, in which iPhone apps keep depth: written from the format's layout (blocks, tables, opcodes).
#pragma once
#include <cstddef>
#include <span>
#include <vector>

namespace rosefusion::datasets {

/// A whole stream of at most `size` bytes when unpacked: blocks stored (bvx-), of LZVN (bvxn) and of LZ77
/// with finite-state entropy coding (bvx2, bvx1). Throws EndOfBytes for damaged ones.
std::vector<std::byte> unpackedLzfse(std::span<const std::byte> packed, std::size_t size);

}  // namespace rosefusion::datasets
