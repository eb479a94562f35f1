#include "host/datasets/compression.h"

#include <lz4frame.h>
#include <zlib.h>
#include <zstd.h>

#include <memory>

#include "host/datasets/byte_reader.h"

namespace rosefusion::datasets {

std::vector<std::byte> unpackedLz4(std::span<const std::byte> packed, std::uint64_t size) {
  LZ4F_dctx* raw = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&raw, LZ4F_VERSION))) throw EndOfBytes();
  const std::unique_ptr<LZ4F_dctx, decltype(&LZ4F_freeDecompressionContext)> context(
      raw, &LZ4F_freeDecompressionContext);
  std::vector<std::byte> out(size);
  std::size_t written = 0, read = 0;
  while (written < out.size() && read < packed.size()) {
    std::size_t to = out.size() - written, from = packed.size() - read;
    if (LZ4F_isError(LZ4F_decompress(raw, out.data() + written, &to, packed.data() + read, &from, nullptr)))
      throw EndOfBytes();
    if (to == 0 && from == 0) break;
    written += to;
    read += from;
  }
  out.resize(written);
  return out;
}

std::vector<std::byte> unpackedZstd(std::span<const std::byte> packed, std::uint64_t size) {
  std::vector<std::byte> out(size);
  const std::size_t written = ZSTD_decompress(out.data(), out.size(), packed.data(), packed.size());
  if (ZSTD_isError(written)) throw EndOfBytes();
  out.resize(written);
  return out;
}

std::vector<std::byte> unpackedZlib(std::span<const std::byte> packed, std::uint64_t size) {
  std::vector<std::byte> out(size);
  uLongf written = size;
  if (uncompress(reinterpret_cast<Bytef*>(out.data()), &written,
                 reinterpret_cast<const Bytef*>(packed.data()), packed.size()) != Z_OK)
    throw EndOfBytes();
  out.resize(written);
  return out;
}

}  // namespace rosefusion::datasets
