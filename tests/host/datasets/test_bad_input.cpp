// Bad folders end in one sentence; one bad frame is skipped and the rest stays usable.
#include <gmock/gmock.h>

#include "host/core/error.h"
#include "host/datasets/sequence.h"
#include "host/datasets/truth.h"
#include "tests/host/datasets/fixtures.h"

namespace rosefusion::testing {
namespace test_bad_input {

using ::testing::Contains;
using ::testing::HasSubstr;

constexpr const char* kSecondDepth = "depth/1305031229.562084.png";

/// Reads frame 1 of `folder`, expects it to be refused and frame 2 to be readable after it; returns the
/// sentence.
std::string problemOfSecondFrame(const TemporaryFolder& folder) {
  const auto sequence = openSequence(folder.path());
  Frame frame;
  std::string problem, other;
  EXPECT_FALSE(sequence->read(1, frame, problem));
  EXPECT_TRUE(frame.depth.empty()) << "nothing half-read may leak out";
  EXPECT_THAT(problem, HasSubstr(folder.text(kSecondDepth)));
  EXPECT_TRUE(sequence->read(2, frame, other)) << other;
  EXPECT_EQ(other, "");
  return problem;
}

TEST(BadFrame, TruncatedPng) {
  for (const double share : {0.2, 0.6, 0.99}) {
    const TemporaryFolder folder;
    makeTum(folder);
    folder.truncate(kSecondDepth, share);
    EXPECT_THAT(problemOfSecondFrame(folder), HasSubstr("truncated")) << share;
  }
}

TEST(BadFrame, DamageInTheMiddle) {
  const TemporaryFolder folder;
  makeTum(folder);
  std::string bytes = folder.read(kSecondDepth);
  bytes.replace(bytes.size() / 2, 16, 16, '\x55');
  folder.write(kSecondDepth, bytes);
  EXPECT_THAT(problemOfSecondFrame(folder), HasSubstr("damaged"));
}

TEST(BadFrame, EmptyMissingOrNoImage) {
  const TemporaryFolder folder;
  makeTum(folder);
  folder.truncate(kSecondDepth, 0);
  EXPECT_THAT(problemOfSecondFrame(folder), HasSubstr("empty"));
  folder.write(kSecondDepth, "this is not an image");
  EXPECT_THAT(problemOfSecondFrame(folder), HasSubstr("cannot be decoded"));
  folder.remove(kSecondDepth);
  EXPECT_THAT(problemOfSecondFrame(folder), HasSubstr("missing"));
  std::filesystem::create_directory(folder.path() / kSecondDepth);  // opens, and cannot be read
  EXPECT_THAT(problemOfSecondFrame(folder), HasSubstr("cannot be read"));
}

TEST(BadFrame, EightBitDepth) {
  const TemporaryFolder folder;
  makeTum(folder);
  folder.writeImage(kSecondDepth, cv::Mat(kHeight, kWidth, CV_8UC1, cv::Scalar(80)));
  EXPECT_THAT(problemOfSecondFrame(folder), HasSubstr("8-bit image with 1 channel"));
  folder.writeImage(kSecondDepth, colourImage(80));
  EXPECT_THAT(problemOfSecondFrame(folder), HasSubstr("3 channels"));
}

TEST(BadFrame, AnotherSizeInMidSequence) {
  const TemporaryFolder folder;
  makeTum(folder);
  folder.writeImage(kSecondDepth, depthImage(5000, 64, 48));
  EXPECT_THAT(problemOfSecondFrame(folder), AllOf(HasSubstr("64x48"), HasSubstr("32x24")));
}

TEST(BadFrame, TheFirstOnesOwnSizeRulesNoOtherOut) {
  const TemporaryFolder folder;
  makeTum(folder);
  folder.writeImage("depth/1305031229.528784.png", depthImage(500, 64, 48));
  const auto sequence = openSequence(folder.path());
  EXPECT_EQ(sequence->info().intrinsics.width, kWidth);
  Frame frame;
  std::string problem;
  EXPECT_FALSE(sequence->read(0, frame, problem));
  EXPECT_THAT(problem, AllOf(HasSubstr("64x48"), HasSubstr("32x24")));
  EXPECT_TRUE(sequence->read(1, frame, problem));
}

TEST(BadFrame, ABadFirstFrameDoesNotStopTheSequence) {
  const TemporaryFolder folder;
  makeTum(folder);
  folder.truncate("depth/1305031229.528784.png", 0.5);
  const auto sequence = openSequence(folder.path());
  EXPECT_EQ(sequence->info().intrinsics.width, kWidth);
  EXPECT_EQ(sequence->size(), 3u);
}

TEST(BadFrame, DamagedColourLeavesTheDepth) {
  const TemporaryFolder folder;
  makeTum(folder);
  folder.truncate("rgb/1305031229.572084.png", 0.5);
  const auto sequence = openSequence(folder.path(), {.colour = true});
  Frame frame;
  std::string problem;
  EXPECT_TRUE(sequence->read(1, frame, problem));
  EXPECT_FALSE(frame.depth.empty());
  EXPECT_TRUE(frame.colour.empty());
  EXPECT_THAT(problem, HasSubstr("rgb/1305031229.572084.png"));
}

TEST(BadFrame, MissingColourIsToldOnceAtOpening) {
  const TemporaryFolder folder;
  makeTum(folder);
  folder.remove("rgb/1305031229.572084.png");
  const auto sequence = openSequence(folder.path(), {.colour = true});
  EXPECT_THAT(sequence->info().warnings, Contains(HasSubstr("1 of 3 listed colour images are missing")));
  Frame frame;
  std::string problem;
  EXPECT_TRUE(sequence->read(1, frame, problem));
  EXPECT_EQ(problem, "");
}

TEST(BadFolder, MissingEmptyUnknownOrAFile) {
  const TemporaryFolder folder;
  EXPECT_THAT(openingError(folder.path() / "gone"), AllOf(HasSubstr("gone"), HasSubstr("no such")));
  EXPECT_THAT(openingError(folder.path()), HasSubstr("the folder is empty"));
  folder.write("notes.md", "hello");
  const std::string unknown = openingError(folder.path());
  for (const char* layout :
       {"depth.txt", "ETH3D", "ICL-NUIM", "7-Scenes", "Replica", "FastCaMo", "sequence.yaml", ".seq"})
    EXPECT_THAT(unknown, HasSubstr(layout));
  EXPECT_THAT(openingError(folder.path() / "notes.md"), HasSubstr("is a file"));
}

TEST(BadFolder, AFolderTooHighPointsToTheOneInside) {
  const TemporaryFolder folder("fr1/inner");
  makeTum(folder);
  EXPECT_THAT(openingError(folder.path().parent_path()), HasSubstr("such as " + folder.path().string()));
}

TEST(BadFolder, ListsWithoutAnyGoodLine) {
  const TemporaryFolder folder;
  makeTum(folder);
  folder.write("depth.txt", "# only a comment\n");
  EXPECT_THAT(openingError(folder.path()), AllOf(HasSubstr("depth.txt"), HasSubstr("lists no images")));
  folder.remove("depth.txt");
  folder.write("associations.txt", "1.0 depth/1.png\n");
  EXPECT_THAT(openingError(folder.path()),
              AllOf(HasSubstr("associations.txt"), HasSubstr("lists no images")));
}

TEST(BadFolder, SomeBadLinesAreSkippedWithOneWarning) {
  const TemporaryFolder folder;
  makeTum(folder);
  folder.write("depth.txt",
               "1305031229.528784 depth/1305031229.528784.png\r\nnan depth/x.png\nword depth/y.png\n"
               "1305031229.562084 depth/1305031229.562084.png\n13050312");
  const auto sequence = openSequence(folder.path());
  EXPECT_EQ(sequence->size(), 2u);
  EXPECT_THAT(sequence->info().warnings, Contains(AllOf(HasSubstr("3 lines skipped"), HasSubstr("line 2"))));
}

TEST(BadFolder, NotOneReadableImage) {
  const TemporaryFolder folder;
  folder.write("depth.txt", "1.0 depth/1.png\n2.0 depth/2.png\n");
  folder.writeImage("depth/1.png", cv::Mat(kHeight, kWidth, CV_8UC1, cv::Scalar(80)));
  EXPECT_THAT(openingError(folder.path()), AllOf(HasSubstr("first 2 depth images"), HasSubstr("8-bit")));
}

TEST(BadFolder, ImplausibleIntrinsicsNameTheFile) {
  const TemporaryFolder folder;
  makeTum(folder);
  for (const char* text : {"0 0 0 0\n", "nan 30 16 12\n", "517.3 516.5 318.6 255.3\n", "30 30 -5 12\n"}) {
    folder.write("calibration.txt", text);
    EXPECT_THAT(openingError(folder.path()), AllOf(HasSubstr("calibration.txt"), HasSubstr("implausible")))
        << text;
  }
  folder.write("calibration.txt", "30 30\n");
  EXPECT_THAT(openingError(folder.path()), HasSubstr("expected four numbers"));
  folder.write("calibration.txt", "fx 30 30 16 12\n");
  EXPECT_THAT(openingError(folder.path()), HasSubstr("'fx' is not a number"));
}

TEST(BadFolder, ImplausibleOptionsAreRefused) {
  const TemporaryFolder folder;
  makeTum(folder);
  EXPECT_THROW(openSequence(folder.path(), {.intrinsics = Intrinsics{0, 0, 0, 0, 0, 0}}), InputError);
  EXPECT_THROW(openSequence(folder.path(), {.intrinsics = Intrinsics{640, 480, 525, 525, 320, 240}}),
               InputError);
  EXPECT_THROW(openSequence(folder.path(), {.depth_units_per_metre = -1}), InputError);
}

TEST(BadStamps, UnsortedFramesAreSortedWithAWarning) {
  const TemporaryFolder folder;
  makeTum(folder);
  folder.write(
      "depth.txt",
      "1305031229.595384 depth/1305031229.595384.png\n1305031229.528784 depth/1305031229.528784.png\n");
  const auto sequence = openSequence(folder.path());
  EXPECT_DOUBLE_EQ(sequence->timestamp(0), 1305031229.528784);
  EXPECT_THAT(sequence->info().warnings, Contains(HasSubstr("not ascending")));
  Frame frame;
  std::string problem;
  ASSERT_TRUE(sequence->read(0, frame, problem));
  EXPECT_EQ(frame.depth.at<std::uint16_t>(0, 0), 5000) << "images follow their stamps";
}

TEST(BadTruth, NanAndUnsortedPosesGiveWarnings) {
  const TemporaryFolder folder;
  makeTum(folder);
  folder.write("groundtruth.txt",
               "3.0 3 0 0 0 0 0 1\n1.0 1 0 0 0 0 0 1\n2.0 nan 0 0 0 0 0 1\n2.5 0 0 0 0 0 0 0\n2.6 0 0\n");
  const auto sequence = openSequence(folder.path());
  const SequenceInfo& info = sequence->info();
  ASSERT_EQ(info.truth.size(), 2u);
  EXPECT_EQ(info.truth[0].timestamp, 1.0);
  EXPECT_EQ(info.truth[1].world_from_camera.translation().x(), 3.0);
  EXPECT_THAT(info.warnings, Contains(AllOf(HasSubstr("groundtruth.txt"), HasSubstr("sorted"))));
  EXPECT_THAT(info.warnings,
              Contains(AllOf(HasSubstr("3 truth poses skipped"), HasSubstr("groundtruth.txt:3"))));
}

TEST(BadTruth, MatricesMustBeRigid) {
  Pose pose;
  const std::vector<double> identity{1, 0, 0, 4, 0, 1, 0, 5, 0, 0, 1, 6, 0, 0, 0, 1};
  ASSERT_TRUE(datasets::poseFromMatrix(identity, pose));
  EXPECT_TRUE(pose.translation().isApprox(Eigen::Vector3d(4, 5, 6)));
  std::vector<double> rounded = identity;
  rounded[1] = 0.004;
  ASSERT_TRUE(datasets::poseFromMatrix(rounded, pose));
  EXPECT_LT((pose.linear() * pose.linear().transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-12);
  for (const auto& [index, value] :
       {std::pair<std::size_t, double>{0, -1}, {0, 1.2}, {5, NAN}, {15, 0}, {3, INFINITY}}) {
    std::vector<double> wrong = identity;
    wrong[index] = value;
    EXPECT_FALSE(datasets::poseFromMatrix(wrong, pose)) << index << " = " << value;
  }
  EXPECT_FALSE(datasets::poseFromMatrix({1, 0, 0}, pose));
}

}  // namespace test_bad_input
}  // namespace rosefusion::testing
