// The program as a user meets it: help, bad input in one sentence with the right exit code, Ctrl-C.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <array>
#include <cstdio>
#include <opencv2/imgcodecs.hpp>

#include "apps/cli/exit_code.h"
#include "tests/host/core/temporary_folder.h"

namespace rosefusion::testing {
namespace test_command_line {

using ::testing::HasSubstr;
using ::testing::Not;

struct Outcome {
  int code = -1;
  std::string text;  ///< standard output and error
};

Outcome program(const std::string& arguments, const std::string& environment = "") {
  const std::string line = environment + " " + ROSEFUSION_PROGRAM + " " + arguments + " 2>&1";
  std::FILE* pipe = popen(line.c_str(), "r");
  Outcome outcome;
  std::array<char, 4096> chunk;
  while (const auto n = std::fread(chunk.data(), 1, chunk.size(), pipe)) outcome.text.append(chunk.data(), n);
  const int status = pclose(pipe);
  outcome.code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  return outcome;
}

TEST(CommandLine, EverySubcommandHasHelpWithAnExample) {
  for (const char* name : {"run", "check", "eval", "eval-mesh", "synth", "pst", "devices", "doctor", "bench",
                           "experiment", "send", "record"}) {
    const Outcome help = program(std::string(name) + " --help");
    EXPECT_EQ(help.code, 0) << name;
    EXPECT_THAT(help.text, HasSubstr("xample")) << name;
    EXPECT_THAT(help.text, HasSubstr("--json")) << name;
  }
}

TEST(CommandLine, BadInputEndsInOneSentenceThatNamesIt) {
  const TemporaryFolder folder;
  struct Case {
    std::string arguments;
    std::string named;
  };
  const std::string empty = folder.path().string();
  for (const Case& c : {Case{"run /nowhere/at/all", "/nowhere/at/all"},
                        Case{"run " + empty, empty},
                        Case{"run " + empty + " --set volume.size=3", "volume.size"},
                        Case{"run " + empty + " --config nosuch.yaml", "nosuch.yaml"},
                        Case{"run " + empty + " --sensor webcam", "--sensor: "},
                        Case{"check " + empty, empty},
                        Case{"eval /nowhere/a /nowhere/b", "/nowhere/"},
                        Case{"export " + empty + " --to a.glb", "report.json"},
                        Case{"eval-mesh /nowhere/a.ply /nowhere/b.ply", "/nowhere/a.ply"},
                        Case{"pst --inspect /nowhere/p.bin", "/nowhere/p.bin"},
                        Case{"bench --suite tracking --meshes /nowhere/meshes", "/nowhere/meshes"},
                        Case{"bench --suite tracking --meshes " + empty, empty},
                        Case{"bench --suite tracking --sequence /nowhere/s", "/nowhere/s"},
                        Case{"bench --suite tracking --rooms 0", "--rooms"},
                        Case{"bench --suite sensors --sensor sonar", "--sensor: "},
                        Case{"bench --suite tracking --scene desk", "--scene"},
                        Case{"bench --suite tracking --repeat 3", "--repeat"},
                        Case{"bench --rooms 3", "--rooms"},
                        Case{"bench --history /dev/null/h.jsonl", "/dev/null"},
                        Case{"bench --compare /nowhere/a.json /nowhere/b.json", "/nowhere/a.json"},
                        Case{"bench --suite tracking --compare a b", "--compare"},
                        Case{"bench --suite tracking --max-speed 90", "--max-speed"},
                        Case{"synth " + empty + "/s --noise loud", "--noise"},
                        Case{"synth " + empty + "/s --motion rotation --speed 2", "--speed"},
                        Case{"synth " + empty + "/s --motion linear --loops 3", "--loops"},
                        Case{"synth " + empty + "/s --replay-speed 2", "--replay-speed"},
                        Case{"synth " + empty + "/s --replay /nowhere/t.txt --angular 1", "--angular"},
                        Case{"synth " + empty + "/s --replay /nowhere/t.txt --motion 6d", "--motion 6d"},
                        Case{"bench --suite network --sequence " + empty + " --seed 3", "--seed"},
                        Case{"run openni2:/nowhere/file.oni", "openni2"},
                        Case{"send " + empty + " nowhere:1", "nowhere:1"},
                        Case{"send " + empty + " tcp://localhost:5555", empty},
                        Case{"run tcp://127.0.0.1:5555 --stride 2", "--stride"},
                        Case{"run tcp://127.0.0.1:70000", "70000"},
                        Case{"run tcp://127.0.0.1", "port"},
                        Case{"run " + empty + " --secret-key k --peer-key p", "--secret-key"},
                        Case{"run " + empty + " --silence-limit 3", "--silence-limit"},
                        Case{"experiment nosuch --out " + empty, "nosuch"},
                        Case{"run tcp://127.0.0.1:5555 --secret-key /nowhere/k", "--peer-key"}}) {
    const Outcome outcome = program(c.arguments);
    EXPECT_EQ(outcome.code, kExitBadInput) << c.arguments << "\n" << outcome.text;
    EXPECT_THAT(outcome.text, HasSubstr(c.named)) << c.arguments;
    EXPECT_THAT(outcome.text, Not(HasSubstr("terminate called"))) << c.arguments;
  }
}

TEST(CommandLine, UnknownArgumentsAreRefused) {
  EXPECT_EQ(program("reconstruct").code, kExitBadInput);
  EXPECT_EQ(program("run somewhere --no-such-option").code, kExitBadInput);
  EXPECT_EQ(program("").code, kExitBadInput);
  EXPECT_THAT(program("reconstruct").text, HasSubstr("'reconstruct'"));
  EXPECT_THAT(program("run somewhere --max-frames -1").text, HasSubstr("--max-frames"));
  EXPECT_THAT(program("run somewhere --depth-units-per-metre nan").text,
              HasSubstr("'nan' is not a number above 0"));
}

TEST(CommandLine, MistakesHarmNoRecordingOrResult) {
  const TemporaryFolder folder;
  const std::string sequence = (folder / "s").string(), out = (folder / "o").string();
  ASSERT_EQ(program("synth " + sequence + " --frames 3 --width 64 --height 48").code, 0);
  const Outcome onto_itself = program("run " + sequence + " --out " + sequence);
  EXPECT_EQ(onto_itself.code, kExitBadInput);
  EXPECT_THAT(onto_itself.text, HasSubstr("--out"));
  EXPECT_TRUE(std::filesystem::exists(folder / "s" / "mesh.ply"));
  const Outcome good = program("run s --out " + out, "cd " + folder.path().string() + " &&");
  ASSERT_EQ(good.code, 0) << good.text;
  EXPECT_THAT(program("run " + sequence + " --out " + out).text, Not(HasSubstr("is replaced")));
  std::filesystem::copy(sequence, folder / "t", std::filesystem::copy_options::recursive);
  EXPECT_THAT(program("run " + (folder / "t").string() + " --out " + out).text, HasSubstr("is replaced"));
  EXPECT_EQ(program("run " + sequence + " --out " + out + " --device nosuchgpu").code, kExitDevice);
  EXPECT_TRUE(std::filesystem::exists(folder / "o" / "report.json"));
  EXPECT_EQ(program("run " + sequence + " --out " + out + " --json /dev/null/x.json").code, kExitBadInput);
  EXPECT_TRUE(std::filesystem::exists(folder / "o" / "report.json"));
}

TEST(CommandLine, NoVulkanDriverIsADeviceError) {
  const Outcome outcome =
      program("devices", "VK_ICD_FILENAMES=/nowhere/icd.json VK_DRIVER_FILES=/nowhere/icd.json");
  EXPECT_EQ(outcome.code, kExitDevice);
  EXPECT_THAT(outcome.text, HasSubstr("mesa-vulkan-drivers"));
}

TEST(CommandLine, UnknownDeviceListsThoseThereAre) {
  const TemporaryFolder folder;
  ASSERT_EQ(program("synth " + (folder / "s").string() + " --frames 2 --width 64 --height 48").code, 0);
  const Outcome outcome =
      program("run " + (folder / "s").string() + " --device nosuchgpu --out " + (folder / "o").string());
  EXPECT_EQ(outcome.code, kExitDevice);
  EXPECT_THAT(outcome.text, HasSubstr("nosuchgpu"));
}

TEST(CommandLine, SynthWritesColourUnlessToldOtherwise) {
  const TemporaryFolder folder;
  const std::string size = " --frames 2 --width 64 --height 48";
  ASSERT_EQ(program("synth " + (folder / "colour").string() + size).code, 0);
  EXPECT_TRUE(std::filesystem::exists(folder / "colour" / "rgb.txt"));
  ASSERT_EQ(program("synth " + (folder / "depth").string() + size + " --no-colour").code, 0);
  EXPECT_TRUE(std::filesystem::exists(folder / "depth" / "depth.txt"));
  EXPECT_FALSE(std::filesystem::exists(folder / "depth" / "rgb.txt"));
}

TEST(CommandLine, FramesThatNobodyTookAreNotCountedAsSent) {
  const TemporaryFolder folder;
  ASSERT_EQ(program("synth " + (folder / "s").string() + " --frames 2 --width 64 --height 48").code, 0);
  // Nobody listens at port 1.
  const std::string json = (folder / "sent.json").string();
  const Outcome outcome = program("send " + (folder / "s").string() + " tcp://127.0.0.1:1 --json " + json,
                                  "timeout --foreground --preserve-status -s INT 4 env");
  if (outcome.text.find("without network streams") != std::string::npos) GTEST_SKIP() << outcome.text;
  EXPECT_EQ(outcome.code, kExitInterrupted) << outcome.text;
  EXPECT_THAT(outcome.text, HasSubstr("0 of 2 frames arrived"));
  EXPECT_THAT(contents(json), ::testing::AllOf(HasSubstr("\"frames\": 0"), HasSubstr("\"bytes\": 0")));
}

TEST(CommandLine, PointCloudsAreCompared) {
  const TemporaryFolder folder;
  const std::string cloud = folder.write("cloud.ply",
                                         "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\n"
                                         "property float y\nproperty float z\nend_header\n0 0 0\n1 1 1\n");
  const Outcome outcome = program("eval-mesh " + cloud + " " + cloud);
  EXPECT_EQ(outcome.code, 0) << outcome.text;
  EXPECT_THAT(outcome.text, HasSubstr("2 on the reconstruction, 2 on the truth"));
}

TEST(CommandLine, FiguresOfTwoBenchesAreCompared) {
  const TemporaryFolder folder;
  const std::string begin = "{\"device\": {\"name\": \"GPU\"}, \"fitness\": {\"ns_per_lookup\": ";
  const std::string history = folder.write("h.jsonl", begin + "2}}\n" + begin + "3}}\n");
  const Outcome outcome = program("bench --compare " + history + "#1 " + history);
  EXPECT_EQ(outcome.code, 0) << outcome.text;
  EXPECT_THAT(outcome.text,
              ::testing::AllOf(HasSubstr("GPU"), HasSubstr("fitness ns_per_lookup"), HasSubstr("1.500")));
  EXPECT_EQ(program("bench --compare " + history + "#3 " + history).code, kExitBadInput);
}

TEST(CommandLine, InterruptFinishesTheFiles) {
  const TemporaryFolder folder;
  ASSERT_EQ(program("synth " + (folder / "s").string() + " --frames 90 --width 160 --height 120").code, 0);
  const std::string out = (folder / "o").string();
  // Without --foreground timeout signals the child and then its group, and a second Ctrl-C ends the program
  // at once.
  const Outcome outcome = program("run " + (folder / "s").string() + " --out " + out,
                                  "timeout --foreground --preserve-status -s INT 8 env");
  // A fast machine may have finished before the signal.
  EXPECT_TRUE(outcome.code == kExitInterrupted || outcome.code == 0) << outcome.text;
  for (const char* file : {"trajectory.txt", "mesh.ply", "preview.png", "frames.csv", "settings.yaml",
                           "view.html", "report.json"})
    EXPECT_TRUE(std::filesystem::exists(std::filesystem::path(out) / file)) << file << "\n" << outcome.text;
}

TEST(CommandLine, AClosedTerminalFinishesTheFilesToo) {
  const TemporaryFolder folder;
  ASSERT_EQ(program("synth " + (folder / "s").string() + " --frames 90 --width 160 --height 120").code, 0);
  // The signal is sent once the first tenth of the frames is done.
  const std::string log = (folder / "log").string();
  const Outcome outcome = program("run " + (folder / "s").string() + " --out " + (folder / "o").string() +
                                  " >" + log + " 2>&1 & p=$!; for i in $(seq 600); do grep -q /90 " + log +
                                  " && break; sleep 0.1; done; kill -HUP $p; wait $p; exit $?; :");
  EXPECT_TRUE(outcome.code == kExitInterrupted || outcome.code == 0) << outcome.text;
  EXPECT_TRUE(std::filesystem::exists(folder / "o" / "report.json")) << outcome.text;
}

TEST(CommandLine, OutputThatCannotBeWrittenFails) {
  const TemporaryFolder folder;
  const std::string sequence = (folder / "s").string();
  ASSERT_EQ(program("synth " + sequence + " --frames 3 --width 64 --height 48").code, 0);
  for (const char* command : {"check ", "eval "}) {
    const std::string more = std::string(command) == "eval " ? " " + sequence + " --json -" : " --json -";
    const std::string file = std::string(command) == "eval " ? sequence + "/groundtruth.txt" : sequence;
    const Outcome full = program(command + file + more + " >/dev/full )", "(");
    EXPECT_EQ(full.code, kExitBadInput) << command << full.text;
    EXPECT_THAT(full.text, HasSubstr("Standard output cannot be written")) << command;
  }
  // A file may be as large as 8 blocks: the small ones fit, the mesh does not. What runs on Mesa's device
  // cannot be limited so, for its memory is a file too (25.0); full disks under it are injected by
  // tests/faults.
  const Outcome synth =
      program("synth " + (folder / "t").string() + " --frames 3 --width 160 --height 120", "ulimit -f 8;");
  EXPECT_EQ(synth.code, kExitBadInput) << synth.text;
  EXPECT_FALSE(std::filesystem::exists(folder / "t"));
}

TEST(CommandLine, MostFramesLostHasACodeAndACause) {
  const TemporaryFolder folder;
  const std::string sequence = (folder / "s").string(), out = (folder / "o").string();
  ASSERT_EQ(program("synth " + sequence + " --frames 8 --width 160 --height 120 --no-colour").code, 0);
  // Every frame after the first two looks at nothing.
  const auto depth = std::filesystem::path(sequence) / "depth";
  std::vector<std::filesystem::path> images(std::filesystem::directory_iterator(depth), {});
  std::sort(images.begin(), images.end());
  const cv::Mat empty(120, 160, CV_16UC1, cv::Scalar(0));
  for (std::size_t i = 2; i < images.size(); ++i) cv::imwrite(images[i].string(), empty);
  const Outcome lost = program("run " + sequence + " --out " + out);
  EXPECT_EQ(lost.code, kExitLost) << lost.text;
  EXPECT_THAT(lost.text, HasSubstr("6 of 8 frames were lost. The likely cause"));
  EXPECT_TRUE(std::filesystem::exists(folder / "o" / "report.json"));
  const Outcome beyond = program("run " + sequence + " --out " + out + " --start 8");
  EXPECT_EQ(beyond.code, kExitBadInput);
  EXPECT_THAT(beyond.text, HasSubstr("--start 8 leaves nothing"));
}

TEST(CommandLine, AnUnknownHostIsNamed) {
  const TemporaryFolder folder;
  ASSERT_EQ(program("synth " + (folder / "s").string() + " --frames 2 --width 64 --height 48").code, 0);
  const Outcome outcome = program("send " + (folder / "s").string() + " tcp://no-such-host.invalid:5598",
                                  "timeout --foreground -s INT 15 env");
  if (outcome.text.find("without network streams") != std::string::npos) GTEST_SKIP() << outcome.text;
  EXPECT_THAT(outcome.text, HasSubstr("'no-such-host.invalid' cannot be resolved"));
}

TEST(CommandLine, ImagesTooSmallForTheSearchAreRefused) {
  const TemporaryFolder folder;
  const std::string sequence = (folder / "s").string();
  ASSERT_EQ(
      program("synth " + sequence + " --frames 2 --width 32 --height 24 --fx 16 --fy 16 --max-speed 1").code,
      0);
  const Outcome outcome = program("run " + sequence + " --out " + (folder / "o").string());
  EXPECT_EQ(outcome.code, kExitBadInput) << outcome.text;
  EXPECT_THAT(outcome.text, ::testing::AllOf(HasSubstr("32x24"), HasSubstr("swarm.levels")));
}

}  // namespace test_command_line
}  // namespace rosefusion::testing
