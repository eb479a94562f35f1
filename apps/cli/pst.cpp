// rosefusion pst: makes, inspects and plots swarm templates.

#include <chrono>
#include <cstdio>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "apps/cli/commands.h"
#include "apps/cli/progress.h"
#include "host/core/number_text.h"
#include "host/swarm/template_file.h"
#include "host/swarm/template_plot.h"
#include "host/swarm/template_statistics.h"

namespace rosefusion::cli {
namespace {

struct PstArguments {
  TemplateOptions options;
  std::string out, inspect, plot, json;
};

TemplateSet makeTemplates(const TemplateOptions& options) {
  const auto start = std::chrono::steady_clock::now();
  TemplateSet set = [&] {
    Progress progress("templates");
    return generateTemplates(options, [&](int done, int total) {
      progress.update(static_cast<std::size_t>(done), static_cast<std::size_t>(total));
    });
  }();
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
  std::fprintf(stderr, "generated in %.1f s\n", elapsed.count());
  return set;
}

nlohmann::json toJson(const TemplateStatistics& s) {
  nlohmann::json covariance = nlohmann::json::array();
  for (const auto& row : s.covariance.rowwise())
    covariance.push_back(std::vector<double>(row.begin(), row.end()));
  return {{"particles", s.particles},
          {"templates", s.templates},
          {"radius", s.radius},
          {"minimum_distance", s.minimum_distance},
          {"mean_nearest_distance", s.mean_nearest_distance},
          {"largest_norm", s.largest_norm},
          {"zero_particle", s.zero_particle},
          {"mean", std::vector<double>(s.mean.begin(), s.mean.end())},
          {"covariance", covariance},
          {"uniform_variance", kUniformBallVariance},
          {"shell_density", s.shell_density}};
}

void print(std::ostream& out, const TemplateSet& set, const std::vector<TemplateStatistics>& all) {
  const auto write = [&](const char* format, auto... values) { out << printed(format, values...); };
  out << "seed " << set.options.seed << ", " << set.options.count << " templates per size\n\n";
  out << "                      axes x, y, z [m], qx, qy, qz         a uniform ball has\n";
  for (const TemplateStatistics& s : all) {
    const Eigen::Matrix<double, 6, 1> variance = s.covariance.diagonal();
    const Eigen::Matrix<double, 6, 6> correlation =
        s.covariance - Eigen::Matrix<double, 6, 6>(variance.asDiagonal());
    write("%zu particles\n", s.particles);
    write("  smallest distance   %.4f (Poisson-disk radius %.4f)\n", s.minimum_distance, s.radius);
    write("  nearest neighbour   %.4f on average\n", s.mean_nearest_distance);
    write("  mean               %+.4f %+.4f %+.4f %+.4f %+.4f %+.4f  0\n", s.mean[0], s.mean[1], s.mean[2],
          s.mean[3], s.mean[4], s.mean[5]);
    write("  variance            %.4f  %.4f  %.4f  %.4f  %.4f  %.4f  %.4f\n", variance[0], variance[1],
          variance[2], variance[3], variance[4], variance[5], kUniformBallVariance);
    write("  largest covariance  %.4f                                         0\n",
          correlation.cwiseAbs().maxCoeff());
    out << "  density by shell of equal volume, inside out (1 = uniform):\n   ";
    for (const double density : s.shell_density) write(" %.3f", density);
    write("\n  particle 0          %s\n\n",
          s.zero_particle ? "the zero move, as it must be" : "NOT the zero move");
  }
}

void writePlot(const std::string& file, const TemplateSet& set) {
  const size_t last = set.levels.size() - 1;
  const SwarmTemplate& shown = set.levels[last][0];
  const std::string title = "Swarm template of " + std::to_string(shown.particles.size()) +
                            " particles, seed " + std::to_string(set.options.seed) + ", number 1 of " +
                            std::to_string(set.options.count);
  writeTemplatePlot(file, shown, title);
  std::fprintf(stderr, "plot written to %s\n", file.c_str());
}

void runPst(const PstArguments& arguments) {
  const TemplateSet set =
      arguments.inspect.empty() ? makeTemplates(arguments.options) : readTemplates(arguments.inspect);
  if (!arguments.out.empty()) {
    writeTemplates(arguments.out, set);
    std::fprintf(stderr, "templates written to %s\n", arguments.out.c_str());
  }
  if (!arguments.plot.empty()) writePlot(arguments.plot, set);
  std::vector<TemplateStatistics> statistics;
  for (const auto& level : set.levels) statistics.push_back(measureTemplates(level));
  if (arguments.json != "-") print(std::cout, set, statistics);
  nlohmann::json json = {{"seed", set.options.seed}, {"count", set.options.count}};
  for (const TemplateStatistics& s : statistics) json["sizes"].push_back(toJson(s));
  writeJson(arguments.json, json.dump(2));
}

}  // namespace

void addPstCommand(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("pst", "make, inspect and plot the particle swarm templates of the pose search");
  auto arguments = std::make_shared<PstArguments>();
  TemplateOptions& options = arguments->options;
  command->add_option("--out", arguments->out, "write the templates to this file")->type_name("FILE");
  command->add_option("--seed", options.seed, "seed of the sampling")->capture_default_str();
  command->add_option("--sizes", options.sizes, "particles per template, one or several sizes")
      ->delimiter(',')
      ->capture_default_str();
  command->add_option("--count", options.count, "templates per size")->capture_default_str();
  command->add_option("--inspect", arguments->inspect, "report on this file instead of making templates")
      ->type_name("FILE")
      ->excludes("--out")
      ->excludes("--seed")
      ->excludes("--sizes")
      ->excludes("--count");
  command
      ->add_option("--plot", arguments->plot,
                   "draw the last size's first template, its 15 projections on two axes")
      ->type_name("FILE.png");
  command->add_option("--json", arguments->json, "write the report as JSON; '-' is standard output")
      ->type_name("FILE");
  command->footer(
      "A set of 3 x 20 templates is made by itself when 'run' needs it first, and kept in "
      "~/.cache/rosefusion.\n"
      "Examples:\n"
      "  rosefusion pst --out templates.pst --plot templates.png\n"
      "  rosefusion pst --inspect templates.pst --json -\n"
      "  rosefusion pst --sizes 4096,512 --count 5 --seed 7 --out small.pst");
  command->callback([arguments] { runPst(*arguments); });
}

}  // namespace rosefusion::cli
