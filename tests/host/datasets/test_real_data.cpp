// The readers on real recordings, where they are at hand.
#include <gmock/gmock.h>

#include <cstdlib>

#include "host/datasets/inspection.h"

namespace rosefusion::testing {
namespace test_real_data {

namespace fs = std::filesystem;

/// $ROSEFUSION_DATA, else shared/data beside or in the source folder.
fs::path findData(const std::string& name) {
  if (const char* set = std::getenv("ROSEFUSION_DATA")) return fs::path(set) / name;
  const fs::path source = ROSEFUSION_SOURCE_DIR;
  for (const fs::path& root :
       {source / "../shared/data", source / "../../shared/data", source / "shared/data"})
    if (fs::exists(root / name)) return root / name;
  return name;
}

#define SKIP_WITHOUT(path) \
  if (!fs::exists(path))   \
  GTEST_SKIP() << "the recording " << path << " is not on this machine (set ROSEFUSION_DATA)"

TEST(RealData, TumFreiburg1Rpy) {
  const fs::path path = findData("tum_fr1_rpy");
  SKIP_WITHOUT(path);
  const auto sequence = openSequence(path);
  EXPECT_EQ(sequence->info().format, "TUM RGB-D");
  EXPECT_EQ(sequence->size(), 722u);
  EXPECT_EQ(sequence->info().intrinsics, (Intrinsics{640, 480, 517.3, 516.5, 318.6, 255.3}));
  EXPECT_DOUBLE_EQ(sequence->timestamp(0), 1305031229.528784);
  const Inspection r = inspectSequence(*sequence, 10);
  EXPECT_TRUE(r.unreadable.empty());
  ASSERT_TRUE(r.speeds);
  // Published with the recording: 1.14 rad/s mean, 3.14 max.
  EXPECT_NEAR(r.speeds->angular_mean, 1.14, 0.02);
  EXPECT_NEAR(r.speeds->angular_max, 3.14, 0.1);
  EXPECT_TRUE(r.usable());
}

TEST(RealData, SevenScenes) {
  const fs::path path = findData("seven_scenes");
  SKIP_WITHOUT(path);
  const auto sequence = openSequence(path);
  EXPECT_EQ(sequence->info().format, "7-Scenes");
  EXPECT_EQ(sequence->size(), 200u);
  EXPECT_EQ(sequence->info().intrinsics, (Intrinsics{640, 480, 585, 585, 320, 240}));
  EXPECT_DOUBLE_EQ(sequence->timestamp(199), 398 / 30.0);
  EXPECT_EQ(sequence->info().truth.size(), 200u);
  EXPECT_TRUE(inspectSequence(*sequence, 10).usable());
}

}  // namespace test_real_data
}  // namespace rosefusion::testing
