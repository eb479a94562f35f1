// Tracking on a thread of its own, so that the window never waits for it: commands in, snapshots out.
#pragma once
#include <chrono>
#include <condition_variable>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <thread>

#include "apps/viewer/shown_path.h"
#include "host/settings/automatic.h"
#include "host/slam/pipeline.h"
#include "host/sources/open_source.h"

namespace rosefusion::viewer {

enum class Phase { Empty, Opening, Paused, Playing, Finished, Failed };
const char* toString(Phase phase);

/// One iteration of the swarm: its extent, and some of its particles.
struct SwarmIteration {
  double likelihood = 0;        ///< of the best pose so far
  Eigen::Vector3d shift, turn;  ///< lengths of the ellipsoid's axes: metres, and about radians
  int particles = 0;
  struct Particle {
    Eigen::Vector3d at;  ///< metres from the ellipsoid's centre, world axes
    float loss;          ///< 0 is best
  };
  std::vector<Particle> shown;
};

/// What there is to show. Copies are cheap: what is large is shared and never changed.
struct Snapshot {
  Phase phase = Phase::Empty;
  std::string source;          ///< as it was opened
  std::string message;         ///< the last thing that happened: a sentence
  bool problem = false;        ///< whether `message` is bad news
  std::exception_ptr failure;  ///< what ended a command, since the source was opened; null: nothing did
  std::size_t frames = 0, expected = 0, dropped = 0;
  std::uint64_t generation = 0;  ///< counts the models begun
  std::optional<FrameResult> last;
  double speed = 0, turn_rate = 0;  ///< m/s, rad/s
  double frames_per_second = 0;
  Intrinsics camera;
  std::shared_ptr<const std::vector<PathPoint>> path;
  std::shared_ptr<const std::vector<SwarmIteration>> swarm;
  cv::Mat depth;                                     ///< CV_8UC4, RGBA; coloured by distance
  std::uint64_t depth_number = 0, model_number = 0;  ///< count the changes
  std::optional<VolumeView> model;
  std::uint64_t model_bytes = 0, device_bytes = 0;
  Settings settings;                 ///< as they are set now
  std::vector<std::string> choices;  ///< what was chosen for this source where a setting is 'auto'
  bool settings_wait = false;        ///< some of them take effect with the next reset()
};

/// Commands return at once and are carried out in order. The Device must outlive it. The caller's thread
/// only.
class Session {
 public:
  Session(Device& device, const Settings& settings, const SourceOptions& source_options);
  ~Session();

  void open(const std::string& source);
  void play();
  void pause();
  void step();
  void reset();  ///< the same source from its beginning, with the settings as they are now
  void set(const std::string& key, const std::string& value);
  void saveMesh(const std::filesystem::path& file);
  /// And the settings that it was tracked with, as settings.yaml beside it.
  void saveTrajectory(const std::filesystem::path& file);
  /// Shows a sentence of the caller's.
  void say(const std::string& message, bool problem = false);
  /// Waits until all commands were carried out and nothing is playing.
  void waitUntilIdle();

  Snapshot snapshot() const;

 private:
  using Clock = std::chrono::steady_clock;
  enum class Kind { Open, Step, Other };
  struct Command {
    Kind kind;
    std::function<void()> action;
  };
  void command(Kind kind, std::function<void()> action);
  void work();
  void carryOut(const std::function<void()>& action);
  void begin();
  void nextFrame();
  void end();
  void publish(const SourceFrame& frame, const FrameResult& result);
  template <typename Change>
  void update(Change change);
  void finish(Phase phase, const std::string& message, bool problem);

  Device& device_;
  SourceOptions source_options_;
  // The thread's own.
  Settings settings_;
  std::string source_name_;
  std::unique_ptr<FrameSource> source_;
  std::optional<SceneMeasures> scene_;  ///< of its first images
  std::unique_ptr<Pipeline> pipeline_;
  ShownPath path_;
  std::vector<SwarmIteration> swarm_;
  // Shared.
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Command> commands_;
  bool busy_ = false, stopping_ = false, playing_ = false;
  Snapshot shown_;
  Clock::time_point said_{};
  std::thread thread_;
};

}  // namespace rosefusion::viewer
