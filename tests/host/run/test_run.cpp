// A whole run: files in, files out, what is counted, and real recordings where they are at hand.
#include <cstdlib>
#include <fstream>

#include "host/core/error.h"
#include "host/export/mesh_io.h"
#include "host/run/likely_cause.h"
#include "host/run/output.h"
#include "host/run/report.h"
#include "host/synth/tum_writer.h"
#include "tests/engine/validating_device.h"
#include "tests/host/core/temporary_folder.h"
#include "tests/host/slam/short_sequence.h"

namespace rosefusion::testing {
namespace test_run {

using ::testing::HasSubstr;
namespace fs = std::filesystem;

class Runs : public ValidatingDevice {
 protected:
  /// A TUM folder of the short sequence.
  fs::path sequenceFolder() {
    const fs::path folder = folder_ / "sequence";
    if (!fs::exists(folder)) {
      SynthOptions options;
      options.seed = kAnyRoom;
      options.frames = 8;
      options.intrinsics = shortSequence().intrinsics;
      writeTumSequence(folder, SynthPlan(options), false);
    }
    return folder;
  }
  struct Result {
    RunSummary summary;
    nlohmann::ordered_json report;
  };
  Result run(const fs::path& sequence_path, const fs::path& out, const RunOptions& options = {},
             int stop_after = -1) {
    const auto sequence = openSequence(sequence_path);
    const OutputFolder folder(out);
    Pipeline pipeline(device(), quickSettings(), sequence->info().intrinsics,
                      sequence->info().depth_units_per_metre);
    int frames = 0;
    const auto count = [&](const RunProgress&) { ++frames; };
    SequenceSource source(*sequence, options);
    Result result{reconstruct(source, pipeline, 0, count, [&] { return frames == stop_after; }), {}};
    folder.write(result.summary, sequence->info(), pipeline);
    std::ifstream(out / "report.json") >> result.report;
    return result;
  }
  TemporaryFolder folder_;
};

TEST_F(Runs, WritesEveryFileAndTheReportsKeys) {
  const auto result = run(sequenceFolder(), folder_ / "out");
  for (const char* file : kOutputFiles) {
    ASSERT_TRUE(fs::exists(folder_ / "out" / file)) << file;
    EXPECT_GT(fs::file_size(folder_ / "out" / file), 0u) << file;
  }
  const auto& report = result.report;
  EXPECT_EQ(report.at("frames"), 8);
  EXPECT_EQ(
      report.at("tracked").get<int>() + report.at("uncertain").get<int>() + report.at("lost").get<int>(), 8);
  for (const char* key : {"name", "driver", "type"})
    EXPECT_FALSE(report.at("device").at(key).get<std::string>().empty());
  for (const char* key : {"total", "preprocess", "track", "integrate"}) {
    EXPECT_GT(report.at("milliseconds").at(key).at("median"), 0) << key;
    EXPECT_GE(report.at("milliseconds").at(key).at("p95"), report.at("milliseconds").at(key).at("median"))
        << key;
  }
  EXPECT_GT(report.at("iterations").at("median"), 0);
  EXPECT_GT(report.at("lookups_per_frame").at("median"), 0);
  EXPECT_GT(report.at("memory_bytes").at("volume"), 0);
  EXPECT_GE(report.at("memory_bytes").at("device"), report.at("memory_bytes").at("volume"));
  EXPECT_LT(report.at("ate_rmse_m"), 0.06);
  EXPECT_GE(report.at("ate_rmse_m"), report.at("ate_mean_m"));
  EXPECT_GT(report.at("te_rmse_m"), 0);
  EXPECT_GT(report.at("te_under_5cm"), 0.5);

  EXPECT_EQ(readTumTrajectory(folder_ / "out" / "trajectory.txt").size(), 8u);
  EXPECT_GT(readMesh(folder_ / "out" / "mesh.ply").triangles.size(), 1000u);
  Settings settings;
  applyYamlFile(settings, folder_ / "out" / "settings.yaml");
  EXPECT_EQ(toYaml(settings), toYaml(quickSettings()));
}

TEST_F(Runs, StrideAndMaximumSelectFrames) {
  EXPECT_THAT(selectedFrames(10, {3, 0}), ::testing::ElementsAre(0, 3, 6, 9));
  EXPECT_THAT(selectedFrames(10, {3, 2}), ::testing::ElementsAre(0, 3));
  EXPECT_THAT(selectedFrames(2, {1, 5}), ::testing::ElementsAre(0, 1));
  EXPECT_THAT(selectedFrames(10, {3, 2, 4}), ::testing::ElementsAre(4, 7));
  EXPECT_THAT(selectedFrames(3, {1, 0, 3}), ::testing::IsEmpty());
}

TEST_F(Runs, TooFewPosesHaveNoAlignedErrors) {
  const auto report = run(sequenceFolder(), folder_ / "out", {1, 2}).report;
  EXPECT_EQ(report.at("common_poses"), 2);
  for (const char* key : {"ate_rmse_m", "ate_mean_m", "rpe_frame_rmse_m", "rpe_second_rmse_deg"})
    EXPECT_TRUE(report.at(key).is_null()) << key;
  EXPECT_FALSE(report.at("te_rmse_m").is_null());
}

TEST(RunErrors, StampsAreTakenInTheSequencesUnit) {
  RunSummary summary;
  SequenceInfo info;
  info.seconds_per_stamp = 1 / 30.0;
  for (int i = 0; i < 60; ++i) {
    RunFrame frame;
    frame.result.timestamp = i;
    frame.result.status = TrackingStatus::Tracked;
    frame.result.world_from_camera = Pose::Identity();
    frame.result.world_from_camera.translation().x() = 0.011 * i;
    summary.frames.push_back(frame);
    info.truth.push_back({double(i), Pose(Eigen::Translation3d(0.01 * i, 0, 0))});
  }
  EXPECT_NEAR(errorsOf(summary, info)->rpe_second_m.mean, 0.03, 1e-9);
}

TEST_F(Runs, StoppedRunWritesWhatItHas) {
  const auto result = run(sequenceFolder(), folder_ / "out", {}, 3);
  EXPECT_EQ(result.summary.end, RunEnd::Interrupted);
  EXPECT_EQ(result.report.at("end"), "interrupted");
  EXPECT_EQ(result.report.at("frames"), 3);
  EXPECT_TRUE(fs::exists(folder_ / "out" / "mesh.ply"));
}

TEST_F(Runs, DamagedFramesAreSkippedAndCounted) {
  const fs::path sequence = sequenceFolder();
  int damaged = 0;
  for (const auto& entry : fs::directory_iterator(sequence / "depth"))
    if (entry.path().filename() == fs::directory_iterator(sequence / "depth")->path().filename() &&
        damaged++ == 0)
      fs::resize_file(entry.path(), fs::file_size(entry.path()) / 2);
  const auto result = run(sequence, folder_ / "out");
  EXPECT_EQ(result.summary.skipped(), 1u);
  EXPECT_EQ(result.report.at("skipped"), 1);
}

/// Frames that are at hand.
class Shown : public FrameSource {
 public:
  explicit Shown(const Intrinsics& camera) { info_.intrinsics = camera, info_.depth_units_per_metre = 5000; }
  void show(const Frame& frame) {
    frames_.push_back(frame);
    frames_.back().timestamp = static_cast<double>(frames_.size()) / 30;
  }
  const SequenceInfo& info() const override { return info_; }
  SourceState next(SourceFrame& out, const StopQuestion&) override {
    if (next_ == frames_.size()) return SourceState::End;
    out = {next_, 0, frames_[next_], true, {}};
    ++next_;
    return SourceState::Frame;
  }

 private:
  SequenceInfo info_;
  std::vector<Frame> frames_;
  std::size_t next_ = 0;
};

TEST_F(Runs, UnconnectedFramesAreAMapOfTheirOwn) {
  const SynthSequence here = makeShortSequence(kRoomWithoutWindows, 12),
                      there = makeShortSequence(kUnlikeRoom, 14);
  Shown source(here.intrinsics);
  for (const Frame& frame : here.frames) source.show(frame);
  Frame dark = here.frames[0];
  dark.depth = cv::Mat(dark.depth.size(), CV_16UC1, cv::Scalar(0));
  for (int i = 0; i < 35; ++i) source.show(dark);
  for (const Frame& frame : there.frames) source.show(frame);
  Pipeline pipeline(device(), loadSettings("default"), here.intrinsics, here.depth_units_per_metre);
  const RunSummary summary = reconstruct(source, pipeline);
  const fs::path out = folder_ / "out";
  const OutputFolder folder(out);
  folder.write(summary, source.info(), pipeline, false);

  const nlohmann::ordered_json maps = reportJson(summary, source.info(), pipeline).at("maps");
  ASSERT_EQ(maps.size(), 2u);
  EXPECT_EQ(maps[0],
            nlohmann::ordered_json::parse(R"({"map": 1, "frames": 12, "first_frame": 0, "last_frame": 11})"));
  EXPECT_EQ(maps[1],
            nlohmann::ordered_json::parse(
                R"({"map": 2, "frames": 14, "first_frame": 47, "last_frame": 60, "joined_at": null})"));
  EXPECT_EQ(readTumTrajectory(out / "trajectory.txt").size(), 12u);
  EXPECT_EQ(readTumTrajectory(out / "map_2.txt").size(), 14u);
  EXPECT_GT(readMesh(out / "map_2.ply").triangles.size(), 1000u);
  folder.removeEarlier();
  EXPECT_FALSE(fs::exists(out / "map_2.txt") || fs::exists(out / "map_2.ply"));
}

TEST_F(Runs, OldResultsAreRemovedFirst) {
  fs::create_directories(folder_ / "out");
  for (const char* file : kOutputFiles) std::ofstream(folder_ / "out" / file) << "old";
  std::ofstream(folder_ / "out" / "report.json") << R"({"sequence": {"path": "/data/other"}})";
  const OutputFolder out(folder_ / "out");
  EXPECT_EQ(out.resultOf(), "/data/other");
  for (const char* file : kOutputFiles)
    EXPECT_TRUE(fs::exists(folder_ / "out" / file)) << file << " may go only when frames are about to come";
  out.removeEarlier();
  for (const char* file : kOutputFiles) EXPECT_FALSE(fs::exists(folder_ / "out" / file)) << file;
  EXPECT_EQ(out.resultOf(), "");
}

TEST_F(Runs, TheReportIsRemovedFirst) {
  const fs::path stuck = folder_ / "out" / "trajectory.txt";
  fs::create_directories(stuck);
  std::ofstream(stuck / "in the way") << "x";
  std::ofstream(folder_ / "out" / "report.json") << "old";
  std::ofstream(folder_ / "out" / "mesh.ply.part") << "of a killed run";
  EXPECT_THAT(inputErrorOf([&] { OutputFolder(folder_ / "out").removeEarlier(); }),
              HasSubstr("trajectory.txt"));
  EXPECT_FALSE(fs::exists(folder_ / "out" / "report.json"));
  EXPECT_FALSE(fs::exists(folder_ / "out" / "mesh.ply.part"));
}

TEST_F(Runs, NoSurfaceStillGivesTheOtherFiles) {
  const auto sequence = openSequence(sequenceFolder());
  const OutputFolder folder(folder_ / "out");
  Settings settings = quickSettings();
  settings.mesh.min_component = 1000000000;
  Pipeline pipeline(device(), settings, sequence->info().intrinsics, sequence->info().depth_units_per_metre);
  SequenceSource source(*sequence, {});
  folder.write(reconstruct(source, pipeline), sequence->info(), pipeline);
  for (const char* file : kOutputFiles)
    EXPECT_EQ(fs::exists(folder_ / "out" / file), std::string(file) != "mesh.ply") << file;
}

TEST_F(Runs, UnusableOutputFolderIsNamedBeforeAnyWork) {
  const auto file = folder_.write("file", "");
  EXPECT_THAT(inputErrorOf([&] { OutputFolder{file / "out"}; }), HasSubstr("--out"));
}

TEST_F(Runs, RealFramesAreTracked) {
  const char* variable = std::getenv("ROSEFUSION_DATA");
  const fs::path data = variable ? variable : fs::path(ROSEFUSION_SOURCE_DIR) / "../shared/data";
  if (!fs::exists(data / "seven_scenes"))
    GTEST_SKIP() << "Set ROSEFUSION_DATA to a folder with seven_scenes to run this on real frames.";
  const auto result = run(data / "seven_scenes", folder_ / "out", {4, 10});
  EXPECT_EQ(result.summary.count(TrackingStatus::Lost), 0u);
  EXPECT_LT(result.report.at("ate_rmse_m"), 0.04);
}

RunSummary summaryOf(const std::vector<TrackingStatus>& statuses, double valid_share = 0.9) {
  RunSummary summary;
  for (const TrackingStatus status : statuses) {
    RunFrame frame;
    frame.index = summary.frames.size();
    frame.result.status = status;
    frame.result.score.valid_share = valid_share;
    summary.frames.push_back(frame);
  }
  return summary;
}

TEST(LikelyCause, IsAskedForWhereMostFramesAreLost) {
  using enum TrackingStatus;
  EXPECT_FALSE(lostMost(summaryOf({Tracked, Lost})));
  EXPECT_TRUE(lostMost(summaryOf({Tracked, Lost, Lost})));
  RunSummary with_skipped = summaryOf({Tracked, Lost, Lost, Tracked});
  EXPECT_FALSE(lostMost(with_skipped));
  with_skipped.frames[3].skipped = true;
  EXPECT_TRUE(lostMost(with_skipped)) << "an unreadable file is no pose";
  EXPECT_FALSE(lostMost(summaryOf({})));
}

TEST(LikelyCause, ComesFromTheRecordingElseFromTheFrames) {
  using enum TrackingStatus;
  const RunSummary early = summaryOf({Tracked, Lost, Lost, Lost});
  const Finding time{false, "a gap", "look", FindingKind::Time},
      scale{false, "the depth scale is off", "set it", FindingKind::DepthScale};
  EXPECT_THAT(likelyCause(early, {time, scale}),
              HasSubstr("3 of 4 frames were lost. The likely cause: the depth scale"));
  EXPECT_THAT(likelyCause(early, {}), HasSubstr("from the beginning"));
  EXPECT_THAT(likelyCause(summaryOf({Tracked, Tracked, Tracked, Tracked, Lost, Lost, Lost, Lost, Lost}), {}),
              HasSubstr("from frame 4 on"));
  EXPECT_THAT(likelyCause(summaryOf({Tracked, Lost, Lost}, 0.1), {}), HasSubstr("holes"));
  RunSummary start = early;
  start.frames[0].result.score.valid_share = 0.4;
  EXPECT_THAT(likelyCause(start, {}), HasSubstr("--start"));
}

}  // namespace test_run
}  // namespace rosefusion::testing
