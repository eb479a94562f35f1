// Kernels and recorders refuse what does not match the shader or the buffers.
#include "engine/kernel.h"

#include "engine/recorder.h"
#include "engine/reflection.h"
#include "shaders/compute/interface/fitness.h"
#include "shaders/compute/interface/refine.h"
#include "shaders/compute/interface/sum_check.h"
#include "tests/engine/validating_device.h"

namespace rosefusion::testing {
namespace test_kernel {

using shader::FitnessParams;
using shader::kRefineBindings;
using shader::RefineParams;
using shader::SumCheckParams;

class Kernels : public ValidatingDevice {};

TEST_F(Kernels, EveryShaderIsBuiltWithItsOwnInterface) {
  ASSERT_FALSE(allShaders().empty());
  for (const ShaderCode& code : allShaders()) {
    SCOPED_TRACE(code.name);
    const ShaderInterface shader = reflect(code);
    const auto bindings = static_cast<std::uint32_t>(shader.bindings.size());
    EXPECT_GT(bindings, 0u);
    EXPECT_TRUE(Kernel(device(), code, bindings, shader.push.bytes));
    for (const std::uint32_t wrong : {bindings - 1, bindings + 1, 0u})
      EXPECT_TRUE(throwsDeviceError([&] { Kernel(device(), code, wrong, shader.push.bytes); },
                                    DeviceErrorCode::Programming,
                                    {"buffer bindings", std::string(code.name).c_str()}));
    for (const std::uint32_t wrong : {shader.push.bytes + 4, shader.push.bytes + 16, 0u})
      EXPECT_TRUE(throwsDeviceError([&] { Kernel(device(), code, bindings, wrong); },
                                    DeviceErrorCode::Programming,
                                    {"push constants", std::string(code.name).c_str()}));
  }
}

TEST_F(Kernels, UnknownAndBrokenShadersAreRefused) {
  EXPECT_TRUE(
      throwsDeviceError([] { shaderCode("no_such_pass"); }, DeviceErrorCode::Programming, {"no_such_pass"}));
  const std::vector<std::uint32_t> noise(64, 0xDEADBEEF);
  EXPECT_TRUE(throwsDeviceError(
      [&] {
        Kernel(device(), {"noise", noise}, 1, 0);
      },
      DeviceErrorCode::Programming, {"noise", "parsed"}));
}

class Recording : public ValidatingDevice {
 protected:
  void SetUp() override {
    ValidatingDevice::SetUp();
    if (HasFatalFailure()) return;
    kernel_ = Kernel(device(), shaderCode("sum_check"), 2, sizeof(SumCheckParams));
    input_ = Buffer(device(), 64, Memory::Upload);
    sums_ = Buffer(device(), 64, Memory::Readback);
    std::fill(sums_.as<float>().begin(), sums_.as<float>().end(), 0.0f);
    recorder_.emplace(device());
    std::fill(input_.as<float>().begin(), input_.as<float>().end(), 0.5f);
  }
  float sumOf(std::uint32_t count) {
    recorder_->fill(sums_, 0, 0, 64);
    recorder_->dispatch(kernel_, {input_, sums_}, SumCheckParams{0, count}, Threads{1});
    recorder_->submit();
    return sums_.as<float>()[0];
  }

  Kernel kernel_;
  Buffer input_, sums_;
  std::optional<Recorder> recorder_;
};

TEST_F(Recording, WrongBuffersAndConstantsAreRefused) {
  const Buffer empty;
  const auto refused = [&](auto action) {
    return throwsDeviceError(action, DeviceErrorCode::Programming, {"sum_check"});
  };
  EXPECT_TRUE(refused([&] { recorder_->dispatch(kernel_, {input_}, SumCheckParams{0, 1}, Threads{1}); }));
  EXPECT_TRUE(refused([&] {
    recorder_->dispatch(kernel_, {input_, sums_, sums_}, SumCheckParams{0, 1}, Threads{1});
  }));
  EXPECT_TRUE(refused([&] { recorder_->dispatch(kernel_, {input_, sums_}, FitnessParams{}, Threads{1}); }));
  EXPECT_TRUE(refused([&] {
    recorder_->dispatch(kernel_, {input_, empty}, SumCheckParams{0, 1}, Threads{1});
  }));
  EXPECT_EQ(sumOf(4), 2.0f) << "the recorder is no longer usable";
}

TEST_F(Recording, ABufferTooLargeForTexelsIsRefused) {
  DeviceOptions options = deviceUnderTest();
  options.limits_at_most.max_texels = 16;
  Device small(options);
  EXPECT_FALSE(small.info().readsTexels());
  const ShaderCode code = shaderCode("refine_texels");
  const Kernel reader(small, code, kRefineBindings, sizeof(RefineParams));
  Recorder recorder(small);
  const RefineParams params{};
  const auto dispatch = [&](std::uint64_t bytes) {
    const Buffer buffer(small, bytes, Memory::Device);
    const std::vector<BoundBuffers> buffers(kRefineBindings, buffer);
    recorder.dispatchBytes(reader, buffers, &params, sizeof(params), Threads{1});
  };
  // Of a buffer of 16 words all are texels.
  EXPECT_TRUE(throwsDeviceError([&] { dispatch(68); }, DeviceErrorCode::Programming, {"refine", "texels"}));
  EXPECT_NO_THROW(dispatch(64));
  EXPECT_TRUE(small.validationMessages().empty());
}

TEST_F(Recording, MoreWorkgroupsThanTheLimitAreRefused) {
  DeviceOptions options = deviceUnderTest();
  options.limits_at_most.max_workgroup_count_x = 4;
  Device small(options);
  const Kernel kernel(small, shaderCode("sum_check"), 2, sizeof(SumCheckParams));
  const Buffer input(small, 64, Memory::Upload), sums(small, 64, Memory::Readback);
  Recorder recorder(small);
  const auto dispatch = [&](std::uint32_t groups) {
    recorder.dispatch(kernel, {input, sums}, SumCheckParams{0, 1}, Threads{groups});
  };
  EXPECT_TRUE(
      throwsDeviceError([&] { dispatch(5); }, DeviceErrorCode::MissingLimit, {"sum_check", "5", "4"}));
  EXPECT_NO_THROW(dispatch(4));
}

TEST_F(Recording, CopiesAndFillsStayInsideTheirBuffers) {
  const Buffer target(device(), 64, Memory::Readback);
  const auto refused = [&](auto action) {
    return throwsDeviceError(action, DeviceErrorCode::Programming, {"past the end"});
  };
  EXPECT_TRUE(refused([&] { recorder_->copy(input_, target, 68); }));
  EXPECT_TRUE(refused([&] { recorder_->copy(input_, target, 64, 4); }));
  EXPECT_TRUE(refused([&] { recorder_->copy(input_, target, 64, 0, 4); }));
  EXPECT_TRUE(refused([&] { recorder_->copy(input_, target, 4, ~std::uint64_t(3)); }));
  EXPECT_TRUE(refused([&] { recorder_->fill(target, 0, 32, 36); }));
  recorder_->fill(target, 7, 0, 64);
  recorder_->copy(input_, target, 8, 4, 56);
  recorder_->submit();
  const auto words = target.as<std::uint32_t>();
  EXPECT_EQ(words[13], 7u);
  EXPECT_EQ(words[14], 0x3F000000u);  // 0.5f
  EXPECT_EQ(words[15], 0x3F000000u);
}

TEST_F(Recording, CommandsSeeWhatTheOnesBeforeWrote) {
  const Buffer between(device(), 64, Memory::Device);
  recorder_->fill(between, 0x40000000u, 0, 64);  // 2.0f
  recorder_->dispatch(kernel_, {between, sums_}, SumCheckParams{0, 16}, Threads{1});
  recorder_->copy(sums_, between, 4);
  recorder_->fill(sums_, 0, 0, 64);
  recorder_->dispatch(kernel_, {between, sums_}, SumCheckParams{0, 2}, Threads{1});
  EXPECT_NE(sums_.as<float>()[0], 34.0f) << "ran before the submit";
  recorder_->submit();
  EXPECT_EQ(sums_.as<float>()[0], 34.0f);
}

TEST_F(Recording, TooManyDispatchesNeedASubmit) {
  const auto one = [&] { recorder_->dispatch(kernel_, {input_, sums_}, SumCheckParams{0, 1}, Threads{1}); };
  for (int i = 0; i < 256; ++i) one();
  EXPECT_TRUE(throwsDeviceError(one, DeviceErrorCode::Programming, {"256 dispatches"}));
  recorder_->submit();
  EXPECT_EQ(sums_.as<float>()[0], 128.0f);  // each adds 0.5 to the sum so far
  EXPECT_EQ(sumOf(4), 2.0f);
  recorder_->submit();  // nothing recorded: nothing happens
}

TEST_F(Recording, OfAPassThatThrewNothingRuns) {
  recorder_->fill(sums_, 1, 0, 64);
  EXPECT_TRUE(throwsDeviceError(
      [&] {
        const Recorder::Whole pass(*recorder_);
        const Buffer own(device(), 64, Memory::Device);
        recorder_->fill(own, 2, 0, 64);
        recorder_->fill(sums_, 2, 0, 64);
        Buffer(device(), ~std::uint64_t(0), Memory::Device);
      },
      DeviceErrorCode::OutOfMemory, {"MiB"}));
  recorder_->fill(sums_, 3, 0, 4);
  recorder_->submit();
  EXPECT_EQ(sums_.as<std::uint32_t>()[0], 3u);
  EXPECT_EQ(sums_.as<std::uint32_t>()[15], 0u) << "commands of the pass that threw have run";
}

TEST_F(Recording, BuffersAreHeldUntilTheirCommandsHaveRun) {
  {
    const Buffer passing(device(), 64, Memory::Device);
    recorder_->fill(passing, 7, 0, 64);
    recorder_->copy(passing, sums_, 64);
  }
  recorder_->submit();  // the validation layer would name the destroyed buffer
  EXPECT_EQ(sums_.as<std::uint32_t>()[15], 7u);
}

}  // namespace test_kernel
}  // namespace rosefusion::testing
