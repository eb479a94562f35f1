#include "host/evaluation/trajectory_plot.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <iomanip>
#include <sstream>

#include "host/core/error.h"
#include "host/core/number_text.h"
#include "host/evaluation/plot.h"

namespace rosefusion {
namespace {

/// The two axes along which the true positions extend most, in the order x, y, z.
std::array<int, 2> widestAxes(const TrajectoryErrors& errors) {
  Eigen::AlignedBox3d box;
  for (const FrameError& f : errors.per_frame) box.extend(f.poses.truth.translation());
  int narrowest = 0;
  box.sizes().minCoeff(&narrowest);
  return {narrowest == 0 ? 1 : 0, narrowest == 2 ? 1 : 2};
}

/// Columns: the true position on two axes, from the first common pose to the last.
std::string truthTable(const TrajectoryErrors& errors, const Trajectory& truth,
                       const std::array<int, 2>& axes) {
  const PosePair &first = errors.per_frame.front().poses, &last = errors.per_frame.back().poses;
  TextStream rows;
  rows << std::setprecision(9);
  const auto add = [&](const Pose& p) {
    rows << p.translation()[axes[0]] << ' ' << p.translation()[axes[1]] << '\n';
  };
  add(first.truth);
  for (const StampedPose& p : truth)
    if (p.timestamp > first.timestamp && p.timestamp < last.timestamp) add(p.world_from_camera);
  add(last.truth);
  return rows.str();
}

/// Columns: seconds since the first common pose, aligned position on two axes, ATE and TE in centimetres.
/// A blank line where frames are missing breaks the lines drawn through the rows.
std::string errorTable(const TrajectoryErrors& errors, const std::array<int, 2>& axes) {
  std::vector<double> gaps;
  for (std::size_t i = 1; i < errors.per_frame.size(); ++i)
    gaps.push_back(errors.per_frame[i].poses.timestamp - errors.per_frame[i - 1].poses.timestamp);
  std::sort(gaps.begin(), gaps.end());
  const double break_s = gaps.empty() ? 0 : 4 * gaps[gaps.size() / 2];
  TextStream rows;
  rows << std::setprecision(9);
  const double start_s = errors.per_frame.front().poses.timestamp;
  double last_s = start_s;
  for (const FrameError& f : errors.per_frame) {
    if (f.poses.timestamp - last_s > break_s) rows << '\n';
    last_s = f.poses.timestamp;
    const Eigen::Vector3d estimate = errors.alignment.truth_from_estimate * f.poses.estimate.translation();
    rows << last_s - start_s << ' ' << estimate[axes[0]] << ' ' << estimate[axes[1]] << ' ' << 100 * f.ate_m
         << ' ' << 100 * f.te_m << '\n';
  }
  return rows.str();
}

}  // namespace

void plotTrajectoryErrors(const TrajectoryErrors& errors, const Trajectory& truth, const std::string& title,
                          const std::filesystem::path& png) {
  if (errors.per_frame.empty())
    throw InputError(png.string() + ": there is nothing to draw; estimate and truth have no pose in common.");
  const std::array<int, 2> axes = widestAxes(errors);
  Plot plot;
  plot.tables["truth.dat"] = truthTable(errors, truth, axes);
  plot.tables["errors.dat"] = errorTable(errors, axes);
  TextStream commands;
  commands << "set multiplot layout 1,2 title " << plotQuoted(title) << " font \"sans,18\"\n"
           << "set key outside top center horizontal\n"
           << "set size ratio -1\n"
           << "set xlabel \""
           << "xyz"[axes[0]] << " (m)\"\nset ylabel \""
           << "xyz"[axes[1]] << " (m)\"\n"
           << "plot \"truth.dat\" with lines linetype 1 title \"truth\", "
           << "\"errors.dat\" using 2:3 with lines linetype 2 title \"estimate, aligned\"\n"
           << "set size noratio\nset yrange [0:*]\n"
           << "set xlabel \"time (s)\"\nset ylabel \"error (cm)\"\n"
           << std::fixed << std::setprecision(2)
           << "plot \"errors.dat\" using 1:5 with lines linetype 3 title \"TE " << 100 * errors.te_m.rmse
           << " cm (RMSE)\", \"\" using 1:4 with lines linetype 2 title \"ATE " << 100 * errors.ate_m.rmse
           << " cm (RMSE)\"\n";
  plot.commands = commands.str();
  renderPlot(plot, png);
}

}  // namespace rosefusion
