// The self-test of a device's sums runs once for each driver, and a device that fails it is named.
#include "host/slam/device_sums.h"

#include <gmock/gmock.h>

#include "tests/host/core/temporary_folder.h"

namespace rosefusion::testing {
namespace test_device_sums {

class DeviceSums : public ::testing::Test {
 protected:
  bool ask(bool truth) {
    return sumsAreExact(
        file, device,
        [&] {
          ++tests;
          return truth;
        },
        [&](Severity, const std::string& sentence) { said.push_back(sentence); });
  }

  TemporaryFolder folder;
  std::filesystem::path file = folder / "cache/compensated_sums.txt";
  DeviceInfo device{.name = "Card", .driver = "driver 1", .api_version = "1.3.0"};
  int tests = 0;
  std::vector<std::string> said;
};

TEST_F(DeviceSums, AreTestedOnceForEachDriver) {
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(ask(true));
  EXPECT_EQ(tests, 1);
  device.driver = "driver 2";
  for (int i = 0; i < 3; ++i) EXPECT_FALSE(ask(false));
  EXPECT_EQ(tests, 2);
  device.driver = "driver 1";
  EXPECT_TRUE(ask(false)) << "the file knows better";
  device.name = "Another card";
  EXPECT_TRUE(ask(true));
  EXPECT_EQ(tests, 3);
}

TEST_F(DeviceSums, ThatAreNotExactAreSaidEachTime) {
  EXPECT_TRUE(ask(true));
  EXPECT_THAT(said, ::testing::IsEmpty());
  device.driver = "driver 2";
  ask(false);
  ask(false);
  EXPECT_THAT(said, ::testing::ElementsAre(::testing::HasSubstr("Card: this driver (driver 2)"),
                                           ::testing::HasSubstr("loses accuracy")));
}

TEST_F(DeviceSums, AreTestedEachTimeWhereNothingCanBeKept) {
  file = folder.write("plain file", "noise\nexact: \n") / "compensated_sums.txt";
  EXPECT_TRUE(ask(true));
  EXPECT_TRUE(ask(true));
  EXPECT_EQ(tests, 2);
  file.clear();
  EXPECT_FALSE(ask(false));
  EXPECT_EQ(tests, 3);
}

TEST_F(DeviceSums, ADamagedFileIsNoVerdict) {
  std::filesystem::create_directories(file.parent_path());
  std::ofstream(file) << "exact: Card, driver 1, Vulkan 1.3\nnot exact\n\n";
  EXPECT_FALSE(ask(false));
  EXPECT_EQ(tests, 1);
}

}  // namespace test_device_sums
}  // namespace rosefusion::testing
