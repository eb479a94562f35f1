#include "host/core/trajectory.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>
#include <system_error>

#include "host/core/error.h"
#include "host/core/file_io.h"
#include "host/core/number_text.h"
#include "host/core/text_file.h"

namespace rosefusion {

Trajectory readTumTrajectory(const std::filesystem::path& file, bool* was_unsorted,
                             std::vector<std::string>* skipped) {
  std::error_code unknown;
  if (std::filesystem::is_directory(file, unknown))
    throw InputError(file.string() + ": is a folder; give a trajectory file in TUM format.");
  if (!std::filesystem::exists(file, unknown))
    throw InputError(file.string() + ": cannot be opened; give a trajectory file in TUM format.");
  std::istringstream in(readTextFile(file));
  Trajectory trajectory;
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    const auto begin = line.find_first_not_of(" \t\r");
    if (begin == std::string::npos || line[begin] == '#') continue;
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream fields(line);
    double v[8];
    bool good = true;
    for (double& value : v) {
      std::string token;  // not read as a number: operator>> refuses "nan", which deserves its own words
      good = good && (fields >> token);
      const std::optional<double> read = good ? parseNumber(token) : std::nullopt;
      good = read.has_value();
      value = read.value_or(0);
    }
    std::string surplus;
    good = good && !(fields >> surplus);  // longer lines are another format, such as KITTI's 3x4 matrices
    const std::string where = file.string() + ":" + std::to_string(number);
    const Eigen::Quaterniond q(v[7], v[4], v[5], v[6]);
    std::string problem;
    if (!good)
      problem = ": not a TUM pose; expected 't tx ty tz qx qy qz qw', with decimal points.";
    else if (!std::all_of(v, v + 8, [](double x) { return std::isfinite(x); }))
      problem = ": the pose has a number that is not finite; remove the line.";
    else if (q.norm() < 1e-6)
      problem = ": the quaternion is zero; remove the line.";
    if (!problem.empty()) {
      if (!skipped) throw InputError(where + problem);
      skipped->push_back(where + problem);
      continue;
    }
    Pose pose = Pose::Identity();
    pose.linear() = q.normalized().toRotationMatrix();
    pose.translation() = Eigen::Vector3d(v[1], v[2], v[3]);
    trajectory.push_back({v[0], pose});
  }
  const auto earlier = [](const StampedPose& a, const StampedPose& b) { return a.timestamp < b.timestamp; };
  const bool sorted = std::is_sorted(trajectory.begin(), trajectory.end(), earlier);
  if (!sorted) std::stable_sort(trajectory.begin(), trajectory.end(), earlier);
  if (was_unsorted) *was_unsorted = !sorted;
  return trajectory;
}

std::size_t repeatedStamps(const Trajectory& trajectory) {
  std::size_t repeated = 0;
  for (std::size_t i = 1; i < trajectory.size(); ++i)
    if (trajectory[i].timestamp == trajectory[i - 1].timestamp) ++repeated;
  return repeated;
}

void writeTumTrajectory(const std::filesystem::path& file, const Trajectory& trajectory) {
  TextStream text;
  text << "# timestamp tx ty tz qx qy qz qw (camera to world, metres)\n" << std::fixed;
  for (const StampedPose& p : trajectory) {
    const Eigen::Quaterniond q = canonical(Eigen::Quaterniond(p.world_from_camera.linear()));
    const Eigen::Vector3d t = p.world_from_camera.translation();
    text << std::setprecision(6) << p.timestamp << std::setprecision(9) << ' ' << t.x() << ' ' << t.y() << ' '
         << t.z() << ' ' << q.x() << ' ' << q.y() << ' ' << q.z() << ' ' << q.w() << '\n';
  }
  writeFileAtomically(file, text.str());
}

bool interpolate(const Trajectory& trajectory, double t, double max_gap, Pose& world_from_camera) {
  const auto after = std::lower_bound(trajectory.begin(), trajectory.end(), t,
                                      [](const StampedPose& p, double time) { return p.timestamp < time; });
  if (after == trajectory.end() || after == trajectory.begin()) {
    if (trajectory.empty()) return false;
    const StampedPose& end = after == trajectory.end() ? trajectory.back() : trajectory.front();
    world_from_camera = end.world_from_camera;
    return std::abs(end.timestamp - t) <= max_gap;
  }
  const StampedPose &a = *(after - 1), &b = *after;
  const double gap = b.timestamp - a.timestamp;
  if (gap > max_gap && t != b.timestamp) return false;
  const double s = gap > 0 ? (t - a.timestamp) / gap : 1;
  world_from_camera = Pose::Identity();
  const Eigen::Quaterniond qa(a.world_from_camera.linear()), qb(b.world_from_camera.linear());
  world_from_camera.linear() = qa.slerp(s, qb).toRotationMatrix();
  world_from_camera.translation() =
      (1 - s) * a.world_from_camera.translation() + s * b.world_from_camera.translation();
  return true;
}

}  // namespace rosefusion
