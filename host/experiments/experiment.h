// The paper's experiments: what each is given, and what it hands back.
#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "engine/device.h"
#include "host/evaluation/plot.h"
#include "host/experiments/table.h"
#include "host/experiments/verdict.h"

namespace rosefusion {

/// Thrown by ExperimentContext::step when the user asked to stop.
struct Interrupted {};

struct ExperimentOptions {
  bool quick = false;          ///< small images, few frames
  int shrink = 1;              ///< divides frames, rooms and particles; above 1 for tests only
  std::filesystem::path data;  ///< folder with recorded sequences; empty: generated ones alone
  std::filesystem::path out;
  std::uint64_t seed = 1;
};

/// What an experiment works with; one thread.
struct ExperimentContext {
  Device& device;
  ExperimentOptions options;
  /// A piece of work has been done: `frames`, about, tracked or searched; none where it was known already.
  std::function<void(int frames, const std::string& what)> progress;
  std::function<bool()> stop;

  /// Throws Interrupted where the user asked to stop.
  void step(int frames, const std::string& what) const;
  /// A number of frames or rooms: `full`, or `quick`; shrunk.
  int amount(int full, int quick) const;
};

struct Figure {
  std::string file;  ///< in the experiment's folder
  std::string caption;
};

struct ExperimentResult {
  std::string ran;    ///< what was run, a sentence or two
  std::string paper;  ///< what the paper found
  std::vector<Verdict> verdicts;
  std::vector<std::string> tables;  ///< CSV files in the experiment's folder
  std::vector<Figure> figures;
};

/// Collects an experiment's files in its folder.
class ResultWriter {
 public:
  ResultWriter(const ExperimentContext& context, const std::string& name);

  void table(const std::string& stem, const Table& table);
  /// Throws as renderPlot does.
  void plot(const std::string& stem, const Plot& plot, const std::string& caption);
  void picture(const std::string& stem, std::string_view png, const std::string& caption);

  ExperimentResult result;

 private:
  std::filesystem::path folder_;
};

struct Experiment {
  std::string name;
  std::string title;
  std::string figure;                                 ///< the paper's
  std::function<int(const ExperimentContext&)> work;  ///< frames that it will report as progress, about
  std::function<ExperimentResult(const ExperimentContext&)> run;
};

/// All, in the order of the paper.
const std::vector<Experiment>& experiments();

/// The commands that every plot begins with: five line types told apart by dashes and point shapes, not by
/// colour alone.
std::string plotStyle();

}  // namespace rosefusion
