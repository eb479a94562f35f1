#include "host/sources/image_codec.h"

#include <zstd.h>

#include <bit>
#include <cstring>
#include <new>

namespace rosefusion {
namespace {

static_assert(std::endian::native == std::endian::little);

constexpr int kLevel = 1;  // higher ones take longer and gain less than 2 %
constexpr std::size_t kValues = 65536;
constexpr std::size_t kSetBytes = kValues / 8;  // which values the image holds, a bit each

std::uint16_t zigzag(std::uint16_t difference) {
  return static_cast<std::uint16_t>(difference << 1 ^ -(difference >> 15));
}

std::uint16_t unzigzag(std::uint16_t code) {
  return static_cast<std::uint16_t>(code >> 1 ^ -(code & 1));
}

}  // namespace

struct ImageCodec::Contexts {
  ZSTD_CCtx* compress = ZSTD_createCCtx();
  ZSTD_DCtx* decompress = ZSTD_createDCtx();
  ~Contexts() {
    ZSTD_freeCCtx(compress);
    ZSTD_freeDCtx(decompress);
  }
};

ImageCodec::ImageCodec() : contexts_(std::make_unique<Contexts>()), table_(kValues) {
  if (!contexts_->compress || !contexts_->decompress) throw std::bad_alloc();
  ZSTD_CCtx_setParameter(contexts_->compress, ZSTD_c_compressionLevel, kLevel);
  ZSTD_CCtx_setParameter(contexts_->compress, ZSTD_c_checksumFlag, 1);
}

ImageCodec::~ImageCodec() = default;

std::span<const std::byte> ImageCodec::compress(std::size_t plain_bytes) {
  packed_.resize(ZSTD_compressBound(plain_bytes));
  const std::size_t bytes =
      ZSTD_compress2(contexts_->compress, packed_.data(), packed_.size(), plain_.data(), plain_bytes);
  return std::as_bytes(std::span(packed_).first(bytes));  // cannot fail: the buffer holds the bound
}

bool ImageCodec::decompress(std::span<const std::byte> bytes, std::size_t plain_bytes) {
  if (ZSTD_getFrameContentSize(bytes.data(), bytes.size()) != plain_bytes) return false;
  plain_.resize(plain_bytes);
  return ZSTD_decompressDCtx(contexts_->decompress, plain_.data(), plain_bytes, bytes.data(), bytes.size()) ==
         plain_bytes;
}

std::span<const std::byte> ImageCodec::compressDepth(const cv::Mat& depth) {
  const cv::Mat image = depth.isContinuous() ? depth : depth.clone();
  const auto* values = image.ptr<std::uint16_t>();
  const std::size_t pixels = image.total(), width = static_cast<std::size_t>(image.cols);
  plain_.assign(2 * pixels + kSetBytes, 0);
  std::uint8_t *low = plain_.data(), *high = low + pixels, *set = high + pixels;

  std::vector<std::uint8_t> present(kValues, 0);
  for (std::size_t i = 0; i < pixels; ++i) present[values[i]] = 1;
  std::uint16_t rank = 0;
  for (std::size_t value = 0; value < kValues; ++value) {
    if (!present[value]) continue;
    table_[value] = rank++;
    set[value / 8] |= static_cast<std::uint8_t>(1 << value % 8);
  }
  rows_.resize(pixels);
  for (std::size_t i = 0; i < pixels; ++i) rows_[i] = table_[values[i]];
  for (std::size_t i = 0; i < pixels; ++i) {
    const std::uint16_t above = i < width ? 0 : rows_[i - width];
    const std::uint16_t code = zigzag(static_cast<std::uint16_t>(rows_[i] - above));
    low[i] = static_cast<std::uint8_t>(code);
    high[i] = static_cast<std::uint8_t>(code >> 8);
  }
  return compress(plain_.size());
}

bool ImageCodec::decompressDepth(std::span<const std::byte> bytes, cv::Size size, cv::Mat& depth) {
  const auto pixels = static_cast<std::size_t>(size.area()), width = static_cast<std::size_t>(size.width);
  if (!decompress(bytes, 2 * pixels + kSetBytes)) return false;
  const std::uint8_t *low = plain_.data(), *high = low + pixels, *set = high + pixels;
  std::size_t count = 0;
  for (std::size_t value = 0; value < kValues; ++value)
    if (set[value / 8] >> value % 8 & 1) table_[count++] = static_cast<std::uint16_t>(value);

  depth.create(size, CV_16UC1);
  rows_.resize(pixels);
  auto* values = depth.ptr<std::uint16_t>();
  bool unknown_rank = false;
  for (std::size_t i = 0; i < pixels; ++i) {
    const std::uint16_t above = i < width ? 0 : rows_[i - width];
    const auto code = static_cast<std::uint16_t>(low[i] | high[i] << 8);
    rows_[i] = static_cast<std::uint16_t>(above + unzigzag(code));
    unknown_rank |= rows_[i] >= count;
    values[i] = table_[rows_[i]];
  }
  return !unknown_rank;
}

std::span<const std::byte> ImageCodec::compressColour(const cv::Mat& colour) {
  const cv::Mat image = colour.isContinuous() ? colour : colour.clone();
  const std::uint8_t* values = image.ptr<std::uint8_t>();
  const std::size_t bytes = 3 * image.total(), row = 3 * static_cast<std::size_t>(image.cols);
  plain_.resize(bytes);
  for (std::size_t i = 0; i < bytes; ++i)
    plain_[i] = static_cast<std::uint8_t>(values[i] - (i < row ? 0 : values[i - row]));
  return compress(bytes);
}

bool ImageCodec::decompressColour(std::span<const std::byte> bytes, cv::Size size, cv::Mat& colour) {
  const auto plain_bytes = 3 * static_cast<std::size_t>(size.area());
  const auto row = 3 * static_cast<std::size_t>(size.width);
  if (!decompress(bytes, plain_bytes)) return false;
  colour.create(size, CV_8UC3);
  auto* values = colour.ptr<std::uint8_t>();
  for (std::size_t i = 0; i < plain_bytes; ++i)
    values[i] = static_cast<std::uint8_t>(plain_[i] + (i < row ? 0 : values[i - row]));
  return true;
}

}  // namespace rosefusion
