#include "engine/passes/sum_check.h"

#include <cstring>

#include "shaders/compute/interface/sum_check.h"

namespace rosefusion {

SumCheck sumOnDevice(Device& device, std::span<const float> values) {
  const Kernel kernel(device, shaderCode("sum_check"), 2, sizeof(shader::SumCheckParams));
  const Buffer input(device, values.size_bytes(), Memory::Upload),
      sums(device, sizeof(SumCheck), Memory::Readback);
  std::memcpy(input.as<char>().data(), values.data(), values.size_bytes());
  Recorder recorder(device);
  recorder.dispatch(kernel, {&input, &sums},
                    shader::SumCheckParams{static_cast<std::uint32_t>(values.size())}, {1});
  recorder.submit();
  return sums.as<SumCheck>()[0];
}

bool compensatedSumsWork(Device& device) {
  const float values[] = {16777216.0f, 1.0f, -16777216.0f};
  return sumOnDevice(device, values).compensated / 3.0f == 1.0f / 3.0f;
}

}  // namespace rosefusion
