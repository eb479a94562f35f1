#include "host/evaluation/error_summary.h"

#include <algorithm>
#include <cmath>

namespace rosefusion {

ErrorSummary summarise(std::vector<double> errors) {
  ErrorSummary summary;
  summary.count = errors.size();
  if (errors.empty()) return summary;
  double sum = 0, sum_of_squares = 0;
  for (const double e : errors) {
    sum += e;
    sum_of_squares += e * e;
  }
  const double n = static_cast<double>(errors.size());
  summary.mean = sum / n;
  summary.rmse = std::sqrt(sum_of_squares / n);
  std::sort(errors.begin(), errors.end());
  const std::size_t half = errors.size() / 2;
  summary.median = errors.size() % 2 ? errors[half] : (errors[half - 1] + errors[half]) / 2;
  summary.max = errors.back();
  return summary;
}

}  // namespace rosefusion
