#include "engine/passes/sum_check.h"

#include <algorithm>
#include <cstring>

#include "shaders/compute/interface/sum_check.h"

namespace rosefusion {

SumCheck sumOnDevice(Device& device, std::span<const float> values) {
  const Kernel kernel(device, shaderCode("sum_check"), 2, sizeof(shader::SumCheckParams));
  const Buffer input(device, values.size_bytes(), Memory::Upload), sums(device, 16, Memory::Readback);
  std::memcpy(input.as<char>().data(), values.data(), values.size_bytes());
  Recorder recorder(device);
  recorder.fill(sums, 0, 0, sums.bytes());
  for (std::size_t first = 0; first < values.size(); first += shader::kLongestLoop) {
    const std::size_t count = std::min<std::size_t>(shader::kLongestLoop, values.size() - first);
    const shader::SumCheckParams params{static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(count)};
    recorder.dispatch(kernel, {input, sums}, params, Threads{1});
    recorder.submit();
  }
  return {sums.as<float>()[shader::kSumCompensated], sums.as<float>()[shader::kSumPlain]};
}

bool compensatedSumsWork(Device& device) {
  const float values[] = {16777216.0f, 1.0f, -16777216.0f};
  return sumOnDevice(device, values).compensated / 3.0f == 1.0f / 3.0f;
}

}  // namespace rosefusion
