// Small sequences of every layout, made at run time: realistic text files around 32x24 images.
#pragma once
#include <gtest/gtest.h>

#include <filesystem>
#include <opencv2/core/mat.hpp>
#include <string>
#include <string_view>

namespace rosefusion::testing {

inline constexpr int kWidth = 32, kHeight = 24;

/// A folder of its own for one test, removed with everything in it at the end.
class TemporaryFolder {
 public:
  explicit TemporaryFolder(const std::string& name = "sequence");
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  /// The folder named at construction, inside one nobody else uses.
  const std::filesystem::path& path() const { return path_; }
  std::string text(const std::string& file) const { return (path_ / file).string(); }

  void write(const std::string& file, std::string_view bytes) const;
  void writeImage(const std::string& file, const cv::Mat& image) const;
  std::string read(const std::string& file) const;
  /// Cuts a file to this share of its size.
  void truncate(const std::string& file, double share) const;
  void remove(const std::string& file) const;

 private:
  std::filesystem::path root_, path_;
};

/// 16-bit image in which every pixel differs: value(u, v) = base + u + 40 v, so that any mix-up shows.
cv::Mat depthImage(int base, int width = kWidth, int height = kHeight);

/// 8-bit BGR image of one colour (10, 20, red).
cv::Mat colourImage(int red, int width = kWidth, int height = kHeight);

/// Three frames, colour beside them 10 ms later, four truth poses 0.1 m apart along x; no calibration.txt.
void makeTum(const TemporaryFolder& folder, int width = kWidth, int height = kHeight);

/// The text of InputError that opening `path` ends in; fails the test when it opens.
std::string openingError(const std::filesystem::path& path);

/// All bytes of a file.
std::string fileBytes(const std::filesystem::path& file);

/// Opens and reads 1000 damaged variants of a recording in one file: cut, with changed bytes, with sizes that
/// lie. Whatever happens must be a sentence that names the file. How many of them opened.
int openDamagedVariants(const std::filesystem::path& recording);

}  // namespace rosefusion::testing
