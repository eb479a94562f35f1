// What a run's folder tells those that export from it.
#include <gtest/gtest.h>

#include "host/core/error.h"
#include "host/core/file_io.h"
#include "host/run/result.h"
#include "tests/host/core/temporary_folder.h"

namespace rosefusion::testing {
namespace test_result {

RunResult resultOf(const std::string& sequence) {
  const TemporaryFolder folder;
  writeFileAtomically(folder.path() / "report.json",
                      R"({"sequence": {"path": "somewhere")" + sequence + "}}");
  writeFileAtomically(
      folder.path() / "frames.csv",
      "frame,timestamp_s,status,reason,tx_m,ty_m,tz_m,qx,qy,qz,qw\n3,0.5,tracked,\"\",1,2,3,0,0,0,1\n");
  return readResult(folder.path());
}

TEST(RunResult, OpensTheRecordingAsTheRunDid) {
  const SequenceOptions told =
      resultOf(
          R"(, "given": {"intrinsics": [500, 510, 320, 240], "depth_units_per_metre": 2500, "topic": "/depth"})")
          .opened_with;
  EXPECT_EQ(told.intrinsics, (Intrinsics{0, 0, 500, 510, 320, 240}));
  EXPECT_EQ(told.depth_units_per_metre, 2500);
  EXPECT_EQ(told.topic, "/depth");
  const SequenceOptions none = resultOf("").opened_with;
  EXPECT_FALSE(none.intrinsics);
  EXPECT_FALSE(none.depth_units_per_metre);
  EXPECT_EQ(none.topic, "");
}

TEST(RunResult, ReadsFramesAndNamesWhatIsDamaged) {
  const RunResult result = resultOf("");
  ASSERT_EQ(result.frames.size(), 1u);
  EXPECT_EQ(result.frames[0].number, 3u);
  EXPECT_TRUE(result.frames[0].placed);
  EXPECT_EQ(result.frames[0].world_from_camera.translation(), Eigen::Vector3d(1, 2, 3));
  try {
    resultOf(R"(, "given": {"intrinsics": [500]})");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("report.json"), std::string::npos) << error.what();
  }
}

}  // namespace test_result
}  // namespace rosefusion::testing
