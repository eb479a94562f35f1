// `rosefusion check` as a user runs it: exit codes, JSON, and where the words go.
#include <gmock/gmock.h>
#include <sys/wait.h>

#include <cstdlib>
#include <nlohmann/json.hpp>

#include "apps/cli/exit_code.h"
#include "tests/host/datasets/fixtures.h"

namespace rosefusion::testing {
namespace test_check {

using ::testing::HasSubstr;

struct Outcome {
  int exit_code = -1;
  std::string output, errors;
};

Outcome check(const TemporaryFolder& scratch, const std::filesystem::path& sequence,
              const std::string& arguments = "") {
  std::string command = "'" ROSEFUSION_PROGRAM "' check '";
  command += sequence.string() + "' " + arguments + " >'" + scratch.text("out") + "' 2>'" +
             scratch.text("err") + "'";
  const int status = std::system(command.c_str());
  return {WEXITSTATUS(status), scratch.read("out"), scratch.read("err")};
}

TEST(Check, AUsableSequenceExitsWithZero) {
  const TemporaryFolder folder("fr1_desk");
  makeTum(folder, 64, 48);
  const TemporaryFolder scratch("scratch");
  const Outcome run = check(scratch, folder.path());
  EXPECT_EQ(run.exit_code, kExitOk) << run.errors;
  EXPECT_THAT(run.output, AllOf(HasSubstr("TUM RGB-D"), HasSubstr("[warning] the intrinsics are assumed")));
}

TEST(Check, JsonOnStandardOutputStaysParsable) {
  const TemporaryFolder folder;
  makeTum(folder, 64, 48);
  const TemporaryFolder scratch("scratch");
  const Outcome run = check(scratch, folder.path(), "--max-frames 2 --json -");
  ASSERT_EQ(run.exit_code, kExitOk) << run.errors;
  const auto json = nlohmann::json::parse(run.output);
  EXPECT_EQ(json["usable"], true);
  EXPECT_EQ(json["frames"], 3);
  EXPECT_EQ(json["images_read"], 2);
  EXPECT_EQ(json["intrinsics"]["assumed"], true);
  EXPECT_THAT(run.errors, HasSubstr("TUM RGB-D"));
}

TEST(Check, AWrongDepthScaleIsRefusedAndReported) {
  const TemporaryFolder folder;
  makeTum(folder, 64, 48);
  const TemporaryFolder scratch("scratch");
  const Outcome run =
      check(scratch, folder.path(),
            "--depth-units-per-metre 100000 --json '" + scratch.text("report/check.json") + "'");
  EXPECT_EQ(run.exit_code, kExitBadInput);
  EXPECT_THAT(run.output, HasSubstr("[error]"));
  EXPECT_THAT(run.errors, HasSubstr("not usable"));
  EXPECT_EQ(nlohmann::json::parse(scratch.read("report/check.json"))["usable"], false);
}

TEST(Check, AMissingFolderIsOneSentence) {
  const TemporaryFolder scratch("scratch");
  const Outcome run = check(scratch, "/nowhere/at/all");
  EXPECT_EQ(run.exit_code, kExitBadInput);
  EXPECT_EQ(run.errors, "error: /nowhere/at/all: no such file or folder; check the path.\n");
}

TEST(Check, RefusesImagesThatARunRefuses) {
  const TemporaryFolder folder;
  makeTum(folder);
  const TemporaryFolder scratch("scratch");
  const Outcome outcome = check(scratch, folder.path());
  EXPECT_EQ(outcome.exit_code, kExitBadInput);
  EXPECT_THAT(outcome.output, AllOf(HasSubstr("32x24"), HasSubstr("smaller than the largest pixel stride")));
}

}  // namespace test_check
}  // namespace rosefusion::testing
