// Images as PNG files that are either whole or absent.
#pragma once
#include <filesystem>
#include <opencv2/core/mat.hpp>

namespace rosefusion {

/// A 16-bit single-channel or an 8-bit BGR image. Throws InputError naming the file.
void writePng(const std::filesystem::path& file, const cv::Mat& image);

}  // namespace rosefusion
