// Whether what the paper found was found here too: always worked out from the numbers.
#pragma once
#include <string>
#include <vector>

namespace rosefusion {

enum class Agreement { Agrees, Differs, Open };
/// "agrees", "differs", "open".
const char* toString(Agreement agreement);

struct Verdict {
  std::string claim;  ///< the paper's
  std::string found;  ///< the numbers it is held against
  Agreement agreement = Agreement::Open;
};

struct NamedValue {
  std::string name;
  double value = 0;
};

/// Agrees when `first` is at most `slack` (a share of the other) above each of `others`; open when a value is
/// not a number or there is nothing to compare with.
Verdict leastOf(const std::string& claim, const std::string& unit, const NamedValue& first,
                const std::vector<NamedValue>& others, double slack = 0);
/// The same for the largest: at most `slack` below each.
Verdict mostOf(const std::string& claim, const std::string& unit, const NamedValue& first,
               const std::vector<NamedValue>& others, double slack = 0);
/// Agrees when the value is at most the limit.
Verdict within(const std::string& claim, const std::string& unit, const NamedValue& value, double limit);

/// y = offset + slope x by least squares; r_squared: share of y's variance explained. All NaN for fewer than
/// three points or equal x.
struct LinearFit {
  double slope, offset, r_squared;
};
LinearFit fitLine(const std::vector<double>& x, const std::vector<double>& y);

/// How many steps a rising curve takes to gain `share` of the way from its first value to `top`; the number
/// of its steps plus one where it does not get there.
int stepsToReach(const std::vector<double>& curve, double top, double share);

}  // namespace rosefusion
