// ETH3D SLAM (Schoeps et al., CVPR 2019): the TUM layout with calibration.txt and associated.txt; depth in
// 1/5000 m.
#include "host/datasets/listing.h"

namespace rosefusion::datasets {
namespace {

bool matchesEth3d(const std::filesystem::path& folder) {
  return std::filesystem::is_regular_file(folder / "calibration.txt") &&
         std::filesystem::is_regular_file(folder / "associated.txt");
}

Listing listEth3d(const std::filesystem::path& folder) {
  return listTumLayout(folder, kEth3dReader.format, {});
}

}  // namespace

const Reader kEth3dReader{"ETH3D SLAM", "calibration.txt with associated.txt (ETH3D)", matchesEth3d,
                          listEth3d};

}  // namespace rosefusion::datasets
