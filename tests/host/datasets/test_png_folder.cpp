// Plain folders described by a sequence.yaml.
#include <gmock/gmock.h>

#include "host/datasets/sequence.h"
#include "tests/host/datasets/fixtures.h"

namespace rosefusion::testing {
namespace test_png_folder {

using ::testing::HasSubstr;

const std::string kCamera = "intrinsics: {fx: 30, fy: 31, cx: 15.5, cy: 11.5}\ndepth_units_per_metre: 1000\n";

void makeImages(const TemporaryFolder& folder) {
  for (const int i : {1, 2, 10}) {
    folder.writeImage("d/image" + std::to_string(i) + ".png", depthImage(1000 + i));
    folder.writeImage("c/image" + std::to_string(i) + ".png", colourImage(i));
  }
  for (const char* name : {"e/a.png", "e/b.png"}) folder.writeImage(name, colourImage(1));
}

TEST(PngFolder, ReadsFramesInNaturalOrder) {
  const TemporaryFolder folder;
  makeImages(folder);
  folder.write("truth.txt", "0 1 2 3 0 0 0 1\n0.1 1 2 4 0 0 0 1\n");
  folder.write("sequence.yaml",
               kCamera + "fps: 20\ndepth: d/*.png\ncolour: c/*.png\ntrajectory: truth.txt\n");
  const auto sequence = openSequence(folder.path(), {.colour = true});
  const SequenceInfo& info = sequence->info();
  EXPECT_EQ(info.format, "PNG folder");
  EXPECT_EQ(info.intrinsics, (Intrinsics{kWidth, kHeight, 30, 31, 15.5, 11.5}));
  EXPECT_FALSE(info.intrinsics_assumed);
  EXPECT_EQ(info.depth_units_per_metre, 1000);
  EXPECT_EQ(info.truth.size(), 2u);
  ASSERT_EQ(sequence->size(), 3u);
  EXPECT_DOUBLE_EQ(sequence->timestamp(2), 0.1);
  Frame frame;
  std::string problem;
  ASSERT_TRUE(sequence->read(2, frame, problem)) << problem;
  EXPECT_EQ(frame.depth.at<std::uint16_t>(0, 0), 1010) << "image10 comes after image2";
  EXPECT_EQ(frame.colour.at<cv::Vec3b>(0, 0)[2], 10);
}

TEST(PngFolder, TimestampsCanComeFromTheNames) {
  const TemporaryFolder folder;
  folder.writeImage("1305031229.75.png", depthImage(1000));
  folder.writeImage("1305031229.5.png", depthImage(1001));
  folder.write("sequence.yaml", kCamera + "timestamps: names\ndepth: '*.png'\n");
  const auto sequence = openSequence(folder.path());
  EXPECT_DOUBLE_EQ(sequence->timestamp(0), 1305031229.5);
  EXPECT_DOUBLE_EQ(sequence->timestamp(1), 1305031229.75);
}

TEST(PngFolder, WinsOverOtherLayouts) {
  const TemporaryFolder folder;
  makeTum(folder);
  folder.write("sequence.yaml", kCamera + "timestamps: names\ndepth: depth/*.png\n");
  EXPECT_EQ(openSequence(folder.path())->info().format, "PNG folder");
}

TEST(PngFolder, EachMistakeInTheYamlNamesFileAndKey) {
  const struct {
    std::string yaml;
    const char* says;
  } cases[] = {
      {kCamera + "fps: 30\ndepth: d/*.png\nfpz: 3\n", "unknown key 'fpz'"},
      {kCamera + "fps: 30\n", "'depth' is missing"},
      {kCamera + "depth: d/*.png\n", "'fps' is missing"},
      {kCamera + "fps: fast\ndepth: d/*.png\n", "'fps' has the wrong type"},
      {kCamera + "fps: 0\ndepth: d/*.png\n", "'fps' must be"},
      {kCamera + "fps: 30\ndepth: nothing/*.png\n", "no file matches 'nothing/*.png'"},
      {kCamera + "fps: 30\ndepth: d/*.png\ncolour: e/*.png\n", "3 depth but 2 colour"},
      {kCamera + "fps: 30\ndepth: d/*.png\ntrajectory: gone.txt\n", "gone.txt, which is missing"},
      {kCamera + "timestamps: names\ndepth: d/*.png\n", "image1.png"},
      {"intrinsics: {fx: 30}\ndepth_units_per_metre: 1000\nfps: 30\ndepth: d/*.png\n", "'fy' is missing"},
      {"- a\n- b\n", "expected a map"},
      {"intrinsics: [", "not valid YAML"},
      {"intrinsics: {fx: 0, fy: 0, cx: 15.5, cy: 11.5}\ndepth_units_per_metre: 1000\nfps: 30\ndepth: "
       "d/*.png\n",
       "implausible camera intrinsics"},
      {"intrinsics: {fx: .nan, fy: 30, cx: 15.5, cy: 11.5}\ndepth_units_per_metre: 1000\nfps: 30\ndepth: "
       "d/*.png\n",
       "finite"},
      {"intrinsics: {fx: 30, fy: 30, cx: 15.5, cy: 11.5}\ndepth_units_per_metre: 0\nfps: 30\ndepth: "
       "d/*.png\n",
       "depth_units_per_metre is 0"}};
  for (const auto& c : cases) {
    const TemporaryFolder folder;
    makeImages(folder);
    folder.write("sequence.yaml", c.yaml);
    EXPECT_THAT(openingError(folder.path()), AllOf(HasSubstr(folder.path().string()), HasSubstr(c.says)));
  }
}

}  // namespace test_png_folder
}  // namespace rosefusion::testing
