#include "host/experiments/verdict.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace rosefusion {
namespace {

Verdict compared(const std::string& claim, const std::string& unit, const NamedValue& first,
                 const std::vector<NamedValue>& others, double sign, double slack) {
  Verdict out{claim, fmt::format("{} {:.3g}{}", first.name, first.value, unit), Agreement::Agrees};
  bool open = others.empty() || !std::isfinite(first.value);
  for (const NamedValue& other : others) {
    out.found += fmt::format(", {} {:.3g}{}", other.name, other.value, unit);
    open = open || !std::isfinite(other.value);
    if (sign * (first.value - other.value) > slack * std::abs(other.value))
      out.agreement = Agreement::Differs;
  }
  if (open) out.agreement = Agreement::Open;
  return out;
}

}  // namespace

const char* toString(Agreement agreement) {
  return agreement == Agreement::Agrees ? "agrees" : agreement == Agreement::Differs ? "differs" : "open";
}

Verdict leastOf(const std::string& claim, const std::string& unit, const NamedValue& first,
                const std::vector<NamedValue>& others, double slack) {
  return compared(claim, unit, first, others, 1, slack);
}

Verdict mostOf(const std::string& claim, const std::string& unit, const NamedValue& first,
               const std::vector<NamedValue>& others, double slack) {
  return compared(claim, unit, first, others, -1, slack);
}

Verdict within(const std::string& claim, const std::string& unit, const NamedValue& value, double limit) {
  return compared(claim, unit, value, {{"limit", limit}}, 1, 0);
}

LinearFit fitLine(const std::vector<double>& x, const std::vector<double>& y) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  const auto n = static_cast<double>(x.size());
  if (x.size() < 3 || x.size() != y.size()) return {kNone, kNone, kNone};
  double mean_x = 0, mean_y = 0, xx = 0, xy = 0, yy = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    mean_x += x[i] / n;
    mean_y += y[i] / n;
  }
  for (std::size_t i = 0; i < x.size(); ++i) {
    xx += (x[i] - mean_x) * (x[i] - mean_x);
    xy += (x[i] - mean_x) * (y[i] - mean_y);
    yy += (y[i] - mean_y) * (y[i] - mean_y);
  }
  if (!(xx > 0)) return {kNone, kNone, kNone};
  const double slope = xy / xx;
  return {slope, mean_y - slope * mean_x, yy > 0 ? xy * xy / (xx * yy) : 1};
}

int stepsToReach(const std::vector<double>& curve, double top, double share) {
  if (curve.empty()) return 0;
  const double wanted = curve[0] + share * (top - curve[0]);
  const auto there = std::find_if(curve.begin(), curve.end(), [&](double value) { return value >= wanted; });
  return static_cast<int>(there - curve.begin());
}

}  // namespace rosefusion
