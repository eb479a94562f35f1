// Names of cameras, and what is said where there is none.
#include "host/sources/camera.h"
#include "host/sources/open_source.h"
#include "tests/host/core/temporary_folder.h"

namespace rosefusion::testing {
namespace test_cameras {

using ::testing::HasSubstr;

TEST(Cameras, AreKnownByTheirNames) {
  std::string device;
  ASSERT_TRUE(cameraKindOf("openni2:", device));
  EXPECT_EQ(device, "");
  const CameraKind* kind = cameraKindOf("realsense:0123", device);
  ASSERT_TRUE(kind);
  EXPECT_STREQ(kind->name, "realsense");
  EXPECT_EQ(device, "0123");
  EXPECT_FALSE(cameraKindOf("my_folder", device));
  EXPECT_FALSE(cameraKindOf("openni2", device));
  EXPECT_TRUE(isLiveSource("k4a:"));
  EXPECT_TRUE(isLiveSource("tcp://*:5555"));
  EXPECT_FALSE(isLiveSource("tcp"));
}

TEST(Cameras, AMissingOneIsOneSentenceThatSaysWhatToDo) {
  for (const CameraKind& kind : cameraKinds()) {
    const std::string text = std::string(kind.name) + ":/nowhere/at.all";
    const std::string said = inputErrorOf([&] { openSource(text, {}); });
    EXPECT_THAT(said, HasSubstr(kind.name));
    EXPECT_THAT(said, HasSubstr(kind.open ? kind.name : kind.library));
  }
}

TEST(Cameras, RefuseWhatOnlyRecordingsCanDo) {
  SourceOptions options;
  options.selection.stride = 2;
  EXPECT_THAT(inputErrorOf([&] { openSource("openni2:", options); }), HasSubstr("--stride"));
  options = {};
  options.pace = Pace::Recorded;
  EXPECT_THAT(inputErrorOf([&] { openSource("openni2:", options); }), HasSubstr("--realtime"));
}

}  // namespace test_cameras
}  // namespace rosefusion::testing
