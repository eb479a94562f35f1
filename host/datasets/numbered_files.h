// Images that are named by a number alone, as recorders write them: 000012.png, or 000012-000000400000.png.
#pragma once
#include <filesystem>
#include <optional>
#include <vector>

namespace rosefusion::datasets {

struct NumberedFile {
  int number = 0;
  std::optional<double> seconds;  ///< of names with a second number: microseconds
  std::filesystem::path path;
};

/// The depth images (.png, .tiff, .tif, .exr, .npy) or the others (.jpg, .jpeg, .png) of a folder in the
/// order of their numbers, one of each; none where there is no such folder.
std::vector<NumberedFile> numberedDepth(const std::filesystem::path& folder);
std::vector<NumberedFile> numberedColour(const std::filesystem::path& folder);

/// Whether it has at least one numbered depth image.
bool hasNumberedDepth(const std::filesystem::path& folder);

}  // namespace rosefusion::datasets
