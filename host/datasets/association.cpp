#include "host/datasets/association.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include "host/core/error.h"
#include "host/core/number_text.h"
#include "host/datasets/image_file.h"
#include "host/datasets/text_table.h"

namespace rosefusion::datasets {
namespace {

bool mentionsDepth(const std::string& path) {
  return lowered(path).find("depth") != std::string::npos;
}

bool isDepthImage(const std::filesystem::path& file) {
  cv::Mat image;
  std::string problem;
  return readDepthImage(file, {}, image, problem);
}

struct StampedPair {
  double stamp[2] = {};
  std::string file[2];
};

/// 'stamp file stamp file'. Names may hold blanks where such files are there.
std::optional<StampedPair> pairOf(const TextRow& row, const std::filesystem::path& folder) {
  std::optional<StampedPair> found;
  for (std::size_t second = 2; second + 1 < row.fields.size(); ++second) {
    StampedPair pair;
    const bool stamped = parseNumber(row.fields[0], pair.stamp[0]) &&
                         parseNumber(row.fields[second], pair.stamp[1]) && std::isfinite(pair.stamp[0]) &&
                         std::isfinite(pair.stamp[1]);
    if (!stamped) continue;
    pair.file[0] = row.span(1, second - 1);
    pair.file[1] = row.span(second + 1, row.fields.size() - 1);
    const bool there =
        std::filesystem::exists(folder / pair.file[0]) && std::filesystem::exists(folder / pair.file[1]);
    if (row.fields.size() == 4 || there) found = pair;
  }
  return found;
}

}  // namespace

std::vector<std::optional<std::size_t>> associateNearest(const std::vector<double>& from,
                                                         const std::vector<double>& to,
                                                         double max_difference) {
  std::vector<std::size_t> order(to.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return to[a] < to[b]; });
  std::vector<std::optional<std::size_t>> nearest(from.size());
  for (std::size_t i = 0; i < from.size(); ++i) {
    const auto after = std::lower_bound(order.begin(), order.end(), from[i],
                                        [&](std::size_t index, double time) { return to[index] < time; });
    double best = max_difference;
    for (auto candidate : {after, after == order.begin() ? after : after - 1}) {
      if (candidate == order.end() || std::abs(to[*candidate] - from[i]) > best) continue;
      best = std::abs(to[*candidate] - from[i]);
      nearest[i] = *candidate;
    }
  }
  return nearest;
}

std::filesystem::path findAssociationFile(const std::filesystem::path& folder) {
  for (const char* name : {"associations.txt", "associated.txt", "associate.txt", "association.txt"})
    if (std::filesystem::is_regular_file(folder / name)) return folder / name;
  return {};
}

Associations readAssociations(const std::filesystem::path& file, std::vector<std::string>& warnings) {
  const std::filesystem::path folder = file.parent_path();
  std::string first;
  std::size_t skipped = 0;
  std::vector<StampedPair> rows;
  for (const TextRow& row : readTextTable(file).rows) {
    std::optional<StampedPair> pair = pairOf(row, folder);
    if (pair && (isHidden(pair->file[0]) || isHidden(pair->file[1]))) continue;
    if (pair)
      rows.push_back(std::move(*pair));
    else if (skipped++ == 0)
      first = "line " + std::to_string(row.line) + " is not 'timestamp file timestamp file'";
  }
  if (rows.empty())
    throw InputError(file.string() +
                     ": lists no images; each line should read 'timestamp file timestamp file'.");
  if (skipped > 0) warnings.push_back(skippedLines(file, skipped, first));

  const std::string &left = rows[0].file[0], &right = rows[0].file[1];
  bool left_is_depth = mentionsDepth(left), right_is_depth = mentionsDepth(right);
  if (left_is_depth == right_is_depth) {
    left_is_depth = isDepthImage(folder / left);
    right_is_depth = isDepthImage(folder / right);
  }
  if (left_is_depth == right_is_depth)
    throw InputError(file.string() +
                     ": cannot tell which column is the depth image; put the images in folders named "
                     "'depth' and 'rgb'.");
  Associations result;
  result.depth_first = left_is_depth;
  const std::size_t d = left_is_depth ? 0 : 1, c = 1 - d;
  for (const StampedPair& row : rows)
    result.frames.push_back({row.stamp[d], folder / row.file[d], folder / row.file[c]});
  return result;
}

bool stampsAreFrameNumbers(const std::vector<FrameFiles>& frames) {
  constexpr double kLargest = 1e9;  // larger ones are seconds since 1970
  if (frames.size() < 2) return false;
  std::set<double> stamps;
  for (const FrameFiles& f : frames) {
    if (f.timestamp != std::floor(f.timestamp) || std::abs(f.timestamp) >= kLargest) return false;
    stamps.insert(f.timestamp);
  }
  const auto count = static_cast<double>(frames.size());
  // Stamps whose decimals were lost repeat; numbers that were left out leave gaps.
  return static_cast<double>(stamps.size()) > 0.5 * count && *stamps.rbegin() - *stamps.begin() < 10 * count;
}

void recogniseFrameNumbers(Listing& listing) {
  if (!stampsAreFrameNumbers(listing.frames)) return;
  listing.seconds_per_stamp = 1 / kFramesPerSecond;
  listing.notes.push_back("time stamps are frame numbers, kept as they are; 30 frames per second assumed");
}

}  // namespace rosefusion::datasets
