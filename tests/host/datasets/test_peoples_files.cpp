// Folders as people have them: other lists, other systems, other programs. Each is read, or told with the
// remedy.
#include <gmock/gmock.h>

#include "host/datasets/inspection.h"
#include "tests/host/datasets/fixtures.h"

namespace rosefusion::testing {
namespace test_peoples_files {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::Each;
using ::testing::HasSubstr;
using ::testing::Not;

const std::string kYaml =
    "intrinsics: {fx: 30, fy: 30, cx: 15.5, cy: 11.5}\ndepth_units_per_metre: 1000\nfps: 30\n";

void makeImages(const TemporaryFolder& folder, const std::string& depth, const std::string& colour,
                int count) {
  for (int i = 0; i < count; ++i) {
    folder.writeImage(depth + "/" + std::to_string(i) + ".png", depthImage(1500 + i));
    if (!colour.empty()) folder.writeImage(colour + "/" + std::to_string(i) + ".png", colourImage(i));
  }
}

int redOf(Sequence& sequence, std::size_t index) {
  Frame frame;
  std::string problem;
  EXPECT_TRUE(sequence.read(index, frame, problem)) << problem;
  return frame.colour.empty() ? -1 : frame.colour.at<cv::Vec3b>(0, 0)[2];
}

TEST(PeoplesFiles, FrameNumbersAreKnownAsStamps) {
  const TemporaryFolder folder;
  makeImages(folder, "depth", "rgb", 12);
  std::string list, pairs, large, whole;
  for (int i = 0; i < 12; ++i) {
    const std::string n = std::to_string(i), number = std::to_string(3 * i + 7);
    list += number + " depth/" + n + ".png\n";
    pairs += number + ".000 depth/" + n + ".png " + number + ".000 rgb/" + n + ".png\n";
    large += std::to_string(1305031229 + i) + " depth/" + n + ".png\n";
    whole += std::to_string(i / 4) + " depth/" + n + ".png\n";
  }
  folder.write("depth.txt", list);
  EXPECT_DOUBLE_EQ(openSequence(folder.path())->info().seconds_per_stamp, 1 / 30.0) << "TUM RGB-D";
  folder.write("depth.txt", large);
  EXPECT_EQ(openSequence(folder.path())->info().seconds_per_stamp, 1) << "one image a second, since 1970";
  folder.write("depth.txt", whole);
  EXPECT_EQ(openSequence(folder.path())->info().seconds_per_stamp, 1) << "seconds that lost their decimals";
  folder.remove("depth.txt");
  folder.write("calibration.txt", "30 30 15.5 11.5\n");
  folder.write("associated.txt", pairs);
  const auto eth3d = openSequence(folder.path());
  EXPECT_EQ(eth3d->info().format, "ETH3D SLAM");
  EXPECT_DOUBLE_EQ(eth3d->info().seconds_per_stamp, 1 / 30.0);
  EXPECT_THAT(eth3d->info().notes, Contains(HasSubstr("frame numbers")));
  folder.write("sequence.yaml", kYaml + "timestamps: names\ndepth: depth/*.png\n");
  EXPECT_DOUBLE_EQ(openSequence(folder.path())->info().seconds_per_stamp, 1 / 30.0) << "names";
}

TEST(PeoplesFiles, NamesHoldBlanksAndCommasInEveryList) {
  const TemporaryFolder folder;
  makeImages(folder, "my depth, raw", "colour  2", 3);
  std::string pairs, list;
  for (int i = 0; i < 3; ++i) {
    const std::string n = std::to_string(i);
    pairs += n + ".5 my depth, raw/" + n + ".png " + n + ".5 \"colour  2/" + n + ".png\"\n";
    list += n + ".5 my depth, raw/" + n + ".png\n";
  }
  folder.write("associations.txt", pairs);
  const auto paired = openSequence(folder.path(), {.colour = true});
  ASSERT_EQ(paired->size(), 3u);
  EXPECT_EQ(redOf(*paired, 2), 2);
  folder.write("depth.txt", list);
  EXPECT_EQ(openSequence(folder.path())->size(), 3u);
  folder.write("depth.txt", "0.5 my depth, raw\\0.png\n0.6 my depth, raw\\1.png\n");
  EXPECT_EQ(openSequence(folder.path())->size(), 2u) << "made on Windows";
}

TEST(PeoplesFiles, Utf16ListsAreRead) {
  const TemporaryFolder folder;
  makeTum(folder);
  for (const char* name : {"depth.txt", "groundtruth.txt"}) {
    std::string wide = "\xFF\xFE";
    for (const char c : folder.read(name)) (wide += c) += '\0';
    folder.write(name, wide);
  }
  const auto sequence = openSequence(folder.path());
  EXPECT_EQ(sequence->size(), 3u);
  EXPECT_EQ(sequence->info().truth.size(), 4u);
}

TEST(PeoplesFiles, HiddenFilesAreLeftOut) {
  const TemporaryFolder folder;
  makeImages(folder, "depth", "", 3);
  const std::string fork("\0\5\x16\7\0\2\0\0Mac OS X", 16);
  for (int i = 0; i < 3; ++i) folder.write("depth/._" + std::to_string(i) + ".png", fork);
  folder.write("sequence.yaml", kYaml + "depth: depth/*.png\n");
  EXPECT_EQ(openSequence(folder.path())->size(), 3u);
  folder.write("sequence.yaml", kYaml + "depth: depth/*\n");
  EXPECT_EQ(openSequence(folder.path())->size(), 3u);
  folder.remove("sequence.yaml");
  folder.write("depth.txt",
               "0.1 depth/._0.png\n0.1 depth/0.png\n0.2 depth/._1.png\n0.2 depth/1.png\n0.3 depth/2.png\n");
  const auto listed = openSequence(folder.path());
  EXPECT_EQ(listed->size(), 3u);
  EXPECT_THAT(listed->info().warnings, Each(Not(HasSubstr("skipped"))));
}

TEST(PeoplesFiles, CalibrationsWithASizeOrAnotherMatrix) {
  const TemporaryFolder folder;
  makeTum(folder);
  const Intrinsics wanted{kWidth, kHeight, 40, 41, 15.5, 11.5};
  for (const char* text :
       {"32 24 40 41 15.5 11.5", "40 41 15.5 11.5 32 24", "32 24\n40 41\n15.5 11.5\n",
        "40 0 15.5 0\n0 41 11.5 0\n0 0 1 0\n", "40 0 15.5 0 0 41 11.5 0 0 0 1 0 0 0 0 1"}) {
    folder.write("calibration.txt", text);
    const auto sequence = openSequence(folder.path());
    EXPECT_EQ(sequence->info().intrinsics, wanted) << text;
    EXPECT_THAT(sequence->info().warnings, Each(Not(HasSubstr("calibration")))) << text;
  }
  folder.write("calibration.txt", "64 48 40 41 31.5 23.5");
  EXPECT_THAT(openingError(folder.path()), AllOf(HasSubstr("64x48"), HasSubstr("32x24")));
  folder.write("calibration.txt", "40 41 15.5 11.5 0.1 -0.1 0.001 0.001");
  EXPECT_THAT(openSequence(folder.path())->info().notes, Contains(HasSubstr("distortion")))
      << "eight numbers";
  folder.write("calibration.txt", "40 41 15.5 11.5 0.1 -0.1");
  EXPECT_THAT(openSequence(folder.path())->info().warnings, Contains(HasSubstr("holds 6 numbers")));
}

TEST(PeoplesFiles, ColourOfAnotherClockIsTold) {
  const TemporaryFolder folder;
  makeTum(folder);
  folder.write("rgb.txt",
               "1305031329.538784 rgb/1305031229.538784.png\n1305031329.572084 rgb/1305031229.572084.png\n"
               "1305031329.605384 rgb/1305031229.605384.png\n");
  EXPECT_THAT(openSequence(folder.path())->info().warnings,
              Contains(AllOf(HasSubstr("rgb.txt"), HasSubstr("0 of 3"), HasSubstr("clock"))));
  folder.write("associations.txt", "1 elsewhere/depth1.png 1 rgb/1305031229.538784.png\n");
  EXPECT_THAT(openSequence(folder.path())->info().warnings, Contains(HasSubstr("associations.txt")));
}

TEST(PeoplesFiles, ColourIsPairedByNumberWhereNamesHaveOne) {
  const TemporaryFolder folder;
  for (const char* i : {"001", "002", "004", "005"}) {
    folder.writeImage("d/depth_" + std::string(i) + ".png", depthImage(1500));
    if (std::string(i) != "002") folder.writeImage("c/" + std::string(i) + ".png", colourImage(std::stoi(i)));
  }
  folder.writeImage("c/3.png", colourImage(3));
  folder.write("sequence.yaml", kYaml + "depth: d/*.png\ncolour: c/*.png\n");
  const auto sequence = openSequence(folder.path(), {.colour = true});
  EXPECT_EQ(redOf(*sequence, 0), 1);
  EXPECT_EQ(redOf(*sequence, 1), -1) << "2 has no partner";
  EXPECT_EQ(redOf(*sequence, 2), 4);
  EXPECT_EQ(redOf(*sequence, 3), 5);
  EXPECT_THAT(sequence->info().warnings, Contains(HasSubstr("1 depth and 1 colour images have no partner")));
}

TEST(PeoplesFiles, AnOwnCameraIsNotTakenForIclNuim) {
  const TemporaryFolder folder("my_room");
  makeImages(folder, "depth", "rgb", 3);
  std::string pairs;
  for (const char* n : {"0", "1", "2"})
    pairs += std::string(n) + " depth/" + n + ".png " + n + " rgb/" + n + ".png\n";
  folder.write("associations.txt", pairs);
  const auto sequence = openSequence(folder.path());
  EXPECT_EQ(sequence->info().format, "TUM RGB-D");
  EXPECT_GT(sequence->info().intrinsics.fy, 0);
  EXPECT_DOUBLE_EQ(sequence->info().seconds_per_stamp, 1 / 30.0);
  EXPECT_THAT(sequence->info().notes, Contains(HasSubstr("ICL-NUIM")));
}

TEST(PeoplesFiles, WhatIsNoImageIsNamed) {
  const struct {
    std::string bytes;
    const char* says;
  } cases[] = {{std::string("PK\x03\x04", 4), "ZIP"},
               {"version https://git-lfs.github.com/spec/v1\noid sha256:0\n", "git lfs pull"},
               {"<!DOCTYPE html>", "web page"},
               {"\x76\x2f\x31\x01xxxx", "OPENCV_IO_ENABLE_OPENEXR"},
               {"MATLAB 5.0", "depth is read from 16-bit PNG"}};
  for (const auto& c : cases) {
    const TemporaryFolder folder;
    for (const char* n : {"0", "1"}) folder.write("d/" + std::string(n) + ".dat", c.bytes);
    folder.write("sequence.yaml", kYaml + "depth: d/*.dat\n");
    EXPECT_THAT(openingError(folder.path()), AllOf(HasSubstr(c.says), Not(HasSubstr("download it again"))));
  }
}

TEST(PeoplesFiles, AFolderWherePatternOrImageIsMeantIsNamed) {
  const TemporaryFolder folder;
  makeImages(folder, "depth", "", 3);
  for (const char* pattern : {"depth", "depth/"}) {
    folder.write("sequence.yaml", kYaml + "depth: " + pattern + "\n");
    EXPECT_THAT(openingError(folder.path()), AllOf(HasSubstr("is a folder"), HasSubstr("'depth/*.png'")));
  }
  folder.remove("sequence.yaml");
  folder.write("depth.txt", "0.1 depth\n0.2 depth\n");
  EXPECT_THAT(openingError(folder.path()), HasSubstr("is a folder"));
}

TEST(PeoplesFiles, DecimalCommasInAYamlAreNamed) {
  const TemporaryFolder folder;
  makeImages(folder, "depth", "", 3);
  folder.write("sequence.yaml",
               "intrinsics: {fx: 30, fy: 30, cx: 15.5, cy: 11.5}\ndepth_units_per_metre: '1000,5'\nfps: 30\n"
               "depth: depth/*.png\n");
  EXPECT_THAT(openingError(folder.path()), AllOf(HasSubstr("1000,5"), HasSubstr("decimals take a point")));
}

}  // namespace test_peoples_files
}  // namespace rosefusion::testing
