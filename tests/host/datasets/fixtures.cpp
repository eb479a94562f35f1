#include "tests/host/datasets/fixtures.h"

#include <gmock/gmock.h>
#include <unistd.h>

#include <atomic>
#include <cstring>
#include <fstream>
#include <iterator>
#include <opencv2/imgcodecs.hpp>
#include <random>

#include "host/core/error.h"
#include "host/datasets/sequence.h"

namespace rosefusion::testing {

namespace fs = std::filesystem;

TemporaryFolder::TemporaryFolder(const std::string& name) {
  static std::atomic<int> next{0};
  root_ = fs::temp_directory_path() /
          ("rosefusion_datasets_" + std::to_string(::getpid()) + "_" + std::to_string(next++));
  path_ = root_ / name;
  fs::create_directories(path_);
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  fs::remove_all(root_, ignored);
}

void TemporaryFolder::write(const std::string& file, std::string_view bytes) const {
  fs::create_directories((path_ / file).parent_path());
  std::ofstream out(path_ / file, std::ios::binary);
  out << bytes;
  ASSERT_TRUE(out.good()) << text(file);
}

void TemporaryFolder::writeImage(const std::string& file, const cv::Mat& image) const {
  fs::create_directories((path_ / file).parent_path());
  ASSERT_TRUE(cv::imwrite(text(file), image)) << text(file);
}

std::string TemporaryFolder::read(const std::string& file) const {
  std::ifstream in(path_ / file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

void TemporaryFolder::truncate(const std::string& file, double share) const {
  const double size = static_cast<double>(fs::file_size(path_ / file));
  fs::resize_file(path_ / file, static_cast<std::uintmax_t>(share * size));
}

void TemporaryFolder::remove(const std::string& file) const {
  ASSERT_TRUE(fs::remove(path_ / file)) << text(file);
}

cv::Mat depthImage(int base, int width, int height) {
  cv::Mat image(height, width, CV_16UC1);
  for (int v = 0; v < height; ++v)
    for (int u = 0; u < width; ++u)
      image.at<std::uint16_t>(v, u) = static_cast<std::uint16_t>(base + u + 40 * v);
  return image;
}

cv::Mat colourImage(int red, int width, int height) {
  return {height, width, CV_8UC3, cv::Scalar(10, 20, red)};
}

void makeTum(const TemporaryFolder& folder, int width, int height) {
  folder.write("depth.txt",
               "# depth maps\n# file: 'recording.bag'\n# timestamp filename\n"
               "1305031229.528784 depth/1305031229.528784.png\n"
               "1305031229.562084 depth/1305031229.562084.png\n"
               "1305031229.595384 depth/1305031229.595384.png\n");
  folder.write("rgb.txt",
               "# color images\n# timestamp filename\n"
               "1305031229.538784 rgb/1305031229.538784.png\n"
               "1305031229.572084 rgb/1305031229.572084.png\n"
               "1305031229.605384 rgb/1305031229.605384.png\n");
  folder.write("groundtruth.txt",
               "# ground truth trajectory\n# timestamp tx ty tz qx qy qz qw\n"
               "1305031229.5000 1.0000 0.6698 1.6180 0.0000 0.0000 0.0000 1.0000\n"
               "1305031229.5400 1.1000 0.6698 1.6180 0.0000 0.0000 0.0000 1.0000\n"
               "1305031229.5800 1.2000 0.6698 1.6180 0.0000 0.0000 0.0000 1.0000\n"
               "1305031229.6200 1.3000 0.6698 1.6180 0.0000 0.0000 0.7071 0.7071\n");
  int n = 0;
  for (const char* stamp : {"1305031229.528784", "1305031229.562084", "1305031229.595384"})
    folder.writeImage("depth/" + std::string(stamp) + ".png", depthImage(5000 + 100 * n++, width, height));
  for (const char* stamp : {"1305031229.538784", "1305031229.572084", "1305031229.605384"})
    folder.writeImage("rgb/" + std::string(stamp) + ".png", colourImage(100 + n++, width, height));
}

std::string openingError(const fs::path& path) {
  try {
    openSequence(path);
  } catch (const InputError& error) {
    return error.what();
  }
  ADD_FAILURE() << path << " should not open";
  return {};
}

std::string fileBytes(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

namespace {

bool readAll(const fs::path& file) {
  SequenceOptions options;
  options.colour = true;
  try {
    const auto sequence = openSequence(file, options);
    Frame frame;
    std::string problem;
    for (std::size_t i = 0; i < sequence->size(); ++i)
      EXPECT_TRUE(sequence->read(i, frame, problem) || !problem.empty());
    return true;
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), ::testing::HasSubstr(file.filename().string()));
    return false;
  }
}

}  // namespace

int openDamagedVariants(const fs::path& recording) {
  const TemporaryFolder folder;
  const std::string whole = fileBytes(recording), name = "damaged" + recording.extension().string();
  std::mt19937 random(1);
  int opened = 0;
  for (int i = 0; i < 1000; ++i) {
    std::string bytes = whole;
    const auto at = [&] { return random() % bytes.size(); };
    if (i % 3 == 0) bytes.resize(at());
    if (i % 3 == 1)
      for (int k = 0; k < 8; ++k) bytes[at()] = static_cast<char>(random());
    if (i % 3 == 2 && bytes.size() > 8) {  // a size that lies
      const std::uint32_t lie = random();
      std::memcpy(bytes.data() + random() % (bytes.size() - 4), &lie, 4);
    }
    folder.write(name, bytes);
    opened += readAll(folder.path() / name);
  }
  return opened;
}

}  // namespace rosefusion::testing
