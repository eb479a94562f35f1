// rosefusion eval-mesh: how far a reconstructed surface is from the true one.
#include <spdlog/fmt/fmt.h>
#include <spdlog/spdlog.h>

#include <filesystem>
#include <iostream>
#include <memory>
#include <string>

#include "apps/cli/commands.h"
#include "host/core/error.h"
#include "host/core/trajectory.h"
#include "host/evaluation/alignment.h"
#include "host/evaluation/mesh_error.h"
#include "host/evaluation/report_json.h"
#include "host/export/mesh_io.h"

namespace rosefusion::cli {
namespace {

// How far in front of a camera its surface typically lies: indoor depth cameras see 0.5 to 4 m.
constexpr double kLever_m = 1;

struct EvalMeshArguments {
  std::filesystem::path mesh;
  std::filesystem::path truth;
  std::filesystem::path estimate_trajectory;
  std::filesystem::path truth_trajectory;
  std::string json;
  double max_difference_s = 0.02;
  MeshErrorOptions options;
};

Alignment alignTrajectories(const EvalMeshArguments& arguments) {
  const auto pairs = associate(readTumTrajectory(arguments.estimate_trajectory),
                               readTumTrajectory(arguments.truth_trajectory), Association::Nearest,
                               arguments.max_difference_s);
  if (pairs.empty())
    throw InputError(
        fmt::format("{}: has no pose within {} s of one in {}; check that both are of the same sequence, "
                    "or raise --max-difference.",
                    arguments.estimate_trajectory.string(), arguments.max_difference_s,
                    arguments.truth_trajectory.string()));
  Alignment alignment = alignPoses(pairs, kLever_m);
  alignment.description += fmt::format(" of {} common camera poses", pairs.size());
  return alignment;
}

std::string table(const MeshErrors& errors, const EvalMeshArguments& arguments,
                  const std::string& alignment) {
  std::string text = fmt::format("Reconstruction  {}\nTruth           {}\nAligned         {}\n",
                                 arguments.mesh.string(), arguments.truth.string(), alignment);
  text += fmt::format("Samples         {} on the reconstruction, {} on the truth\n\n",
                      errors.reconstruction_samples, errors.truth_samples);
  const ErrorSummary& all = errors.accuracy_m;
  text += fmt::format(
      "  Accuracy (distance of the reconstruction to the truth)\n    RMS {:.2f} cm, mean {:.2f} cm, "
      "median {:.2f} cm, largest {:.1f} cm\n",
      100 * all.rmse, 100 * all.mean, 100 * all.median, 100 * all.max);
  const ErrorSummary& inliers = errors.inlier_accuracy_m;
  text += inliers.count == 0
              ? fmt::format("    nothing lies within {:.0f} cm\n\n", 100 * errors.inlier_m)
              : fmt::format("    RMS {:.2f} cm over the {:.1f} % that lie within {:.0f} cm\n\n",
                            100 * inliers.rmse,
                            100.0 * static_cast<double>(inliers.count) / static_cast<double>(all.count),
                            100 * errors.inlier_m);
  text += fmt::format("  {:<10}{:>14}{:>14}{:>14}\n", "within", "completeness", "precision", "F-score");
  for (const MeshScore& s : errors.scores)
    text += fmt::format("  {:<10}{:>12.1f} %{:>12.1f} %{:>12.1f} %\n",
                        fmt::format("{:g} cm", 100 * s.threshold_m), 100 * s.completeness, 100 * s.precision,
                        100 * s.f_score);
  return text;
}

void evaluate(EvalMeshArguments arguments) {
  const bool allow_points = true;
  const TriangleMesh mesh = readMesh(arguments.mesh, allow_points),
                     truth = readMesh(arguments.truth, allow_points);
  Alignment alignment;
  alignment.description = "not aligned; both are taken to be in the same frame";
  if (!arguments.estimate_trajectory.empty()) alignment = alignTrajectories(arguments);
  arguments.options.truth_from_reconstruction = alignment.truth_from_estimate;
  arguments.options.reconstruction_name = arguments.mesh.string();
  arguments.options.truth_name = arguments.truth.string();

  const MeshErrors errors = measureMesh(mesh, truth, arguments.options);
  if (arguments.json != "-") std::cout << table(errors, arguments, alignment.description) << std::flush;
  auto json = toJson(errors);
  json["alignment"] = alignment.description;
  writeJson(arguments.json, json.dump(2));
  if (errors.scores.back().f_score < 0.1)
    spdlog::warn(
        "hardly anything matches: check that both meshes are in metres and in the same frame, or align them "
        "with --estimate-trajectory and --truth-trajectory.");
}

}  // namespace

void addEvalMeshCommand(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "eval-mesh",
      "Compare a reconstructed mesh (or point cloud: a PLY without faces) with the true surface.\n"
      "Accuracy and precision: distance of the reconstruction to the truth. Completeness: "
      "share of the true surface that "
      "has reconstruction nearby. The whole of TRUTH_MESH counts, so that what the camera "
      "never saw lowers completeness "
      "(and the F-score) just like what was lost; cut the truth to the seen part to "
      "measure that part alone.");
  const auto arguments = std::make_shared<EvalMeshArguments>();
  command->add_option("MESH", arguments->mesh, "Reconstruction (PLY, OBJ, STL, ...; metres)")->required();
  command->add_option("TRUTH_MESH", arguments->truth, "True surface (PLY, OBJ, STL, ...; metres)")
      ->required();
  CLI::Option* estimate = command->add_option(
      "--estimate-trajectory", arguments->estimate_trajectory,
      "Camera poses of the reconstruction (TUM format): with --truth-trajectory they bring the mesh "
      "into the truth's frame");
  CLI::Option* truth = command->add_option("--truth-trajectory", arguments->truth_trajectory,
                                           "Camera poses in the truth's frame (TUM format)");
  estimate->needs(truth);
  truth->needs(estimate);
  command
      ->add_option("--max-difference", arguments->max_difference_s,
                   "Largest difference of paired stamps in seconds")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  command->add_option("--samples", arguments->options.samples, "Random points on each surface")
      ->check(CLI::Range(1000, 100000000))
      ->capture_default_str();
  command->add_option("--seed", arguments->options.seed, "Seed of the random points")->capture_default_str();
  command->add_option("--json", arguments->json,
                      "Write the figures as JSON ('-': to standard output, no table)");
  command->footer(
      "Examples:\n"
      "  rosefusion eval-mesh out/mesh.ply sequence/mesh_seen.ply --json mesh.json\n"
      "  rosefusion eval-mesh out/mesh.ply scan.ply --estimate-trajectory out/trajectory.txt \\\n"
      "      --truth-trajectory sequence/groundtruth.txt");
  command->callback([arguments] { evaluate(*arguments); });
}

}  // namespace rosefusion::cli
