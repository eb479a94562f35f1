// Figures plot-2d-opt and plot-3d-opt: the search for one frame's pose, seen from inside.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "host/experiments/families.h"
#include "host/experiments/frame_study.h"
#include "host/experiments/runs.h"
#include "host/slam/shader_types.h"
#include "host/swarm/random.h"

namespace rosefusion {
namespace {

constexpr int kShown[] = {1, 2, 3, 4, 6, 10};  // iterations
constexpr std::size_t kDots = 350;             // particles drawn of each iteration
constexpr int kSide = 41;                      // samples of the landscape along an axis
const std::vector<std::string> kMethods = {"pfo", "pso", "pst"};

/// (metres, quaternion's imaginary part) from the true pose to this one.
Vector6 offTruth(const Pose& pose, const Pose& truth) {
  const Eigen::Quaterniond turn(Eigen::Matrix3d(pose.linear() * truth.linear().transpose()));
  Vector6 out;
  out << pose.translation() - truth.translation(), (turn.w() < 0 ? -1 : 1) * turn.vec();
  return out;
}

/// Sparse random projection from 6-D (Li, Hastie and Church 2006, s = 3): entries +-sqrt(3) with probability
/// 1/6 each, else 0; every column has one.
Eigen::Matrix<double, 2, 6> sparseProjection(std::uint64_t seed) {
  PortableRandom random(seed);
  Eigen::Matrix<double, 2, 6> out;
  do {
    for (int row = 0; row < 2; ++row)
      for (int column = 0; column < 6; ++column) {
        const auto die = random.below(6);
        out(row, column) = die == 0 ? std::sqrt(3.0) : die == 1 ? -std::sqrt(3.0) : 0;
      }
  } while ((out.cwiseAbs().colwise().sum().array() == 0).any() || std::abs(out.row(0).dot(out.row(1))) > 3.5);
  return out;
}

struct Iteration {
  std::vector<Vector6> particles;  ///< off the truth
  std::vector<double> losses;
  Vector6 centre, axis_lengths;
};

std::vector<Iteration> watch(StudiedMethod& method, const StudiedFrame& studied) {
  std::vector<Iteration> all;
  method.search(studied, [&](const SearchIteration& it) {
    Iteration& seen = all.emplace_back();
    seen.centre = offTruth(it.state.centre, studied.truth);
    seen.axis_lengths = it.state.axis_lengths;
    const std::size_t step = std::max<std::size_t>(1, it.losses.size() / kDots);
    for (std::size_t i = 0; i < it.losses.size(); i += step)
      if (it.losses[i] >= 0) {
        seen.particles.push_back(offTruth(it.pose(i), studied.truth));
        seen.losses.push_back(it.losses[i]);
      }
  });
  return all;
}

/// Largest distance from `centre` of what is shown, along both axes alike.
double reach(const std::vector<std::vector<Iteration>>& searches,
             const Eigen::Matrix<double, 2, 6>& projection) {
  std::vector<double> sizes;
  for (const auto& search : searches)
    for (const Vector6& p : search.front().particles) sizes.push_back((projection * p).cwiseAbs().maxCoeff());
  std::sort(sizes.begin(), sizes.end());
  return 1.15 * sizes[sizes.size() * 98 / 100];
}

void plotParticles(ResultWriter& out, const std::vector<std::vector<Iteration>>& searches,
                   std::uint64_t seed) {
  const Eigen::Matrix<double, 2, 6> projection = sparseProjection(seed);
  const double limit = reach(searches, projection);
  Table table({"method", "iteration", "u", "v", "loss"});
  Plot plot;
  plot.width_px = 2000;
  plot.height_px = 1050;
  plot.commands = fmt::format(
      "set multiplot layout {0},{1} margins 0.05,0.92,0.08,0.95 spacing 0.025,0.17\nset key off\nset palette "
      "defined (0 \"#10243f\", 0.5 "
      "\"#4f9d93\", 1 "
      "\"#f4e9a6\")\nset cbrange [0.2:1]\nset xrange [-{2:.4f}:{2:.4f}]\nset yrange [-{2:.4f}:{2:.4f}]\nset "
      "xtics {3}\nset ytics {3}\nset "
      "format cb \"%.1f\"\n",
      kMethods.size(), std::size(kShown), limit, limit > 0.5 ? 0.5 : 0.2);
  for (std::size_t m = 0; m < kMethods.size(); ++m)
    for (const int shown : kShown) {
      const std::string file = fmt::format("{}_{}.dat", kMethods[m], shown);
      const bool there = static_cast<std::size_t>(shown) <= searches[m].size();
      const bool last = shown == kShown[std::size(kShown) - 1];
      Table dots({"u", "v", "loss"});
      if (there) {
        const Iteration& it = searches[m][static_cast<std::size_t>(shown - 1)];
        for (std::size_t i = 0; i < it.particles.size(); ++i) {
          const Eigen::Vector2d at = projection * it.particles[i];
          dots.add({at.x(), at.y(), it.losses[i]});
          table.add({kMethods[m], double(shown), at.x(), at.y(), it.losses[i]});
        }
      } else {
        dots.add({10 * limit, 10 * limit, 0.0});
      }
      plot.tables[file] = dots.plotData();
      plot.commands += fmt::format(
          "set title {}\nset xlabel \"u (m, or half radians)\"\nset ylabel {}\n{}set cblabel \"loss, mean "
          "|psi|\"\nplot \"{}\" using 1:2:3 "
          "with points pointtype 7 pointsize 0.5 palette, \"-\" with points pointtype 2 pointsize 2.5 "
          "linewidth 2 linecolor rgb "
          "\"#c01830\"\n0 0\ne\n",
          plotQuoted(fmt::format("{}, iteration {}{}", kMethods[m], shown, there ? "" : ": had ended")),
          plotQuoted(shown == 1 ? "v (m, or half radians)" : ""),
          last ? "set colorbox user origin screen 0.94,0.2 size screen 0.012,0.6\n" : "unset colorbox\n",
          file);
    }
  out.table("particles", table);
  out.plot("particles", plot,
           "The particles of one frame's search in a 2-D sparse random projection of the 6-D pose around the "
           "true one (cross); dark: "
           "low loss. Each point is one particle.");
}

/// The swarm of some iterations as ellipsoids: axes are the reach in x, y, z, shades that of the turns about
/// them.
void plotEllipsoids(ResultWriter& out, const std::vector<Iteration>& search) {
  Table table({"iteration", "x_m", "y_m", "z_m", "qx", "qy", "qz"});
  for (std::size_t i = 0; i < search.size(); ++i) {
    const Vector6& r = search[i].axis_lengths;
    table.add({double(i + 1), r[0], r[1], r[2], r[3], r[4], r[5]});
  }
  out.table("axis_lengths", table);
  Plot plot;
  plot.width_px = 1500;
  plot.height_px = 1200;
  plot.commands =
      "set multiplot layout 2,2\nset key off\nset palette defined (0 \"#10243f\", 0.5 \"#4f9d93\", 1 "
      "\"#f4e9a6\")\nset pm3d "
      "depthorder\nset view equal xyz\nset view 62,32\nset xyplane relative 0\nset border 127+256+512 "
      "linecolor "
      "rgb \"#a0a0a0\"\nset cblabel \"reach in "
      "turns (degrees)\" offset 1\nset xlabel \"x (cm)\" offset 0,-0.8\nset ylabel \"y (cm)\" offset "
      "1,-0.5\nset zlabel \"z (cm)\" rotate offset -1\nset xtics offset 0,-0.3\n"
      "set format \"%.2g\"\n";
  int drawn = 0;
  for (const int shown : kShown) {
    if (static_cast<std::size_t>(shown) > search.size() || drawn == 4) break;
    ++drawn;
    const Vector6& r = search[static_cast<std::size_t>(shown - 1)].axis_lengths;
    Table surface({"x", "y", "z", "turn"});
    for (int i = 0; i <= 24; ++i) {
      for (int j = 0; j <= 48; ++j) {
        const double latitude = std::numbers::pi * (i / 24.0 - 0.5),
                     longitude = 2 * std::numbers::pi * j / 48.0;
        const Eigen::Vector3d n(std::cos(latitude) * std::cos(longitude),
                                std::cos(latitude) * std::sin(longitude), std::sin(latitude));
        const double turn = std::sqrt((n.array().square() * r.tail<3>().array().square()).sum());
        surface.add({100 * n.x() * r[0], 100 * n.y() * r[1], 100 * n.z() * r[2],
                     2 * std::asin(std::min(1.0, turn)) * 180 / std::numbers::pi});
      }
      surface.addGap();
    }
    const std::string file = fmt::format("ellipsoid{}.dat", shown);
    plot.tables[file] = surface.plotData();
    const double limit = 105 * r.head<3>().maxCoeff(),
                 most = 2 * std::asin(std::min(1.0, r.tail<3>().maxCoeff()));
    const int column = (drawn - 1) % 2, row = (drawn - 1) / 2;
    plot.commands += fmt::format(
        "set title \"pst, iteration {0}\" offset 0,-1\nset xrange [-{2}:{2}]\nset yrange [-{2}:{2}]\nset "
        "zrange [-{2}:{2}]\nset xtics {3}\nset ytics {3}\nset ztics {3}\nset cbrange [0:{4}]\nset colorbox "
        "user origin screen {5},{6} size screen 0.015,0.25\nsplot \"{1}\" using 1:2:3:4 with pm3d\n",
        shown, file, limit, limit / 1.05, most * 180 / std::numbers::pi * 1.05, 0.41 + 0.5 * column,
        0.635 - 0.5 * row);
  }
  out.plot("ellipsoids", plot,
           "The template of one frame's search as an ellipsoid of its reach in x, y and z; shades: its reach "
           "in turns about each direction.");
}

/// The objective over the plane through the true pose, the first pose and the search's widest sideways step.
void plotLandscape(ResultWriter& out, const ExperimentContext& context, const Settings& settings,
                   const Intrinsics& intrinsics, const StudiedFrame& studied,
                   const std::vector<Iteration>& search) {
  const Vector6 u = search.front().centre.normalized();
  Vector6 v = Vector6::Zero();
  for (const Iteration& it : search) {
    const Vector6 off = it.centre - u * u.dot(it.centre);
    if (off.norm() > v.norm()) v = off;
  }
  if (v.norm() < 1e-6) v = Vector6::Unit(5) - u * u[5];
  v.normalize();
  const double reach = 1.6 * search.front().centre.norm();
  const auto offset = [&](int step) { return reach * (2.0 * step / (kSide - 1) - 1); };
  std::vector<glm::vec4> poses;
  for (int i = 0; i < kSide * kSide; ++i) {
    const double a = offset(i % kSide), b = offset(i / kSide);
    const Vector6 p = a * u + b * v;
    poses.emplace_back(p[0], p[1], p[2], 0);
    poses.emplace_back(p[3], p[4], p[5], 0);
  }
  ParticleEvaluator evaluator(context.device, settings, intrinsics, poses);
  evaluator.evaluate(studied.frame, studied.volume, {settings.swarm.levels.back().pixel_stride, 0, 0},
                     studied.truth, studied.last,
                     {toShader(studied.truth), glm::vec4(1), glm::vec4(1), 0, kSide * kSide});
  Table table({"u", "v", "loss"}), surface({"u", "v", "loss"}), path({"u", "v"}),
      path_table({"iteration", "u", "v", "off_plane"});
  for (int i = 0; i < kSide * kSide; ++i) {
    const double a = offset(i % kSide), b = offset(i / kSide);
    const double loss = evaluator.losses()[i] < 0 ? std::nan("") : evaluator.losses()[i];
    table.add({a, b, loss});
    surface.add({a, b, loss});
    if (i % kSide == kSide - 1) surface.addGap();
  }
  for (std::size_t i = 0; i < search.size(); ++i) {
    const Vector6& c = search[i].centre;
    path.add({u.dot(c), v.dot(c)});
    path_table.add({double(i), u.dot(c), v.dot(c), (c - u * u.dot(c) - v * v.dot(c)).norm()});
  }
  out.table("landscape", table);
  out.table("path", path_table);
  Plot plot;
  plot.width_px = 1000;
  plot.height_px = 850;
  plot.tables["surface.dat"] = surface.plotData();
  plot.tables["path.dat"] = path.plotData();
  plot.commands = fmt::format(
      "set size square\nset key at screen 0.5,0.97 center top vertical\n"
      "set palette defined (0 \"#10243f\", 0.5 \"#4f9d93\", 1 \"#f4e9a6\")\nset view "
      "map\nset contour base\nset cntrparam levels "
      "12\nset cntrlabel onecolor\nset xrange [-{0:.4f}:{0:.4f}]\nset yrange [-{0:.4f}:{0:.4f}]\nset xlabel "
      "\"from the true pose towards the "
      "first one (m, or half radians)\"\nset ylabel \"the search's widest sideways direction (same "
      "units)\"\nset cblabel \"loss, mean "
      "|psi|\"\nset grid noxtics noytics\nsplot \"surface.dat\" using 1:2:3 with pm3d nocontour notitle, "
      "\"surface.dat\" using 1:2:3 with lines linecolor rgb "
      "\"#80ffffff\" linewidth 1 nosurface notitle, \"path.dat\" using 1:2:(1) with linespoints linetype 1 "
      "linecolor rgb \"black\" pointtype 7 pointsize 1.8 linewidth 5 nocontour title \"search, from the last "
      "pose\", \"path.dat\" using 1:2:(1) with linespoints linetype 1 linecolor rgb \"white\" pointtype 7 "
      "pointsize 1.2 linewidth 2.5 nocontour notitle, "
      "\"-\" using 1:2:3 with points pointtype 2 pointsize 3 linewidth 3 linecolor rgb \"#c01830\" nocontour "
      "title \"true pose\"\n0 0 1\ne\n",
      reach);
  out.plot("landscape", plot,
           "The objective over a plane through the true pose, and the path of the template's centre "
           "projected onto it.");
}

ExperimentResult runInside(const ExperimentContext& context) {
  SynthOptions synth = experimentSynth(context, 40, 24);
  synth.seed = 601;
  synth.ramp = 0.1;
  const auto sequence = std::dynamic_pointer_cast<MemorySequence>(generated("inside", synth).open());
  const Settings settings = experimentSettings(context);
  // The frame with the largest motion, of those after some model is there.
  std::size_t chosen = 6;
  double most = 0;
  const Trajectory& truth = sequence->info().truth;
  for (std::size_t i = std::min<std::size_t>(6, truth.size() - 1); i < truth.size(); ++i) {
    const double moved = offTruth(truth[i - 1].world_from_camera, truth[i].world_from_camera).norm();
    if (moved > most) most = moved, chosen = i;
  }
  ResultWriter out(context, "inside");
  std::vector<NamedValue> errors, fitness;
  studyFrames(
      context, settings, *sequence, chosen, truth.size(), Pose::Identity(), [&](const StudiedFrame& studied) {
        StudiedMethod scorer(context.device, settings, sequence->info().intrinsics);
        std::vector<std::vector<Iteration>> searches;
        Table summary({"method", "iterations", "first_error_cm", "last_error_cm", "last_fitness"});
        for (const std::string& name : kMethods) {
          StudiedMethod method(context.device,
                               changed(settings, {"tracking.method=" + name, "swarm.max_empty_sets=1000",
                                                  "swarm.minimum_move=0"}),
                               sequence->info().intrinsics);
          searches.push_back(watch(method, studied));
          const Vector6& first = searches.back().front().centre;
          const Vector6& last = searches.back().back().centre;
          const double f = scorer.fitness(studied, moveBy(studied.truth, last));
          summary.add({name, double(searches.back().size()), 100 * first.head<3>().norm(),
                       100 * last.head<3>().norm(), f});
          errors.push_back({name, 100 * last.head<3>().norm()});
          fitness.push_back({name, f});
          context.step(20, name);
        }
        out.table("inside", summary);
        plotParticles(out, searches, context.options.seed);
        plotEllipsoids(out, searches.back());
        plotLandscape(out, context, settings, sequence->info().intrinsics, studied, searches.back());
      });
  out.result.ran = fmt::format(
      "Frame {} of a generated flight, the one with the largest motion, searched 20 iterations by each swarm "
      "from the "
      "same particles around the last pose.",
      chosen);
  out.result.paper =
      "PFO explores widely but uses few particles well; PSO is soon stuck; the template reaches a much "
      "better optimum.";
  out.result.verdicts = {
      mostOf("pst ends with the best fitness on this frame", "", fitness[2], {fitness[0], fitness[1]}),
      leastOf("pst ends nearest to the true position on this frame", " cm", errors[2],
              {errors[0], errors[1]})};
  return out.result;
}

}  // namespace

Experiment inside() {
  return {"inside", "Inside one search", "Figures plot-2d-opt and plot-3d-opt",
          [](const ExperimentContext&) { return 60; }, runInside};
}

}  // namespace rosefusion
