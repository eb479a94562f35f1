// `rosefusion eval` as a user calls it.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include "apps/cli/commands.h"
#include "tests/host/core/temporary_folder.h"
#include "tests/host/evaluation/trajectories.h"

namespace rosefusion::testing {
namespace test_eval_command {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;

class EvalCommand : public ::testing::Test {
 protected:
  void SetUp() override {
    writeTumTrajectory(estimate_, moved(somewhere(), curve(60)));
    writeTumTrajectory(truth_, curve(60));
  }

  /// What the command prints.
  std::string eval(std::vector<std::string> arguments) {
    CLI::App app;
    cli::addEvalCommand(app);
    arguments.insert(arguments.begin(), "eval");
    std::reverse(arguments.begin(), arguments.end());  // CLI11 takes them from the back
    ::testing::internal::CaptureStdout();
    try {
      app.parse(arguments);
    } catch (...) {
      ::testing::internal::GetCapturedStdout();
      throw;
    }
    return ::testing::internal::GetCapturedStdout();
  }

  const TemporaryFolder folder_;
  const std::filesystem::path estimate_ = folder_ / "run/trajectory.txt",
                              truth_ = folder_ / "sequence/groundtruth.txt";
};

TEST_F(EvalCommand, PrintsHowItPairedAndAligned) {
  EXPECT_THAT(eval({estimate_, truth_}),
              AllOf(HasSubstr("60 of 60"), HasSubstr("Umeyama"), HasSubstr("ATE"), HasSubstr("100.0 %")));
}

TEST_F(EvalCommand, FindsTheFilesInFolders) {
  EXPECT_EQ(eval({folder_ / "run", folder_ / "sequence"}), eval({estimate_, truth_}));
  EXPECT_THAT(inputErrorOf([&] {
                eval({estimate_, folder_ / "run"});
              }),
              AllOf(StartsWith((folder_ / "run").string()), HasSubstr("groundtruth.txt")));
}

TEST_F(EvalCommand, FindsASequencesTruthAndStampUnit) {
  // ICL-NUIM: the truth is no groundtruth.txt and its stamps are frame numbers, 30 a second.
  const std::filesystem::path icl = folder_ / "icl";
  std::filesystem::create_directories(icl / "depth");
  std::string list;
  for (int i = 0; i < 3; ++i) {
    const std::string n = std::to_string(i), image = "depth/" + n + ".png";
    cv::imwrite(icl / image, cv::Mat(480, 640, CV_16UC1, cv::Scalar(5000 + i)));
    list += n + " " + image + " " + n + " rgb/" + n + ".png\n";
  }
  folder_.write("icl/associations.txt", list);
  EXPECT_THAT(inputErrorOf([&] {
                eval({estimate_, icl});
              }),
              AllOf(StartsWith(icl.string()), HasSubstr("ICL-NUIM"), HasSubstr("without a true trajectory")));
  Trajectory truth = curve(60), estimate = truth;
  for (std::size_t i = 0; i < 60; ++i) {
    truth[i].timestamp = estimate[i].timestamp = static_cast<double>(i);
    estimate[i].world_from_camera.translation().x() += 0.001 * static_cast<double>(i);
  }
  writeTumTrajectory(icl / "livingRoom1.gt.freiburg", truth);
  writeTumTrajectory(estimate_, estimate);
  const auto json = nlohmann::json::parse(eval({estimate_, icl, "--json", "-"}));
  EXPECT_EQ(json["common_poses"], 60);
  EXPECT_NEAR(json["rpe_second_mean_m"].get<double>(), 0.03, 1e-5);
}

TEST_F(EvalCommand, JsonReplacesTheTableOnStandardOutput) {
  const auto printed = nlohmann::json::parse(eval({estimate_, truth_, "--json", "-"}));
  EXPECT_LT(printed["ate_rmse_m"].get<double>(), 1e-6);
  eval({estimate_, truth_, "--json", folder_ / "out.json"});
  EXPECT_EQ(nlohmann::json::parse(contents(folder_ / "out.json")), printed);
}

TEST_F(EvalCommand, TakesTheFrameCountFromOptionOrReport) {
  const auto frames = [&](std::vector<std::string> more) {
    more.insert(more.begin(), {estimate_, truth_, "--json", "-"});
    return nlohmann::json::parse(eval(more))["frames"].get<int>();
  };
  EXPECT_EQ(frames({}), 60);
  folder_.write("run/report.json", R"({"frames": 80})");
  EXPECT_EQ(frames({}), 80);
  EXPECT_EQ(frames({"--frames", "100"}), 100);
  folder_.write("run/report.json", "{not json");
  EXPECT_EQ(frames({}), 60);
  EXPECT_THAT(inputErrorOf([&] { frames({"--frames", "59"}); }), HasSubstr("--frames 59"));
}

TEST_F(EvalCommand, InputsThatCannotBeComparedAreNamed) {
  const std::string empty = folder_.write("empty.txt", ""), absent = folder_ / "absent.txt";
  const std::string later = folder_.write("later.txt", "5000 0 0 0 0 0 0 1\n");
  EXPECT_THAT(inputErrorOf([&] {
                eval({empty, truth_});
              }),
              AllOf(StartsWith(empty), HasSubstr("has no poses")));
  EXPECT_THAT(inputErrorOf([&] {
                eval({estimate_, absent});
              }),
              AllOf(StartsWith(absent), HasSubstr("cannot be")));
  EXPECT_THAT(inputErrorOf([&] {
                eval({later, truth_});
              }),
              AllOf(StartsWith(later), HasSubstr("5000.000"), HasSubstr("--max-difference")));
}

TEST_F(EvalCommand, TooFewPairsAreRefusedAndFewAreWarnedOf) {
  // Stamps in milliseconds: of each sequence that starts at 0 the first pose pairs all the same.
  Trajectory estimate = curve(60);
  for (StampedPose& p : estimate) p.timestamp *= 1000;
  writeTumTrajectory(estimate_, estimate);
  EXPECT_THAT(inputErrorOf([&] {
                eval({estimate_, truth_});
              }),
              AllOf(StartsWith(estimate_.string()), HasSubstr("1 of 60"), HasSubstr("unit")));
  estimate = curve(60);
  for (std::size_t i = 2; i < 60; ++i) estimate[i].timestamp += 1000;
  writeTumTrajectory(estimate_, estimate);
  EXPECT_THAT(inputErrorOf([&] { eval({estimate_, truth_}); }), HasSubstr("2 of 60"));
  estimate[2].timestamp -= 1000;
  writeTumTrajectory(estimate_, estimate);
  EXPECT_THAT(eval({estimate_, truth_}),
              AllOf(HasSubstr("only 3 of 60 poses"), HasSubstr("check the unit"), HasSubstr("ATE")));
  writeTumTrajectory(estimate_, curve(30));
  EXPECT_THAT(eval({estimate_, truth_}), ::testing::Not(HasSubstr("check the unit")));
}

TEST_F(EvalCommand, LargeFiguresStayApartAndHintAtTheUnit) {
  Trajectory truth = curve(60);
  for (StampedPose& p : truth) p.world_from_camera.translation() *= 1000;
  writeTumTrajectory(truth_, truth);
  const std::string text = eval({estimate_, truth_});
  EXPECT_THAT(text, HasSubstr("millimetres"));
  const std::string line = text.substr(
      text.find("ATE (aligned)"), text.find('\n', text.find("ATE (aligned)")) - text.find("ATE (aligned)"));
  std::istringstream words(line);
  std::string ate, aligned, unit;
  double figures[4] = {};
  words >> ate >> aligned;
  for (double& figure : figures) EXPECT_TRUE(words >> figure) << line;
  words >> unit;
  EXPECT_EQ(unit, "cm") << line;
}

TEST_F(EvalCommand, StampsThatOccurTwiceAreTold) {
  Trajectory estimate = curve(60);
  for (StampedPose& p : estimate) p.timestamp = 1604644894;
  writeTumTrajectory(estimate_, estimate);
  writeTumTrajectory(truth_, estimate);
  EXPECT_THAT(eval({estimate_, truth_}), AllOf(HasSubstr("59 of 60"), HasSubstr("decimals were lost")));
  estimate = curve(60);
  const Trajectory second = curve(60);
  estimate.insert(estimate.end(), second.begin(), second.end());
  writeTumTrajectory(estimate_, estimate);
  writeTumTrajectory(truth_, curve(60));
  EXPECT_THAT(eval({estimate_, truth_}), AllOf(HasSubstr("60 of 120"), HasSubstr("two runs")));
}

TEST_F(EvalCommand, ATruthTooSparseToInterpolateIsNamed) {
  Trajectory sparse;
  for (std::size_t i = 0; i < 60; i += 6) sparse.push_back(curve(60)[i]);
  for (StampedPose& p : sparse) p.timestamp += 1e-3;
  writeTumTrajectory(truth_, sparse);
  EXPECT_THAT(inputErrorOf([&] {
                eval({estimate_, truth_, "--interpolate"});
              }),
              AllOf(HasSubstr("between two poses"), HasSubstr("0.2 s apart"), HasSubstr("--max-difference")));
}

}  // namespace test_eval_command
}  // namespace rosefusion::testing
