// Reading one depth or colour image, with a sentence about what is wrong with it.
#pragma once
#include <filesystem>
#include <opencv2/core/mat.hpp>
#include <string>

namespace rosefusion::datasets {

/// Reads a 16-bit single-channel image (CV_16UC1), or one of floating-point numbers (TIFF, OpenEXR where
/// OpenCV is allowed to, NumPy's .npy) as CV_32FC1. False, with `problem` one sentence that names the file,
/// when it is missing, truncated, damaged, of another kind, or not of `expected` size (0 x 0: any size).
bool readDepthImage(const std::filesystem::path& file, cv::Size expected, cv::Mat& depth,
                    std::string& problem);

/// The same for an 8-bit BGR image (CV_8UC3) that must have `expected` size.
bool readColourImage(const std::filesystem::path& file, cv::Size expected, cv::Mat& colour,
                     std::string& problem);

/// The same for an 8-bit map of how far the sensor trusts each depth (CV_8UC1).
bool readConfidence(const std::filesystem::path& file, cv::Size expected, cv::Mat& confidence,
                    std::string& problem);

}  // namespace rosefusion::datasets
