// The viewer's tracking thread: commands in, snapshots out, while the window goes on drawing.
#include "apps/viewer/session.h"

#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <opencv2/imgcodecs.hpp>
#include <set>
#include <thread>

#include "host/synth/tum_writer.h"
#include "tests/engine/validating_device.h"
#include "tests/host/core/temporary_folder.h"
#include "tests/host/slam/short_sequence.h"

namespace rosefusion::testing {
namespace test_session {
using namespace viewer;

using namespace std::chrono_literals;
using ::testing::HasSubstr;

constexpr int kFrames = 12;

class ViewerSession : public ::testing::Test {
 protected:
  void TearDown() override { EXPECT_THAT(device_.validationMessages(), ::testing::IsEmpty()); }
  ViewerSession() {
    SynthOptions options;
    options.seed = kAnyRoom;
    options.frames = kFrames;
    options.intrinsics = {320, 240, 160, 160, 159.5, 119.5};
    writeTumSequence(folder_ / "sequence", SynthPlan(options), false);
  }
  std::string sequence() const { return (folder_ / "sequence").string(); }
  /// Looks as a window does until `there`, and gives up after a minute.
  template <typename There>
  Snapshot watch(There there) {
    const auto end = std::chrono::steady_clock::now() + 60s;
    Snapshot seen = session_.snapshot();
    while (!there(seen) && std::chrono::steady_clock::now() < end) {
      std::this_thread::sleep_for(5ms);
      seen = session_.snapshot();
    }
    EXPECT_TRUE(there(seen)) << "phase " << toString(seen.phase) << ", " << seen.frames
                             << " frames: " << seen.message;
    return seen;
  }
  Snapshot idle() {
    session_.waitUntilIdle();
    return session_.snapshot();
  }

  TemporaryFolder folder_;
  Device device_{deviceUnderTest()};
  Session session_{device_, quickSettings(), {}};
};

TEST_F(ViewerSession, OpensStepsPlaysPausesAndBeginsAnew) {
  EXPECT_EQ(session_.snapshot().phase, Phase::Empty);
  session_.play();  // nothing is open
  session_.step();
  EXPECT_EQ(idle().phase, Phase::Empty);
  session_.open(sequence());
  EXPECT_EQ(idle().phase, Phase::Paused);
  session_.step();
  session_.step();
  Snapshot seen = idle();
  EXPECT_EQ(seen.frames, 2u);
  EXPECT_EQ(seen.expected, std::size_t(kFrames));
  EXPECT_EQ(seen.path->size(), 2u);
  EXPECT_FALSE(seen.swarm->empty());
  EXPECT_GT(seen.model->blockCount(), 100u);
  EXPECT_FALSE(seen.depth.empty());

  session_.play();
  watch([](const Snapshot& s) { return s.frames >= 4; });
  session_.pause();
  seen = idle();
  EXPECT_EQ(seen.phase, Phase::Paused);
  EXPECT_LT(seen.frames, std::size_t(kFrames));
  const std::uint64_t generation = seen.generation;
  session_.reset();
  seen = idle();
  EXPECT_EQ(seen.frames, 0u);
  EXPECT_GT(seen.generation, generation);
  session_.play();
  seen = watch([](const Snapshot& s) { return s.phase == Phase::Finished; });
  EXPECT_EQ(seen.frames, std::size_t(kFrames));
}

TEST_F(ViewerSession, ChangesSettingsAtOnceOrWithTheNextReset) {
  session_.open(sequence());
  session_.set("tracking.lost_residual", "0.5");
  EXPECT_FALSE(idle().settings_wait);
  session_.set("volume.voxel_size", "0.04");
  EXPECT_TRUE(idle().settings_wait);
  session_.set("volume.voxel_size", "-1");
  const Snapshot refused = idle();
  EXPECT_TRUE(refused.problem);
  EXPECT_THAT(refused.message, HasSubstr("volume.voxel_size"));
  EXPECT_EQ(refused.settings.volume.voxel_size, 0.04);
  session_.reset();
  EXPECT_FALSE(idle().settings_wait);
}

TEST_F(ViewerSession, TellsWhatAnAutomaticSettingBecame) {
  session_.open(sequence());
  EXPECT_THAT(idle().choices, ::testing::IsEmpty());
  session_.set("volume.voxel_size", "auto");
  session_.set("depth.sensor", "auto");
  session_.reset();
  const Snapshot seen = idle();
  EXPECT_THAT(seen.choices, ::testing::ElementsAre(HasSubstr("Voxels of 2 cm"), HasSubstr("noise")));
  EXPECT_THAT(seen.message, HasSubstr("voxels of 2 cm"));
}

TEST_F(ViewerSession, SavesFilesAndSaysWhatCannotBe) {
  session_.open(sequence());
  session_.saveMesh(folder_ / "mesh.ply");
  EXPECT_THAT(idle().message, HasSubstr("no surface"));
  for (int i = 0; i < 4; ++i) session_.step();
  session_.saveMesh(folder_ / "mesh.ply");
  EXPECT_THAT(idle().message, HasSubstr("Saved"));
  session_.saveTrajectory(folder_ / "trajectory.txt");
  EXPECT_THAT(idle().message, HasSubstr("trajectory.txt"));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "mesh.ply"));
  session_.open("/nowhere");
  const Snapshot failed = idle();
  EXPECT_EQ(failed.phase, Phase::Failed);
  EXPECT_THAT(failed.message, HasSubstr("/nowhere"));
  session_.open(sequence());
  EXPECT_EQ(idle().phase, Phase::Paused) << "one bad name is not the end";
}

/// A port that nobody listened on a moment ago.
std::string freeEndpoint() {
  const int s = socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t length = sizeof address;
  EXPECT_EQ(bind(s, reinterpret_cast<sockaddr*>(&address), length), 0);
  EXPECT_EQ(getsockname(s, reinterpret_cast<sockaddr*>(&address), &length), 0);
  close(s);
  return "tcp://127.0.0.1:" + std::to_string(ntohs(address.sin_port));
}

TEST_F(ViewerSession, AStreamIsWaitedForByWhatIsToBeDoneWithIt) {
  if (!streamsAvailable()) GTEST_SKIP() << "This build has no network streams.";
  const std::string endpoint = freeEndpoint();
  session_.open(endpoint);
  session_.step();
  session_.step();
  session_.play();
  std::this_thread::sleep_for(100ms);
  EXPECT_EQ(session_.snapshot().phase, Phase::Opening);
  const auto sequence_on_disk = openSequence(sequence(), {});
  StreamSender sender(endpoint, sequence_on_disk->info(), {});
  const auto late = std::chrono::steady_clock::now() + 60s;
  const auto stop = [late] { return std::chrono::steady_clock::now() > late; };
  for (std::size_t i = 0; i < 4; ++i) {
    Frame frame;
    std::string problem;
    ASSERT_TRUE(sequence_on_disk->read(i, frame, problem)) << problem;
    ASSERT_TRUE(sender.send(frame, stop));
  }
  EXPECT_TRUE(sender.finish(stop));
  EXPECT_EQ(watch([](const Snapshot& s) { return s.phase == Phase::Finished; }).frames, 4u);
}

TEST_F(ViewerSession, ACameraThatIsCoveredIsLostAndComesBack) {
  int number = 0;
  for (const auto& entry : std::set<std::filesystem::path>(
           std::filesystem::directory_iterator(folder_ / "sequence" / "depth"), {})) {
    if (++number == 6 || number == 7) cv::imwrite(entry.string(), cv::Mat::zeros(240, 320, CV_16UC1));
  }
  ASSERT_EQ(number, kFrames);
  session_.open(sequence());
  for (int i = 0; i < 6; ++i) session_.step();
  const Snapshot covered = idle();
  ASSERT_TRUE(covered.last);
  EXPECT_EQ(covered.last->status, TrackingStatus::Lost);
  EXPECT_EQ(covered.last->reason, Reason::LittleDepth);
  EXPECT_EQ(covered.speed, 0);
  for (int i = 6; i < kFrames; ++i) session_.step();
  const Snapshot after = idle();
  EXPECT_NE(after.last->status, TrackingStatus::Lost) << after.last->reason;
  EXPECT_FALSE(after.path->at(5).connected) << "nobody knows how the camera came here";
}

}  // namespace test_session
}  // namespace rosefusion::testing
