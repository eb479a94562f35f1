// Which exit code an exception becomes.
#include "apps/guarded_main.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "apps/cli/exit_code.h"
#include "engine/error.h"
#include "host/core/error.h"

namespace rosefusion::testing {
namespace test_guarded_main {

template <typename Exception>
int codeOf(const char* name, const Exception& exception) {
  ::testing::internal::CaptureStderr();
  const int code = guardedMain(name, [&]() -> int { throw exception; });
  EXPECT_THAT(::testing::internal::GetCapturedStderr(), ::testing::HasSubstr(exception.what()));
  return code;
}

TEST(GuardedMain, TellsDefectsFromBadInputAndDevices) {
  EXPECT_EQ(guardedMain("ends well", [] { return 7; }), 7);
  EXPECT_EQ(codeOf("input", InputError("no such folder")), kExitBadInput);
  EXPECT_EQ(codeOf("device", DeviceError(DeviceErrorCode::DeviceLost, "gone")), kExitDevice);
  EXPECT_EQ(codeOf("defect", DeviceError(DeviceErrorCode::Programming, "misused")), kExitFailure);
  EXPECT_EQ(codeOf("other", std::runtime_error("unforeseen")), kExitFailure);
  ::testing::internal::CaptureStderr();
  EXPECT_EQ(guardedMain("memory", []() -> int { throw std::bad_alloc(); }), kExitFailure);
  EXPECT_THAT(::testing::internal::GetCapturedStderr(), ::testing::HasSubstr("memory is exhausted; close"));
}

}  // namespace test_guarded_main
}  // namespace rosefusion::testing
