// `rosefusion eval` as a user calls it.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "apps/cli/commands.h"
#include "tests/host/base/temporary_folder.h"
#include "tests/host/evaluation/trajectories.h"

namespace rosefusion {
namespace {

using ::testing::AllOf;
using testing::contents;
using testing::curve;
using ::testing::HasSubstr;
using testing::inputErrorOf;
using ::testing::StartsWith;
using testing::TemporaryFolder;

class EvalCommand : public ::testing::Test {
 protected:
  void SetUp() override {
    writeTumTrajectory(estimate_, testing::moved(testing::somewhere(), curve(60)));
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

TEST_F(EvalCommand, JsonReplacesTheTableOnStandardOutput) {
  const auto printed = nlohmann::json::parse(eval({estimate_, truth_, "--json", "-"}));
  EXPECT_LT(printed["ate_rmse_m"].get<double>(), 1e-6);
  eval({estimate_, truth_, "--json", folder_ / "out.json"});
  EXPECT_EQ(nlohmann::json::parse(contents(folder_ / "out.json")), printed);
}

TEST_F(EvalCommand, TakesTheNumberOfFramesFromTheOptionOrTheRunsReport) {
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

}  // namespace
}  // namespace rosefusion
