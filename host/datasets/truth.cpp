#include "host/datasets/truth.h"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

namespace rosefusion::datasets {

Trajectory readTruth(const std::filesystem::path& file, std::vector<std::string>& warnings) {
  if (!std::filesystem::is_regular_file(file)) return {};
  bool was_unsorted = false;
  std::vector<std::string> skipped;
  Trajectory truth = readTumTrajectory(file, &was_unsorted, &skipped);
  if (was_unsorted)
    warnings.push_back(file.string() + ": the truth's time stamps are not ascending; they were sorted.");
  if (const std::size_t doubled = repeatedStamps(truth); doubled > 0)
    warnings.push_back(
        file.string() + ": " + std::to_string(doubled) +
        " truth poses have the time stamp of the one before; write one pose for each time, with six "
        "decimals.");
  if (!skipped.empty())
    warnings.push_back(std::to_string(skipped.size()) +
                       (skipped.size() == 1 ? " truth pose" : " truth poses") +
                       " skipped, the first: " + skipped[0]);
  if (truth.empty()) warnings.push_back(file.string() + ": holds no pose; the truth counts as unknown.");
  return truth;
}

bool poseFromMatrix(const std::vector<double>& m, Pose& pose) {
  constexpr double kTolerance = 0.05;
  if (m.size() != 16 || !std::all_of(m.begin(), m.end(), [](double x) { return std::isfinite(x); }))
    return false;
  Eigen::Matrix4d matrix;
  for (int i = 0; i < 16; ++i) matrix(i / 4, i % 4) = m[static_cast<std::size_t>(i)];
  const Eigen::Matrix3d linear = matrix.topLeftCorner<3, 3>();
  if ((matrix.row(3) - Eigen::RowVector4d(0, 0, 0, 1)).norm() > kTolerance) return false;
  if ((linear * linear.transpose() - Eigen::Matrix3d::Identity()).norm() > kTolerance ||
      linear.determinant() < 0)
    return false;
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(linear, Eigen::ComputeFullU | Eigen::ComputeFullV);
  pose = Pose::Identity();
  pose.linear() = svd.matrixU() * svd.matrixV().transpose();
  pose.translation() = matrix.topRightCorner<3, 1>();
  return true;
}

}  // namespace rosefusion::datasets
