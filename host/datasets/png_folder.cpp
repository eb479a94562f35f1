// Any folder of PNGs, described by a sequence.yaml that lies in it.
#include <fnmatch.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>
#include <set>

#include "host/core/error.h"
#include "host/core/number_text.h"
#include "host/core/text_file.h"
#include "host/datasets/association.h"
#include "host/datasets/listing.h"
#include "host/datasets/text_table.h"
#include "host/datasets/truth.h"

namespace rosefusion::datasets {
namespace {

namespace fs = std::filesystem;

/// Orders image9 before image10: runs of digits compare as numbers.
bool naturalLess(const std::string& a, const std::string& b) {
  const auto digit = [](char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; };
  std::size_t i = 0, j = 0;
  while (i < a.size() && j < b.size()) {
    if (!digit(a[i]) || !digit(b[j])) {
      if (a[i] != b[j]) return a[i] < b[j];
      ++i, ++j;
      continue;
    }
    while (i + 1 < a.size() && a[i] == '0' && digit(a[i + 1])) ++i;
    while (j + 1 < b.size() && b[j] == '0' && digit(b[j + 1])) ++j;
    std::size_t end_i = i, end_j = j;
    while (end_i < a.size() && digit(a[end_i])) ++end_i;
    while (end_j < b.size() && digit(b[end_j])) ++end_j;
    if (end_i - i != end_j - j) return end_i - i < end_j - j;
    if (const int order = a.compare(i, end_i - i, b, j, end_j - j); order != 0) return order < 0;
    i = end_i, j = end_j;
  }
  return a.size() - i < b.size() - j;
}

/// Files that match a pattern such as depth/*.png (wildcards in the last part only), in natural order.
std::vector<fs::path> filesMatching(const fs::path& folder, const std::string& pattern,
                                    const fs::path& yaml) {
  const fs::path full = folder / pattern;
  std::vector<fs::path> files;
  std::error_code ignored;
  if (fs::is_directory(full, ignored)) {
    const std::string inside = (fs::path(pattern) / "").parent_path() / "*.png";
    throw InputError(yaml.string() + ": '" + pattern + "' is a folder; name the images in it, such as '" +
                     inside + "'.");
  }
  for (const auto& entry : fs::directory_iterator(full.parent_path(), ignored))
    if (fnmatch(full.filename().c_str(), entry.path().filename().c_str(), FNM_PERIOD) == 0)
      files.push_back(entry.path());
  std::sort(files.begin(), files.end(), [](const fs::path& a, const fs::path& b) {
    return naturalLess(a.filename().string(), b.filename().string());
  });
  if (files.empty())
    throw InputError(yaml.string() + ": no file matches '" + pattern +
                     "'; correct the pattern (wildcards in the file name only).");
  return files;
}

constexpr const char* kShape =
    "a complete file has 'intrinsics: {fx: .., fy: .., cx: .., cy: ..}', 'depth_units_per_metre: 1000', "
    "'depth: depth/*.png' and 'fps: 30'";

/// The value of a key, converted. Throws InputError naming the key when it is missing or malformed.
template <typename T>
T valueOf(const YAML::Node& node, const std::string& key, const fs::path& yaml) {
  if (!node[key]) throw InputError(yaml.string() + ": '" + key + "' is missing; " + kShape + ".");
  try {
    return node[key].as<T>();
  } catch (const YAML::Exception&) {
    throw InputError(yaml.string() + ": the value of '" + key + "' has the wrong type; " + kShape + ".");
  }
}

/// The same for a number, which YAML may write as .nan or .inf too.
double numberIn(const YAML::Node& node, const std::string& key, const fs::path& yaml) {
  std::string text = valueOf<std::string>(node, key, yaml);
  for (const char* special : {".nan", ".inf", "-.inf"})
    if (lowered(text) == special) text.erase(text.find('.'), 1);
  const std::optional<double> number = rosefusion::parseNumber(text);
  if (!number)
    throw InputError(yaml.string() + ": the value of '" + key + "' has the wrong type ('" + text +
                     "' is no number; decimals take a point); " + kShape + ".");
  return *number;
}

int sizeIn(const YAML::Node& node, const std::string& key, const fs::path& yaml) {
  const double size = numberIn(node, key, yaml);
  if (!(size >= 1 && size <= 1e6) || size != std::floor(size))
    throw InputError(yaml.string() + ": '" + key + "' must be a whole number of pixels.");
  return static_cast<int>(size);
}

void refuseUnknownKeys(const YAML::Node& node, const std::set<std::string>& known, const fs::path& yaml) {
  std::string names;
  for (const std::string& name : known) names += (names.empty() ? "" : ", ") + name;
  if (!node.IsMap()) throw InputError(yaml.string() + ": expected a map with the keys " + names + ".");
  for (const auto& entry : node)
    if (const auto key = entry.first.as<std::string>("(no text)"); !known.contains(key))
      throw InputError(yaml.string() + ": unknown key '" + key + "'; known are " + names + ".");
}

/// The number a file is named after: 1305031229.528784.png -> 1305031229.528784.
double stampFromName(const fs::path& file, const fs::path& yaml) {
  double stamp = 0;
  if (!parseNumber(file.stem().string(), stamp) || !std::isfinite(stamp))
    throw InputError(yaml.string() +
                     ": 'timestamps: names' needs files named after their time in seconds, but there is " +
                     file.string() + "; give 'fps' instead.");
  return stamp;
}

/// All digits of a file's name, each run of them without leading zeros: what tells images of one folder
/// apart.
std::string numberOfName(const fs::path& file) {
  std::string number;
  bool in_run = false;
  for (const char c : file.stem().string()) {
    const bool digit = c >= '0' && c <= '9';
    if (digit && !in_run && !number.empty()) number += '.';
    if (digit && in_run && number.ends_with('0') && (number.size() == 1 || number[number.size() - 2] == '.'))
      number.pop_back();
    if (digit) number += c;
    in_run = digit;
  }
  return number;
}

/// The colour image of each depth image: the one of the same number, where the names have numbers in common;
/// else the images are paired in order.
std::vector<fs::path> partnersOf(const std::vector<fs::path>& depth, const std::vector<fs::path>& colour,
                                 const fs::path& yaml, std::vector<std::string>& warnings) {
  std::map<std::string, fs::path> by_number;
  for (const fs::path& file : colour) by_number[numberOfName(file)] = file;
  std::vector<fs::path> partners(depth.size());
  std::set<std::string> numbers;
  std::size_t paired = 0;
  for (std::size_t i = 0; i < depth.size(); ++i) {
    const std::string number = numberOfName(depth[i]);
    numbers.insert(number);
    const auto found = by_number.find(number);
    if (number.empty() || found == by_number.end()) continue;
    partners[i] = found->second;
    ++paired;
  }
  const bool unique = numbers.size() == depth.size() && by_number.size() == colour.size();
  if (!unique || 2 * paired < std::min(depth.size(), colour.size())) {
    if (colour.size() == depth.size()) return colour;
    throw InputError(
        yaml.string() + ": " + std::to_string(depth.size()) + " depth but " + std::to_string(colour.size()) +
        " colour images; they are paired in order, so remove those without a partner, or name both by "
        "one number.");
  }
  if (paired < std::max(depth.size(), colour.size()))
    warnings.push_back(
        yaml.string() + ": " + std::to_string(depth.size() - paired) + " depth and " +
        std::to_string(colour.size() - paired) +
        " colour images have no partner of their number; those depth images are taken without colour.");
  return partners;
}

bool matchesPngFolder(const fs::path& folder) {
  return fs::is_regular_file(folder / "sequence.yaml");
}

Listing listPngFolder(const fs::path& folder) {
  const fs::path yaml = folder / "sequence.yaml";
  YAML::Node node;
  try {
    node = YAML::Load(readTextFile(yaml));
  } catch (const YAML::Exception& error) {
    throw InputError(yaml.string() + ": not valid YAML (" + error.what() + ").");
  }
  refuseUnknownKeys(
      node, {"intrinsics", "depth_units_per_metre", "fps", "timestamps", "depth", "colour", "trajectory"},
      yaml);
  Listing listing{.format = kPngFolderReader.format, .path = folder};
  const auto camera = valueOf<YAML::Node>(node, "intrinsics", yaml);
  refuseUnknownKeys(camera, {"fx", "fy", "cx", "cy", "width", "height"}, yaml);
  Intrinsics& k = listing.camera.values;
  k.fx = numberIn(camera, "fx", yaml);
  k.fy = numberIn(camera, "fy", yaml);
  k.cx = numberIn(camera, "cx", yaml);
  k.cy = numberIn(camera, "cy", yaml);
  if (camera["width"]) k.width = sizeIn(camera, "width", yaml);
  if (camera["height"]) k.height = sizeIn(camera, "height", yaml);
  listing.camera.source = yaml.string();
  listing.depth_units_assumed = false;
  listing.depth_units_per_metre = numberIn(node, "depth_units_per_metre", yaml);

  const auto depth = filesMatching(folder, valueOf<std::string>(node, "depth", yaml), yaml);
  std::vector<fs::path> colour(depth.size());
  if (node["colour"])
    colour = partnersOf(depth, filesMatching(folder, valueOf<std::string>(node, "colour", yaml), yaml), yaml,
                        listing.warnings);
  const bool stamps_from_names =
      node["timestamps"] && valueOf<std::string>(node, "timestamps", yaml) == "names";
  if (node["timestamps"] && !stamps_from_names)
    throw InputError(yaml.string() +
                     ": 'timestamps' can only be 'names'; leave it out and give 'fps' instead.");
  const double fps = stamps_from_names ? 1 : numberIn(node, "fps", yaml);
  if (!std::isfinite(fps) || fps <= 0) throw InputError(yaml.string() + ": 'fps' must be a number above 0.");
  for (std::size_t i = 0; i < depth.size(); ++i)
    listing.frames.push_back(
        {stamps_from_names ? stampFromName(depth[i], yaml) : static_cast<double>(i) / fps, depth[i],
         colour[i]});

  if (stamps_from_names) recogniseFrameNumbers(listing);
  if (node["trajectory"]) {
    const fs::path file = folder / valueOf<std::string>(node, "trajectory", yaml);
    if (!fs::is_regular_file(file))
      throw InputError(yaml.string() + ": 'trajectory' names " + file.string() + ", which is missing.");
    listing.truth = readTruth(file, listing.warnings);
  }
  return listing;
}

}  // namespace

const Reader kPngFolderReader{"PNG folder", "sequence.yaml (any folder of PNGs)", matchesPngFolder,
                              listPngFolder};

}  // namespace rosefusion::datasets
