// Reading one depth or colour image, with a sentence about what is wrong with it.
#pragma once
#include <filesystem>
#include <opencv2/core/mat.hpp>
#include <string>

namespace rosefusion::datasets {

/// Reads a 16-bit single-channel image (CV_16UC1). False, with `problem` one sentence that names the file,
/// when it is missing, truncated, damaged, not 16-bit, or not of `expected` size (0 x 0: any size).
bool readDepthImage(const std::filesystem::path& file, cv::Size expected, cv::Mat& depth,
                    std::string& problem);

/// The same for an 8-bit BGR image (CV_8UC3) that must have `expected` size.
bool readColourImage(const std::filesystem::path& file, cv::Size expected, cv::Mat& colour,
                     std::string& problem);

}  // namespace rosefusion::datasets
