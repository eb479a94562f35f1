// The fixture of all engine tests: one Device per test suite, with validation; a validation message fails the
// test.
#pragma once
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <memory>
#include <string>

#include "engine/device.h"
#include "engine/error.h"

namespace rosefusion::testing {

/// $ROSEFUSION_DEVICE, else Mesa's software device, so that results do not depend on the machine.
/// $ROSEFUSION_TEST_MAX_TEXELS and _STORAGE_BUFFERS, when set: as on a device with so small texel buffers, or
/// that binds so few buffers.
inline DeviceOptions deviceUnderTest() {
  const char* chosen = std::getenv("ROSEFUSION_DEVICE");
  const auto limit = [](const char* name) {
    const char* text = std::getenv(name);
    return text ? static_cast<std::uint32_t>(std::strtoul(text, nullptr, 10)) : 0;
  };
  return {.select = chosen ? chosen : "llvmpipe",
          .validation = true,
          .limits_at_most = {.max_storage_buffers = limit("ROSEFUSION_TEST_MAX_STORAGE_BUFFERS"),
                             .max_texels = limit("ROSEFUSION_TEST_MAX_TEXELS")}};
}

class ValidatingDevice : public ::testing::Test {
 protected:
  static Device& device() { return *shared(); }

  void SetUp() override {
    try {
      if (!shared()) shared() = std::make_unique<Device>(deviceUnderTest());
    } catch (const DeviceError& error) {
      FAIL() << "The engine's tests need a Vulkan device and the validation layer: " << error.what();
    }
  }

  void TearDown() override {
    if (!shared()) return;
    const auto& messages = device().validationMessages();
    for (; reported() < messages.size(); ++reported())
      ADD_FAILURE() << "The validation layer says: " << messages[reported()];
  }

  static void TearDownTestSuite() {
    // Not left to static destruction: drivers have gone by then.
    shared().reset();
    reported() = 0;
  }

 private:
  static std::unique_ptr<Device>& shared() {
    static std::unique_ptr<Device> device;
    return device;
  }
  static std::size_t& reported() {
    static std::size_t count = 0;
    return count;
  }
};

/// Runs `action`, which must throw a DeviceError with `code` whose sentence contains every one of `parts`.
template <typename Action>
::testing::AssertionResult throwsDeviceError(Action action, DeviceErrorCode code,
                                             std::initializer_list<const char*> parts) {
  try {
    action();
  } catch (const DeviceError& error) {
    const std::string sentence = error.what();
    if (error.code() != code)
      return ::testing::AssertionFailure()
             << "wrong code " << static_cast<int>(error.code()) << ": " << sentence;
    for (const char* part : parts)
      if (sentence.find(part) == std::string::npos)
        return ::testing::AssertionFailure() << "'" << part << "' is not in: " << sentence;
    return ::testing::AssertionSuccess() << sentence;
  }
  return ::testing::AssertionFailure() << "nothing was thrown";
}

}  // namespace rosefusion::testing
