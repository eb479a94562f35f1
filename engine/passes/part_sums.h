// Adds up what the parts of a pass have summed.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace rosefusion {

/// Whether each of so many lanes may add more than a few of the terms, so that it has to compensate.
inline bool addsManyTerms(std::uint64_t terms, std::uint64_t lanes) {
  constexpr std::uint64_t kFew = 4;
  return terms > kFew * lanes;
}

/// `values`: for each of `count` candidates and `parts` parts the array's numbers. In the parts' order, so
/// that the result is the same bits whatever the number of candidates.
template <typename Sums>
std::vector<Sums> addParts(std::span<const float> values, std::size_t count, std::size_t parts) {
  std::vector<Sums> out(count, Sums{});
  const float* value = values.data();
  for (Sums& sums : out)
    for (std::size_t part = 0; part < parts; ++part)
      for (auto& sum : sums) sum += *value++;
  return out;
}

}  // namespace rosefusion
