#include "host/bench/comparison.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "host/core/error.h"
#include "host/core/number_text.h"

namespace rosefusion {
namespace {

using Json = nlohmann::ordered_json;

// What was worked on: figures of different work say nothing about each other.
constexpr const char* kWork[] = {"/settings", "/frames", "/seed", "/volume/voxel_size_m"};

std::string textAt(const Json& json, const char* pointer) {
  const Json::json_pointer at(pointer);
  if (!json.contains(at)) return "not told";
  const Json& value = json.at(at);
  return value.is_string() ? value.get<std::string>() : value.dump();
}

std::string describe(const Json& json) {
  return textAt(json, "/device/name") + ", " + textAt(json, "/device/driver") + "; " +
         textAt(json, "/processor") + "; commit " + textAt(json, "/commit") + "; " + textAt(json, "/date");
}

/// Times and their ratios, by name; not the shares and percentages, which lie about 0.
std::map<std::string, double> figuresOf(const Json& json) {
  std::map<std::string, double> out;
  for (const auto& [pass, values] : json.items()) {
    if (!values.is_object()) continue;
    for (const auto& [key, value] : values.items()) {
      const bool counts = key.ends_with("ms") || key.ends_with("ratio") || key.ends_with("ns_per_lookup");
      if (counts && value.is_number() && value.get<double>() > 0) out[pass + " " + key] = value.get<double>();
    }
  }
  return out;
}

}  // namespace

FiguresComparison compareFigures(const Json& before, const Json& after, const std::string& before_name,
                                 const std::string& after_name) {
  const std::map<std::string, double> old_figures = figuresOf(before), new_figures = figuresOf(after);
  for (const auto& [figures, json, name] :
       {std::tuple(&old_figures, &before, &before_name), std::tuple(&new_figures, &after, &after_name)})
    if (figures->empty() || !json->contains("fitness"))
      throw InputError(*name +
                       ": holds no figures of the passes; give what bench wrote with --json or --history.");
  for (const char* work : kWork)
    if (textAt(before, work) != textAt(after, work))
      throw InputError(before_name + " and " + after_name + " are not comparable: " + (work + 1) + " was " +
                       textAt(before, work) + " in one and " + textAt(after, work) +
                       " in the other; measure both alike.");
  FiguresComparison out{describe(before), describe(after), {}, {}};
  for (const auto& [name, value] : old_figures) {
    const auto other = new_figures.find(name);
    if (other != new_figures.end())
      out.figures.push_back({name, value, other->second, other->second / value});
  }
  std::ranges::stable_sort(out.figures, std::greater<>(),
                           [](const ComparedFigure& f) { return std::abs(std::log(f.ratio)); });
  for (const char* what : {"/device/name", "/device/driver", "/processor", "/native"})
    if (textAt(before, what) != textAt(after, what)) {
      out.remarks.emplace_back(
          "Times of different machines or drivers do not compare programs; ratios to the native loops come "
          "nearer.");
      break;
    }
  for (const auto& [one, other, name] : {std::tuple(&old_figures, &new_figures, &before_name),
                                         std::tuple(&new_figures, &old_figures, &after_name)}) {
    std::string only;
    for (const auto& [figure, value] : *one)
      if (!other->contains(figure)) only += (only.empty() ? "" : ", ") + figure;
    if (!only.empty()) out.remarks.push_back("Only " + *name + " has: " + only + ".");
  }
  return out;
}

Json comparisonJson(const FiguresComparison& c) {
  Json figures = Json::array();
  for (const ComparedFigure& f : c.figures)
    figures.push_back({{"name", f.name}, {"before", f.before}, {"after", f.after}, {"ratio", f.ratio}});
  return {{"before", c.before}, {"after", c.after}, {"figures", figures}, {"remarks", c.remarks}};
}

std::string comparisonTable(const FiguresComparison& c) {
  std::string out = "before  " + c.before + "\nafter   " + c.after + "\n";
  out += printed("  %-30s %10s %10s %8s\n", "", "before", "after", "ratio");
  for (const ComparedFigure& f : c.figures)
    out += printed("  %-30s %10.3f %10.3f %8.3f\n", f.name.c_str(), f.before, f.after, f.ratio);
  for (const std::string& remark : c.remarks) out += remark + "\n";
  return out;
}

}  // namespace rosefusion
