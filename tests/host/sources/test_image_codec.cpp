// The codec gives every image back bit by bit, keeps its promise on real depth, and refuses damaged bytes.
#include <zstd.h>

#include <chrono>
#include <cstdlib>
#include <random>

#include "host/sources/image_codec.h"
#include "tests/host/sources/memory_sequence.h"

namespace rosefusion::testing {
namespace test_image_codec {

namespace fs = std::filesystem;

std::vector<std::byte> copied(std::span<const std::byte> bytes) {
  return {bytes.begin(), bytes.end()};
}

cv::Mat depthImage(int width, int height, const std::function<int(int, int)>& value) {
  cv::Mat image(height, width, CV_16UC1);
  for (int row = 0; row < height; ++row)
    for (int column = 0; column < width; ++column)
      image.at<std::uint16_t>(row, column) = static_cast<std::uint16_t>(value(row, column));
  return image;
}

TEST(ImageCodec, GivesEveryDepthImageBack) {
  std::mt19937 random(3);
  ImageCodec codec;
  const auto survives = [&](const cv::Mat& image) {
    const auto bytes = copied(codec.compressDepth(image));
    cv::Mat back;
    return codec.decompressDepth(bytes, image.size(), back) && same(image, back);
  };
  EXPECT_TRUE(survives(depthImage(64, 48, [](int, int) { return 0; })));
  EXPECT_TRUE(survives(depthImage(64, 48, [](int, int) { return 65535; })));
  EXPECT_TRUE(survives(depthImage(256, 256, [](int row, int column) { return 256 * row + column; })));
  EXPECT_TRUE(survives(depthImage(333, 77, [&](int, int) { return static_cast<int>(random()); })));
  EXPECT_TRUE(survives(depthImage(1, 1, [](int, int) { return 1234; })));
  EXPECT_TRUE(survives(depthImage(640, 480, [](int row, int column) { return 2000 + row + column / 3; })(
      cv::Rect(17, 5, 100, 90))));  // rows that do not follow each other in memory
}

TEST(ImageCodec, GivesColourBack) {
  std::mt19937 random(4);
  cv::Mat image(48, 64, CV_8UC3);
  for (int i = 0; i < 3 * 48 * 64; ++i) image.data[i] = static_cast<std::uint8_t>(random());
  ImageCodec codec;
  const auto bytes = copied(codec.compressColour(image));
  cv::Mat back;
  ASSERT_TRUE(codec.decompressColour(bytes, image.size(), back));
  EXPECT_TRUE(same(image, back));
}

TEST(ImageCodec, RefusesDamagedBytes) {
  ImageCodec codec;
  const cv::Mat image = numberedFrames(2, 30)[1].depth;
  const auto good = copied(codec.compressDepth(image));
  cv::Mat out;
  EXPECT_FALSE(codec.decompressDepth({}, image.size(), out));
  EXPECT_FALSE(codec.decompressDepth(std::span(good).first(good.size() / 2), image.size(), out));
  EXPECT_FALSE(codec.decompressDepth(good, cv::Size(64, 47), out));
  EXPECT_FALSE(codec.decompressColour(good, image.size(), out));
  for (std::size_t i = 0; i < good.size(); ++i) {
    auto bad = good;
    bad[i] ^= std::byte{0x10};
    EXPECT_TRUE(!codec.decompressDepth(bad, image.size(), out) || same(image, out)) << "byte " << i;
  }
  ASSERT_TRUE(codec.decompressDepth(good, image.size(), out));
  EXPECT_TRUE(same(image, out));
}

TEST(ImageCodec, RefusesRanksThatNoValueHas) {
  const std::size_t pixels = 64 * 48;
  std::vector<std::uint8_t> plain(2 * pixels + 8192, 0);
  plain[2 * pixels] = 1;  // one value, 0
  plain[5] = 4;           // rank 2
  std::vector<std::byte> bytes(ZSTD_compressBound(plain.size()));
  bytes.resize(ZSTD_compress(bytes.data(), bytes.size(), plain.data(), plain.size(), 1));
  ImageCodec codec;
  cv::Mat out;
  EXPECT_FALSE(codec.decompressDepth(bytes, cv::Size(64, 48), out));
}

TEST(ImageCodec, RealDepthShrinksToAThird) {
  const char* variable = std::getenv("ROSEFUSION_DATA");
  const fs::path data = variable ? variable : fs::path(ROSEFUSION_SOURCE_DIR) / "../shared/data";
  if (!fs::exists(data / "tum_fr1_rpy"))
    GTEST_SKIP() << "Set ROSEFUSION_DATA to a folder with tum_fr1_rpy to run this on real frames.";
  const auto sequence = openSequence(data / "tum_fr1_rpy");
  ImageCodec codec;
  double raw = 0, packed = 0, seconds = 0;
  int frames = 0;
  for (std::size_t i = 0; i < sequence->size(); i += 36, ++frames) {
    Frame frame;
    std::string problem;
    ASSERT_TRUE(sequence->read(i, frame, problem)) << problem;
    const auto start = std::chrono::steady_clock::now();
    const auto bytes = copied(codec.compressDepth(frame.depth));
    cv::Mat back;
    ASSERT_TRUE(codec.decompressDepth(bytes, frame.depth.size(), back));
    seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    EXPECT_TRUE(same(frame.depth, back));
    raw += 2.0 * frame.depth.total();
    packed += bytes.size();
  }
  std::printf("%.2f:1, %.2f ms a frame both ways\n", raw / packed, 1000 * seconds / frames);
  EXPECT_GT(raw / packed, 3);
}

}  // namespace test_image_codec
}  // namespace rosefusion::testing
