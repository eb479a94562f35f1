#include "host/experiments/experiment.h"

#include <algorithm>

#include "host/core/file_io.h"
#include "host/experiments/families.h"

namespace rosefusion {

void ExperimentContext::step(int frames, const std::string& what) const {
  if (progress) progress(frames, what);
  if (stop && stop()) throw Interrupted{};
}

int ExperimentContext::amount(int full, int quick) const {
  return std::max(1, (options.quick ? quick : full) / std::max(1, options.shrink));
}

ResultWriter::ResultWriter(const ExperimentContext& context, const std::string& name)
    : folder_(context.options.out / name) {}

void ResultWriter::table(const std::string& stem, const Table& table) {
  writeFileAtomically(folder_ / (stem + ".csv"), table.csv());
  result.tables.push_back(stem + ".csv");
}

void ResultWriter::plot(const std::string& stem, const Plot& plot, const std::string& caption) {
  Plot styled = plot;
  styled.commands = plotStyle() + plot.commands;
  std::filesystem::create_directories(folder_);
  renderPlot(styled, folder_ / (stem + ".png"));
  result.figures.push_back({stem + ".png", caption});
}

void ResultWriter::picture(const std::string& stem, std::string_view png, const std::string& caption) {
  writeFileAtomically(folder_ / (stem + ".png"), png);
  result.figures.push_back({stem + ".png", caption});
}

std::string plotStyle() {
  // From dark to light, and each with a dash and a point of its own, so that they are told apart in grey.
  return R"(set linetype 1 linecolor rgb "#1b1b1b" linewidth 2.5 dashtype 1 pointtype 7
set linetype 2 linecolor rgb "#9d1c35" linewidth 2 dashtype 2 pointtype 5
set linetype 3 linecolor rgb "#1f6f8b" linewidth 2 dashtype 3 pointtype 9
set linetype 4 linecolor rgb "#c77d1a" linewidth 2 dashtype 4 pointtype 11
set linetype 5 linecolor rgb "#4f9d55" linewidth 2 dashtype 5 pointtype 13
set linetype 6 linecolor rgb "#8f8f8f" linewidth 2 dashtype 1 pointtype 4
set key outside top center horizontal
set datafile missing "nan"
)";
}

const std::vector<Experiment>& experiments() {
  static const std::vector<Experiment> all = {
      tsdfNormalisation(), optimisers(), rescaling(), multires(),  complexity(), accuracy(), frames(),
      surfaces(),          inside(),     gallery(),   speedLimit()};
  return all;
}

}  // namespace rosefusion
