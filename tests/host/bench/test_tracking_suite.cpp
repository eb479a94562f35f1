// The tracking suite on sequences as small as they may be, and how it counts frames that were lost.
#include <gmock/gmock.h>

#include <limits>

#include "host/bench/tracking_suite.h"
#include "host/export/mesh_io.h"
#include "host/synth/tum_writer.h"
#include "tests/engine/validating_device.h"
#include "tests/host/core/temporary_folder.h"
#include "tests/host/slam/short_sequence.h"

namespace rosefusion::testing {
namespace test_tracking_suite {

using ::testing::HasSubstr;
namespace fs = std::filesystem;

constexpr double kFrame_s = 1.0 / 30;

class TrackingSuite : public ValidatingDevice {
 protected:
  TrackingSuite() {
    options_.settings = quickSettings();
    options_.settings.volume.colour = false;
    options_.settings_name = "quick";
    options_.synth.frames = 6;
    options_.synth.intrinsics = {160, 120, 80, 80, 79.5, 59.5};
    options_.rooms = 2;
  }

  /// A run of 10 frames along a line that is exactly right, but for `lost` frames in its middle; or those are
  /// told `told_off_m` beside their place, and not fused.
  TrackedSequence judged(std::size_t lost, double last_off_m = 0, std::size_t frames = 10,
                         std::optional<double> view_returns = {}, double told_off_m = 0) {
    RunSummary summary;
    SequenceInfo info;
    for (std::size_t i = 0; i < 10; ++i) {
      StampedPose pose;
      pose.timestamp = kFrame_s * static_cast<double>(i);
      pose.world_from_camera.translation() = Eigen::Vector3d(0.1 * i, 0.01 * i * i, 0.02 * (i % 3));
      info.truth.push_back(pose);
      RunFrame frame;
      frame.index = i;
      frame.result.timestamp = pose.timestamp;
      frame.result.world_from_camera = pose.world_from_camera;
      if (i == 9) frame.result.world_from_camera.translation().z() += last_off_m;
      const bool is_lost = i >= 5 && i < 5 + lost;
      frame.result.status = !is_lost     ? TrackingStatus::Tracked
                            : told_off_m ? TrackingStatus::Relocalised
                                         : TrackingStatus::Lost;
      if (is_lost) frame.result.world_from_camera.translation().y() += told_off_m;
      frame.result.fused = !is_lost;
      summary.frames.push_back(frame);
    }
    Pipeline pipeline(device(), options_.settings, options_.synth.intrinsics, 5000);
    return judge("line", summary, info, frames, pipeline, view_returns);
  }

  TrackingSuiteOptions options_;
  TemporaryFolder folder_;
};

TEST_F(TrackingSuite, SecondRunRepeatsFiguresAndSequences) {
  options_.work = folder_ / "work";
  std::vector<std::string> told;
  const TrackingReport first =
      trackSuite(device(), options_, [&](const TrackedSequence& s) { told.push_back(s.name); });
  EXPECT_THAT(told, ::testing::ElementsAre("room_101", "room_102"));
  const auto written = fs::last_write_time(options_.work / "room_101" / "synth.json");
  const TrackingReport again = trackSuite(device(), options_);
  EXPECT_EQ(fs::last_write_time(options_.work / "room_101" / "synth.json"), written);

  ASSERT_EQ(first.sequences.size(), 2u);
  ASSERT_EQ(again.sequences.size(), 2u);
  for (int i = 0; i < 2; ++i) {
    const TrackedSequence &a = first.sequences[i], &b = again.sequences[i];
    EXPECT_EQ(a.frames, 6u);
    EXPECT_EQ(a.tracked + a.uncertain + a.lost, 6u);
    EXPECT_GT(a.ms_per_frame, 0);
    EXPECT_GT(a.lookups_per_frame, 0);
    EXPECT_GT(a.ate_m.rmse, 0);
    EXPECT_EQ(a.ate_m.rmse, b.ate_m.rmse);
    EXPECT_EQ(a.ate_m.max, b.ate_m.max);
    EXPECT_EQ(a.te_m.rmse, b.te_m.rmse);
    EXPECT_EQ(a.lookups_per_frame, b.lookups_per_frame);
  }
  EXPECT_NE(first.sequences[0].ate_m.rmse, first.sequences[1].ate_m.rmse);

  const nlohmann::ordered_json json = trackingJson(first);
  EXPECT_EQ(json.at("device").at("name"), device().info().name);
  EXPECT_EQ(json.at("settings"), "quick");
  EXPECT_EQ(json.at("generated").at("noise"), "handa");
  ASSERT_EQ(json.at("sequences").size(), 2u);
  for (const char* key : {"name", "judged_frames", "good_frames", "within_3cm", "frames_without_pose",
                          "tracked", "uncertain", "lost", "ate_rmse_m", "ate_max_m", "te_rmse_m", "te_max_m",
                          "ms_per_frame", "lookups_per_frame", "report"})
    EXPECT_TRUE(json.at("sequences")[0].contains(key)) << key;
  for (const char* key : {"sequences", "within_3cm", "ate_rmse_mean_m", "ate_rmse_worst_m", "judged_frames",
                          "good_frames", "uncertain", "frames_without_pose"})
    EXPECT_TRUE(json.at("summary").at(key).is_number()) << key;
  EXPECT_EQ(json.at("summary").at("judged_frames"), 12);
  EXPECT_THAT(trackingRow(first.sequences[0]), HasSubstr("room_101"));
}

TEST_F(TrackingSuite, TakesMeshesAndRecordingsToo) {
  options_.rooms = 0;
  options_.mesh_folder = folder_ / "meshes";
  fs::create_directories(options_.mesh_folder);
  writePly(options_.mesh_folder / "house.PLY", makeRoom(3).mesh);
  folder_.write("meshes/readme.txt", "no mesh");
  SynthOptions recorded = options_.synth;
  recorded.frames = 12;
  recorded.seed = 7;
  writeTumSequence(folder_ / "recorded", SynthPlan(recorded), false);
  options_.sequences = {folder_ / "recorded/"};
  options_.stride = 3;
  const TrackingReport report = trackSuite(device(), options_);
  ASSERT_EQ(report.sequences.size(), 2u);
  EXPECT_EQ(report.sequences[0].name, "house.PLY");
  EXPECT_EQ(report.sequences[0].frames, 6u);
  EXPECT_EQ(report.sequences[1].name, "recorded");
  EXPECT_EQ(report.sequences[1].frames, 4u);
}

TEST_F(TrackingSuite, LostFramesAreFailures) {
  EXPECT_TRUE(judged(0).good());
  EXPECT_EQ(judged(0).good_frames, 10u);
  const TrackedSequence sequence = judged(2);
  EXPECT_NEAR(sequence.ate_m.rmse, 0, 1e-6);
  EXPECT_EQ(sequence.lost, 2u);
  EXPECT_EQ(sequence.good_frames, 8u);
  EXPECT_FALSE(sequence.good());
  EXPECT_THAT(trackingRow(sequence), HasSubstr("FAILED"));
  TrackingReport report;
  report.sequences = {judged(0), sequence};
  EXPECT_EQ(report.goodSequences(), 1u);
  EXPECT_EQ(trackingJson(report).at("summary").at("frames_without_pose"), 2);
  EXPECT_THAT(trackingSummary(report), HasSubstr("18 of 20 frames within 3 cm, 2 lost"));
}

TEST_F(TrackingSuite, DisturbedFlightsAreJudgedByRecovery) {
  options_.synth.frames = 90;
  options_.synth.linear = options_.synth.linear.endingAt(0.8);  // the view stays
  options_.synth.angular = options_.synth.angular.endingAt(0.5);
  options_.rooms = 1;
  options_.disturbances = {Disturbance::Cut, Disturbance::Black, Disturbance::Hand};
  options_.settings = loadSettings("default");
  options_.settings.volume.colour = false;
  const TrackingReport report = trackSuite(device(), options_);
  ASSERT_EQ(report.sequences.size(), 3u);
  const std::vector<std::pair<std::string, std::size_t>> expected = {
      {"room_101+cut", 60}, {"room_101+black", 90}, {"room_101+hand", 90}};
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const TrackedSequence& s = report.sequences[i];
    EXPECT_EQ(s.name, expected[i].first);
    EXPECT_EQ(s.frames, expected[i].second);
    ASSERT_TRUE(s.recovery);
    EXPECT_EQ(s.recovery->wrongly_fused, 0u) << s.name;
    EXPECT_EQ(s.good(), s.recovery->good());
    EXPECT_EQ(trackingJson(report).at("sequences")[i].at("recovery").at("wrongly_fused"), 0);
  }
  EXPECT_GE(report.sequences[1].report.at("lost").get<int>(), 10) << "black frames have no pose";
  EXPECT_TRUE(report.sequences[1].recovery->possible);
  EXPECT_TRUE(report.sequences[1].good()) << report.sequences[1].recovery->frames;
}

TEST_F(TrackingSuite, RecoveryIsCountedFromTheViewsReturn) {
  const auto recovery = [&](double view_returns_at, std::size_t lost, double last_off_m = 0) {
    return *judged(lost, last_off_m, 10, view_returns_at * kFrame_s).recovery;
  };
  EXPECT_EQ(recovery(5, 2).frames, 2u);
  EXPECT_EQ(recovery(7, 2).frames, 0u);
  EXPECT_TRUE(recovery(5, 2).good());
  EXPECT_EQ(recovery(5, 5).frames, Recovery::kNever);
  EXPECT_FALSE(recovery(5, 5).good());
  const double never = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(recovery(never, 5).possible);
  EXPECT_TRUE(recovery(never, 5).good()) << "nothing wrong was fused, and nothing known came into view";
  EXPECT_GT(recovery(5, 2, 0.5).wrongly_fused, 0u);
  EXPECT_FALSE(recovery(5, 2, 0.5).good());
  const TrackedSequence misplaced = judged(3, 0, 10, never, 2);
  EXPECT_LT(misplaced.good_frames, 7u) << "the poses told turn the alignment of all";
  EXPECT_EQ(misplaced.recovery->wrongly_fused, 0u) << "but those fused are right";
}

TEST_F(TrackingSuite, AFrameFarOffOrNeverReachedIsAFailure) {
  const TrackedSequence astray = judged(0, 0.2);  // which turns the alignment of its neighbours too
  EXPECT_EQ(astray.lost, 0u);
  EXPECT_LT(astray.good_frames, 10u);
  EXPECT_GT(astray.good_frames, 4u);
  EXPECT_FALSE(astray.good());
  const TrackedSequence cut_short = judged(0, 0, 15);  // the device was full after 10 of 15
  EXPECT_EQ(cut_short.lost, 5u);
  EXPECT_FALSE(cut_short.good());
}

TEST_F(TrackingSuite, BadInputIsNamedBeforeAnyWork) {
  const auto complaint = [&] { return inputErrorOf([&] { trackSuite(device(), options_); }); };
  options_.mesh_folder = "/nowhere/meshes";
  EXPECT_THAT(complaint(), HasSubstr("/nowhere/meshes"));
  options_.mesh_folder = folder_.path();
  EXPECT_THAT(complaint(), HasSubstr("no .ply or .obj"));
  options_.mesh_folder.clear();
  SynthOptions recorded = options_.synth;
  recorded.frames = 2;
  writeTumSequence(folder_ / "blind", SynthPlan(recorded), false);
  fs::remove(folder_ / "blind" / "groundtruth.txt");
  options_.sequences = {folder_ / "blind"};
  EXPECT_THAT(complaint(), HasSubstr("blind: has no true trajectory"));
  options_.sequences.clear();
  options_.rooms = 0;
  EXPECT_THAT(complaint(), HasSubstr("--rooms"));
}

TEST_F(TrackingSuite, StopsWhenAskedTo) {
  int asked = 0;
  const TrackingReport report = trackSuite(device(), options_, {}, [&] { return ++asked > 8; });
  EXPECT_TRUE(report.interrupted);
  EXPECT_EQ(report.sequences.size(), 1u);
}

}  // namespace test_tracking_suite
}  // namespace rosefusion::testing
