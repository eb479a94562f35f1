// Which colour image belongs to which depth image: association files, and nearest stamps where there is none.
#pragma once
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "host/datasets/listing.h"

namespace rosefusion::datasets {

/// Half the interval of a 30 Hz camera, rounded up: a colour image further away belongs to another depth
/// frame.
inline constexpr double kMaxColourOffset = 0.02;

/// For each stamp of `from`, the index of the nearest of `to` (any order) within `max_difference`, else
/// nothing.
std::vector<std::optional<std::size_t>> associateNearest(const std::vector<double>& from,
                                                         const std::vector<double>& to,
                                                         double max_difference);

/// The folder's association file (associations.txt, associated.txt, associate.txt or association.txt), or
/// empty.
std::filesystem::path findAssociationFile(const std::filesystem::path& folder);

struct Associations {
  std::vector<FrameFiles> frames;  ///< stamped with the depth image's stamp
  bool depth_first = false;
};

/// Reads 'stamp file stamp file' lines of either column order, told apart by the word "depth" in the paths,
/// else by which image has 16 bits. Malformed lines are skipped with a warning; throws InputError when no
/// line is good or the order cannot be told.
Associations readAssociations(const std::filesystem::path& file, std::vector<std::string>& warnings);

/// True when all stamps are whole numbers a few apart: frame numbers rather than seconds.
bool stampsAreFrameNumbers(const std::vector<FrameFiles>& frames);
/// Where they are, sets the listing's seconds_per_stamp and says so.
void recogniseFrameNumbers(Listing& listing);

}  // namespace rosefusion::datasets
