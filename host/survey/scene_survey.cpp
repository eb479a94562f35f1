#include "host/survey/scene_survey.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace rosefusion {
namespace {

constexpr int kPixelStep = 4;               // for the distribution of depths
constexpr double kLeastValid = 0.002;       // share of the pixels
constexpr double kBeside = 0.05;            // of the valid pixels, on each side of what is taken as the view
constexpr int kPiecesAcross = 20;           // that planes are fitted to, over the width of what has depth
constexpr int kLeastSide = 8;               // of a piece, pixels
constexpr double kLeastCovered = 0.2;       // of a piece
constexpr std::size_t kLeastPieces = 20;    // of one depth
constexpr double kDepthsOfOne = 1.4142136;  // factor between the ends of one depth's bin
constexpr double kFlattest = 0.25;          // quantile: the others may be curved, or hold an edge

double quantile(std::vector<double>& values, double share) {
  const auto at =
      values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// Of the plane in inverse depth through a piece of the image: its mean depth, and what the depths differ
/// from it by.
std::optional<SceneMeasures::Deviation> deviationOf(const cv::Mat& metres) {
  Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
  Eigen::Vector3d with = Eigen::Vector3d::Zero();
  double n = 0, sum = 0, sum_of_squares = 0;
  for (int v = 0; v < metres.rows; ++v)
    for (int u = 0; u < metres.cols; ++u) {
      const double z = metres.at<float>(v, u);
      if (z <= 0) continue;
      const Eigen::Vector3d row(1, u - 0.5 * metres.cols, v - 0.5 * metres.rows);
      squares += row * row.transpose();
      with += row / z;
      sum += 1 / z;
      sum_of_squares += 1 / (z * z);
      ++n;
    }
  if (n < std::max(8.0, kLeastCovered * metres.rows * metres.cols)) return {};
  const Eigen::LDLT<Eigen::Matrix3d> solver(squares);
  if (solver.rcond() < 1e-9) return {};
  const double left = sum_of_squares - with.dot(solver.solve(with)), z = n / sum;
  return SceneMeasures::Deviation{z, std::sqrt(std::max(left, 0.0) / (n - 3)) * z * z};
}

std::vector<SceneMeasures::Deviation> flatDeviations(std::vector<SceneMeasures::Deviation> pieces) {
  std::sort(pieces.begin(), pieces.end(), [](const auto& a, const auto& b) { return a.depth < b.depth; });
  std::vector<SceneMeasures::Deviation> flat;
  for (auto first = pieces.begin(); first != pieces.end();) {
    const auto last = std::find_if(
        first, pieces.end(), [&](const auto& piece) { return piece.depth > kDepthsOfOne * first->depth; });
    std::vector<double> depths, deviations;
    for (auto piece = first; piece != last; ++piece) {
      depths.push_back(piece->depth);
      deviations.push_back(piece->deviation / (piece->depth * piece->depth));  // about alike within the bin
    }
    if (depths.size() >= kLeastPieces)
      if (const double z = quantile(depths, 0.5), share = quantile(deviations, kFlattest); share > 0)
        flat.push_back({z, share * z * z});
    first = last;
  }
  return flat;
}

}  // namespace

std::optional<SceneMeasures> surveyScene(std::span<const cv::Mat> depths, const Intrinsics& camera,
                                         double depth_units_per_metre, const DepthSettings& range) {
  std::vector<double> distances, columns;
  std::vector<cv::Mat> images;
  std::size_t looked_at = 0;
  for (const cv::Mat& depth : depths) {
    cv::Mat& metres = images.emplace_back();
    depth.convertTo(metres, CV_32F, 1 / depth_units_per_metre);
    metres.setTo(0, (metres < range.min) | (metres > range.max) | (depth == 65535));
    for (int v = 0; v < metres.rows; v += kPixelStep)
      for (int u = 0; u < metres.cols; u += kPixelStep, ++looked_at)
        if (const float z = metres.at<float>(v, u); z > 0) {
          distances.push_back(z);
          columns.push_back(u);
        }
  }
  if (distances.empty() ||
      static_cast<double>(distances.size()) < kLeastValid * static_cast<double>(looked_at))
    return {};
  SceneMeasures scene;
  scene.valid_share = static_cast<double>(distances.size()) / static_cast<double>(looked_at);
  scene.median_depth = quantile(distances, 0.5);
  scene.far_depth = quantile(distances, 0.9);
  const double pixels = (quantile(columns, 1 - kBeside) - quantile(columns, kBeside)) / (1 - 2 * kBeside);
  scene.view_width = pixels / camera.fx;
  scene.pixel_width = 1 / camera.fx;
  scene.phone = std::minmax(camera.width, camera.height) == std::minmax(256, 192);
  // Of a thing that covers little of the image, larger pieces would hold its shape and not the noise.
  std::vector<SceneMeasures::Deviation> pieces;
  const int side = std::max(kLeastSide, static_cast<int>(pixels) / kPiecesAcross);
  for (const cv::Mat& metres : images)
    for (int v = 0; v + side <= metres.rows; v += side)
      for (int u = 0; u + side <= metres.cols; u += side)
        if (const auto piece = deviationOf(metres(cv::Rect(u, v, side, side)))) pieces.push_back(*piece);
  scene.flat = flatDeviations(std::move(pieces));
  return scene;
}

}  // namespace rosefusion
