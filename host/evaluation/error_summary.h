// The figures every list of errors is summed up in.
#pragma once
#include <cstddef>
#include <limits>
#include <vector>

namespace rosefusion {

/// In the unit of the errors summed up; NaN when there were none.
struct ErrorSummary {
  std::size_t count = 0;
  double rmse = std::numeric_limits<double>::quiet_NaN();
  double mean = std::numeric_limits<double>::quiet_NaN();
  double median = std::numeric_limits<double>::quiet_NaN();  ///< mean of the middle two for an even count
  double max = std::numeric_limits<double>::quiet_NaN();
};

/// Every error must be finite.
ErrorSummary summarise(std::vector<double> errors);

}  // namespace rosefusion
