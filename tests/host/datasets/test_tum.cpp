// TUM RGB-D and the layouts derived from it: ETH3D and ICL-NUIM.
#include <gmock/gmock.h>

#include <opencv2/core.hpp>
#include <optional>

#include "host/datasets/association.h"
#include "host/datasets/sequence.h"
#include "tests/host/datasets/fixtures.h"

namespace rosefusion::testing {
namespace test_tum {

using ::testing::HasSubstr;

Frame readGood(Sequence& sequence, std::size_t index) {
  Frame frame;
  std::string problem;
  EXPECT_TRUE(sequence.read(index, frame, problem)) << problem;
  EXPECT_EQ(problem, "");
  return frame;
}

TEST(Tum, ReadsFramesStampsAndTruth) {
  const TemporaryFolder folder;
  makeTum(folder);
  folder.write("calibration.txt", "30.5 30.25 15.5 11.5\n");
  const auto sequence = openSequence(folder.path());
  const SequenceInfo& info = sequence->info();
  EXPECT_EQ(info.format, "TUM RGB-D");
  EXPECT_EQ(info.depth_units_per_metre, 5000);
  EXPECT_EQ(info.seconds_per_stamp, 1);
  EXPECT_TRUE(info.has_colour);
  EXPECT_TRUE(info.warnings.empty());
  ASSERT_EQ(sequence->size(), 3u);
  EXPECT_DOUBLE_EQ(sequence->timestamp(1), 1305031229.562084);
  const Frame frame = readGood(*sequence, 1);
  EXPECT_DOUBLE_EQ(frame.timestamp, 1305031229.562084);
  EXPECT_EQ(frame.depth.type(), CV_16UC1);
  EXPECT_EQ(cv::countNonZero(frame.depth != depthImage(5100)), 0);
  EXPECT_TRUE(frame.colour.empty()) << "colour was not asked for";
  ASSERT_EQ(info.truth.size(), 4u);
  EXPECT_DOUBLE_EQ(info.truth[3].timestamp, 1305031229.62);
  EXPECT_NEAR(info.truth[3].world_from_camera.translation().x(), 1.3, 1e-12);
  EXPECT_NEAR(rotationAngle(info.truth[3].world_from_camera), 1.5707963, 1e-6);
}

TEST(Tum, TakesTheNearestColourImage) {
  const TemporaryFolder folder;
  makeTum(folder);
  const auto sequence = openSequence(folder.path(), {.colour = true});
  const Frame frame = readGood(*sequence, 2);
  ASSERT_EQ(frame.colour.type(), CV_8UC3);
  EXPECT_EQ(frame.colour.at<cv::Vec3b>(5, 5), cv::Vec3b(10, 20, 105));
}

TEST(Tum, ColourTooFarAwayInTimeIsNoColour) {
  const TemporaryFolder folder;
  makeTum(folder);
  folder.write("rgb.txt", "1305031229.572084 rgb/1305031229.572084.png\n");
  const auto sequence = openSequence(folder.path(), {.colour = true});
  EXPECT_TRUE(readGood(*sequence, 0).colour.empty());
  EXPECT_EQ(readGood(*sequence, 1).colour.at<cv::Vec3b>(0, 0)[2], 104);
}

TEST(Tum, AssociationsOverrideNearestStamps) {
  // Deliberately crossed: the middle depth frame with the last colour image.
  const std::string depth = "1305031229.562084 depth/1305031229.562084.png";
  const std::string colour = "1305031229.605384 rgb/1305031229.605384.png";
  for (const std::string& line : {depth + " " + colour, colour + " " + depth}) {
    const TemporaryFolder folder;
    makeTum(folder);
    folder.write("associations.txt", line + "\n");
    const auto sequence = openSequence(folder.path(), {.colour = true});
    EXPECT_EQ(sequence->info().format, "TUM RGB-D");
    ASSERT_EQ(sequence->size(), 3u) << "depth.txt lists the frames; associations only add colour";
    EXPECT_EQ(readGood(*sequence, 1).colour.at<cv::Vec3b>(0, 0)[2], 105) << line;
    EXPECT_TRUE(readGood(*sequence, 0).colour.empty());
  }
}

TEST(Tum, AssociationsAloneListTheFrames) {
  const TemporaryFolder folder("rgbd_dataset_freiburg2_xyz");
  makeTum(folder);
  folder.remove("depth.txt");
  folder.write("associations.txt",
               "1305031229.538784 rgb/1305031229.538784.png 1305031229.528784 depth/1305031229.528784.png\n"
               "1305031229.605384 rgb/1305031229.605384.png 1305031229.595384 depth/1305031229.595384.png\n");
  const auto sequence = openSequence(folder.path());
  EXPECT_EQ(sequence->info().format, "TUM RGB-D");
  ASSERT_EQ(sequence->size(), 2u);
  EXPECT_DOUBLE_EQ(sequence->timestamp(1), 1305031229.595384) << "the depth image's stamp, not the colour's";
}

TEST(Tum, TellsTheColumnsByTheImagesWhenNamesDoNot) {
  const TemporaryFolder folder;
  folder.writeImage("a/0.png", colourImage(50));
  folder.writeImage("b/0.png", depthImage(2000));
  folder.write("associations.txt", "0.25 a/0.png 0.5 b/0.png\n");
  std::vector<std::string> warnings;
  const auto result = datasets::readAssociations(folder.path() / "associations.txt", warnings);
  EXPECT_FALSE(result.depth_first);
  ASSERT_EQ(result.frames.size(), 1u);
  EXPECT_EQ(result.frames[0].timestamp, 0.5);
  EXPECT_EQ(result.frames[0].depth, folder.path() / "b/0.png");
}

TEST(Tum, IntrinsicsFollowTheNameAsAssumed) {
  const struct {
    const char* folder;
    Intrinsics expected;  // for 640x480 images
  } cases[] = {{"rgbd_dataset_freiburg1_rpy", {640, 480, 517.3, 516.5, 318.6, 255.3}},
               {"rgbd_dataset_freiburg2_xyz", {640, 480, 520.9, 521.0, 325.1, 249.7}},
               {"fr3_office", {640, 480, 535.4, 539.2, 320.1, 247.6}},
               {"fr12_other", {640, 480, 525.0, 525.0, 319.5, 239.5}},
               {"kitchen", {640, 480, 525.0, 525.0, 319.5, 239.5}}};
  for (const auto& c : cases) {
    const TemporaryFolder folder(c.folder);
    folder.write("depth.txt", "1.0 depth/1.png\n");
    folder.writeImage("depth/1.png", depthImage(5000, 640, 480));
    const auto sequence = openSequence(folder.path());
    EXPECT_EQ(sequence->info().intrinsics, c.expected) << c.folder;
    EXPECT_TRUE(sequence->info().intrinsics_assumed);
  }
}

// The 4 x 4 mark of the raw image and where it is found once the lens is taken out: mean pixel, none when
// gone.
std::optional<cv::Point2d> markSeen(const std::string& calibration, cv::Point mark, SequenceOptions options) {
  const TemporaryFolder folder;
  folder.write("depth.txt", "1.0 depth/1.png\n");
  if (!calibration.empty()) folder.write("calibration.txt", calibration);
  cv::Mat raw(480, 640, CV_16UC1, cv::Scalar(5000));
  raw(cv::Rect(mark.x - 1, mark.y - 1, 4, 4)) = 9000;
  folder.writeImage("depth/1.png", raw);
  const auto sequence = openSequence(folder.path(), options);
  const cv::Mat marked = readGood(*sequence, 0).depth == 9000;
  std::vector<cv::Point> pixels;
  for (int v = 0; v < marked.rows; ++v)
    for (int u = 0; u < marked.cols; ++u)
      if (marked.at<std::uint8_t>(v, u)) pixels.emplace_back(u, v);
  if (pixels.empty()) return std::nullopt;
  cv::Point2d sum(0, 0);
  for (const cv::Point& pixel : pixels) sum += cv::Point2d(pixel);
  return sum / static_cast<double>(pixels.size());
}

TEST(Tum, TakesTheLensOutOfTheImages) {
  // By hand for k1 = 0.2, p2 = 0.01: (0.5, 0.25) has r2 = 0.3125 and is imaged at
  // x = 0.5 * 1.0625 + 0.01 * (0.3125 + 0.5) = 0.539375, y = 0.25 * 1.0625 + 2 * 0.01 * 0.125 = 0.268125;
  // with f = 400, c = (320, 240): pinhole pixel (520, 340), raw pixel (535.75, 347.25).
  const std::string pinhole = "400 400 320 240";
  const auto found = markSeen(pinhole + " 0.2 0 0 0.01 0", {535, 347}, {});
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->x, 520, 1);
  EXPECT_NEAR(found->y, 340, 1);
  const cv::Point2d raw(535.5, 347.5);  // the mark's own middle
  EXPECT_EQ(markSeen(pinhole, {535, 347}, {}), raw);
  EXPECT_EQ(
      markSeen(pinhole + " 0.2 0 0 0.01 0", {535, 347}, {.intrinsics = Intrinsics{0, 0, 400, 400, 320, 240}}),
      raw)
      << "given intrinsics speak of images as they are";
}

TEST(Tum, AnAbsurdLensIsRefused) {
  const TemporaryFolder folder;
  makeTum(folder);
  for (const char* lens : {"1e300 0 0 0 0", "0 0 0 0 -11"}) {
    folder.write("calibration.txt", std::string("30.5 30.25 15.5 11.5 ") + lens);
    EXPECT_THAT(openingError(folder.path()), HasSubstr(folder.text("calibration.txt"))) << lens;
  }
}

TEST(Tum, APublishedCameraHasItsLens) {
  const cv::Point2d raw(570.5, 400.5);
  const auto fr1 = markSeen("517.3 516.5 318.6 255.3", {570, 400}, {});
  ASSERT_TRUE(fr1);
  EXPECT_GT(raw.x - fr1->x, 3);
  EXPECT_GT(raw.y - fr1->y, 2);
  EXPECT_EQ(markSeen("517.4 516.5 318.6 255.3", {570, 400}, {}), raw);
  EXPECT_EQ(markSeen("535.4 539.2 320.1 247.6", {570, 400}, {}), raw) << "freiburg3's images have none";
}

TEST(Tum, ARenamedFolderIsKnownByItsListsComment) {
  const TemporaryFolder folder("my_copy");
  folder.write("depth.txt",
               "# depth maps\n# file: 'rgbd_dataset_freiburg3_long_office_household.bag'\n1.0 depth/1.png\n");
  folder.writeImage("depth/1.png", depthImage(5000, 640, 480));
  EXPECT_EQ(openSequence(folder.path())->info().intrinsics.fx, 535.4);
}

TEST(Tum, AssumedIntrinsicsAreScaledToTheImages) {
  const TemporaryFolder folder;
  makeTum(folder);
  for (const char* stamp : {"1305031229.528784", "1305031229.562084", "1305031229.595384"})
    folder.writeImage(std::string("depth/") + stamp + ".png", depthImage(5000, 320, 240));
  const auto sequence = openSequence(folder.path());
  const Intrinsics& k = sequence->info().intrinsics;
  EXPECT_EQ(k.width, 320);
  EXPECT_DOUBLE_EQ(k.fx, 262.5);
  EXPECT_DOUBLE_EQ(k.cx, 159.5) << "the middle stays the middle: pixel centres have integer coordinates";
  ASSERT_EQ(sequence->info().warnings.size(), 1u);
  EXPECT_THAT(sequence->info().warnings[0], HasSubstr("scaled to 320x240"));
}

TEST(Tum, FileNamesMayHoldSpaces) {
  const TemporaryFolder folder;
  makeTum(folder);
  folder.writeImage("my depth/a b.png", depthImage(700));
  folder.write("depth.txt", "1305031229.5 my depth/a b.png\n1305031229.6 not there.png\n");
  const auto sequence = openSequence(folder.path());
  ASSERT_EQ(sequence->size(), 1u);
  EXPECT_EQ(readGood(*sequence, 0).depth.at<std::uint16_t>(0, 0), 700);
}

TEST(Tum, CalibrationMayBeAMatrix) {
  const TemporaryFolder folder;
  makeTum(folder);
  folder.write("calibration.txt", "40 0 15.5\n0 41 11.5\n0 0 1\n");
  const Intrinsics k = openSequence(folder.path())->info().intrinsics;
  EXPECT_EQ(Eigen::Vector4d(k.fx, k.fy, k.cx, k.cy), Eigen::Vector4d(40, 41, 15.5, 11.5));
}

TEST(Tum, CalibrationFileAndOptionsWin) {
  const TemporaryFolder folder;
  makeTum(folder);
  folder.write("calibration.txt", "30.5 30.25 15.5 11.5\n");
  const auto by_file = openSequence(folder.path());
  EXPECT_EQ(by_file->info().intrinsics, (Intrinsics{kWidth, kHeight, 30.5, 30.25, 15.5, 11.5}));
  EXPECT_FALSE(by_file->info().intrinsics_assumed);
  EXPECT_THAT(by_file->info().intrinsics_source, HasSubstr("calibration.txt"));
  const auto by_caller = openSequence(
      folder.path(), {.intrinsics = Intrinsics{0, 0, 40, 41, 16, 12}, .depth_units_per_metre = 1000});
  EXPECT_EQ(by_caller->info().intrinsics, (Intrinsics{kWidth, kHeight, 40, 41, 16, 12}));
  EXPECT_EQ(by_caller->info().depth_units_per_metre, 1000);
}

TEST(Eth3d, ReadsCalibrationAndAssociated) {
  const TemporaryFolder folder("camera_shake_1");
  makeTum(folder);
  folder.write("calibration.txt", "28.5 28.5 16.1 11.9\n");
  folder.write("associated.txt",
               "1305031229.538784 rgb/1305031229.538784.png 1305031229.528784 depth/1305031229.528784.png\n"
               "1305031229.572084 rgb/1305031229.572084.png 1305031229.562084 depth/1305031229.562084.png\n"
               "1305031229.605384 rgb/1305031229.605384.png 1305031229.595384 depth/1305031229.595384.png\n");
  const auto sequence = openSequence(folder.path(), {.colour = true});
  const SequenceInfo& info = sequence->info();
  EXPECT_EQ(info.format, "ETH3D SLAM");
  EXPECT_EQ(info.depth_units_per_metre, 5000);
  EXPECT_EQ(info.intrinsics, (Intrinsics{kWidth, kHeight, 28.5, 28.5, 16.1, 11.9}));
  EXPECT_FALSE(info.intrinsics_assumed);
  EXPECT_EQ(info.truth.size(), 4u);
  ASSERT_EQ(sequence->size(), 3u);
  EXPECT_EQ(readGood(*sequence, 0).colour.at<cv::Vec3b>(0, 0)[2], 103);
}

TEST(IclNuim, KeepsNegativeFyAndFrameNumbersAsStamps) {
  const TemporaryFolder folder("living_room_traj1_frei_png");
  std::string list;
  for (int i = 0; i < 3; ++i) {
    const std::string n = std::to_string(i);
    list += n + " depth/" + n + ".png " + n + " rgb/" + n + ".png\n";
    folder.writeImage("depth/" + n + ".png", depthImage(5000 + i, 640, 480));
    folder.writeImage("rgb/" + n + ".png", colourImage(i, 640, 480));
  }
  folder.write("associations.txt", list);
  for (const bool with_truth : {false, true}) {
    if (with_truth)
      folder.write("livingRoom1.gt.freiburg",
                   "1 0 0 -2.25 0 0 0 1\n2 -0.000466347 0.00895357 -2.24935 0 0 0 1\n");
    const auto sequence = openSequence(folder.path(), {.colour = true});
    const SequenceInfo& info = sequence->info();
    EXPECT_EQ(info.format, "ICL-NUIM");
    EXPECT_EQ(info.intrinsics, (Intrinsics{640, 480, 481.2, -480.0, 319.5, 239.5}));
    EXPECT_EQ(info.depth_units_per_metre, 5000);
    EXPECT_EQ(sequence->timestamp(2), 2);
    EXPECT_DOUBLE_EQ(info.seconds_per_stamp, 1 / 30.0);
    EXPECT_EQ(readGood(*sequence, 2).colour.at<cv::Vec3b>(0, 0)[2], 2);
    EXPECT_LT(info.intrinsics.unproject(319.5, 300, 1).y(), 0) << "negative fy: y grows upwards in the image";
    ASSERT_EQ(info.truth.size(), with_truth ? 2u : 0u);
    if (with_truth) {
      EXPECT_EQ(info.truth[0].timestamp, 1);
    }
  }
}

TEST(Association, NearestStampWithinTheLimitIsChosen) {
  const auto nearest = datasets::associateNearest({1.0, 2.0, 3.0}, {2.015, 0.99, 1.995, 3.5}, 0.02);
  EXPECT_EQ(nearest[0], std::optional<std::size_t>(1));
  EXPECT_EQ(nearest[1], std::optional<std::size_t>(2));
  EXPECT_FALSE(nearest[2]);
  EXPECT_FALSE(datasets::associateNearest({1.0}, {}, 0.02)[0]);
}

}  // namespace test_tum
}  // namespace rosefusion::testing
