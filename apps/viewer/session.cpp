#include "apps/viewer/session.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <opencv2/imgproc.hpp>

#include "engine/error.h"
#include "host/core/error.h"
#include "host/core/file_io.h"
#include "host/core/number_text.h"
#include "host/export/mesh_io.h"
#include "host/run/scene_of_source.h"
#include "host/settings/automatic.h"
#include "host/slam/mapping/mesh_extraction.h"

namespace rosefusion::viewer {
namespace {

constexpr double kNearestDepth = 0.4, kFarthestDepth = 6;  // metres: the ends of the depth image's colours
constexpr std::size_t kShownParticles = 300;               // of each iteration
constexpr auto kReadable = std::chrono::seconds(3);        // what was said stays while frames come
constexpr auto kGivesWay = std::chrono::seconds(1), kSilence = std::chrono::seconds(2);

/// Near is red, far is blue; no depth is black.
cv::Mat colouredDepth(const cv::Mat& depth, double units_per_metre) {
  cv::Mat small, bytes, bgr, rgba;
  cv::resize(depth, small, {}, 0.5, 0.5, cv::INTER_NEAREST);
  const double scale = 255 / ((kFarthestDepth - kNearestDepth) * units_per_metre);
  small.convertTo(bytes, CV_8U, -scale, 255 + kNearestDepth * units_per_metre * scale);
  cv::applyColorMap(bytes, bgr, cv::COLORMAP_TURBO);
  bgr.setTo(cv::Scalar(0, 0, 0), (small == 0) | (small == 65535));
  cv::cvtColor(bgr, rgba, cv::COLOR_BGR2RGBA);
  return rgba;
}

SwarmIteration iterationOf(const SearchIteration& seen) {
  const auto& [state, losses, pose] = seen;
  SwarmIteration out;
  out.likelihood = state.best_likelihood;
  out.shift = state.axis_lengths.head<3>();
  out.turn = state.axis_lengths.tail<3>();
  out.particles = static_cast<int>(losses.size());
  const std::size_t every = std::max<std::size_t>(1, losses.size() / kShownParticles);
  for (std::size_t i = 0; i < losses.size(); i += every)
    if (losses[i] >= 0) out.shown.push_back({pose(i).translation() - state.centre.translation(), losses[i]});
  return out;
}

std::string told(const LoopClosure& loop) {
  char text[80];
  std::snprintf(text, sizeof text, "A loop was closed; the path is corrected, here by %.1f cm.",
                100 * loop.shift);
  return text;
}

/// In the one line that there is.
std::string toldShortly(const std::vector<std::string>& choices, const Settings& taken) {
  if (choices.empty()) return {};
  const SensorModel* model = sensorModel(taken.depth.sensor);
  return printed(": voxels of %g cm, truncated at %g cm, and the noise of a %s (Settings, G)",
                 100 * taken.volume.voxel_size, 100 * taken.volume.truncation,
                 model ? model->name : "Kinect");
}

}  // namespace

const char* toString(Phase phase) {
  constexpr const char* kWords[] = {"empty", "opening", "paused", "playing", "finished", "failed"};
  return kWords[static_cast<int>(phase)];
}

Session::Session(Device& device, const Settings& settings, const SourceOptions& source_options)
    : device_(device), source_options_(source_options), settings_(settings) {
  shown_.settings = settings;
  shown_.message = "Open a sequence: type its folder, or drag it into the window.";
  shown_.path = std::make_shared<std::vector<PathPoint>>();
  shown_.swarm = std::make_shared<std::vector<SwarmIteration>>();
  thread_ = std::thread([this] { work(); });
}

Session::~Session() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

template <typename Change>
void Session::update(Change change) {
  const std::lock_guard lock(mutex_);
  change(shown_);
}

void Session::say(const std::string& message, bool problem) {
  update([&](Snapshot& s) {
    said_ = Clock::now();
    s.message = message;
    s.problem = problem;
  });
}

Snapshot Session::snapshot() const {
  const std::lock_guard lock(mutex_);
  return shown_;
}

void Session::command(Kind kind, std::function<void()> action) {
  {
    const std::lock_guard lock(mutex_);
    commands_.push_back({kind, std::move(action)});
  }
  changed_.notify_all();
}

void Session::waitUntilIdle() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return commands_.empty() && !busy_ && !playing_; });
}

void Session::work() {
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [this] { return stopping_ || playing_ || !commands_.empty(); });
    if (stopping_) return;
    std::function<void()> next = [this] { nextFrame(); };
    if (!commands_.empty()) {
      next = std::move(commands_.front().action);
      commands_.pop_front();
    }
    busy_ = true;
    lock.unlock();
    carryOut(next);
    lock.lock();
    busy_ = false;
    changed_.notify_all();
  }
}

void Session::carryOut(const std::function<void()>& action) {
  try {
    action();
  } catch (const DeviceError& error) {
    update([](Snapshot& s) { s.failure = std::current_exception(); });
    finish(error.code() == DeviceErrorCode::OutOfMemory ? Phase::Finished : Phase::Failed, error.what(),
           true);
  } catch (const std::exception& error) {
    update([](Snapshot& s) { s.failure = std::current_exception(); });
    // A model that is there stays: only a source that could not be opened leaves nothing to show.
    if (pipeline_)
      say(error.what(), true);
    else
      finish(Phase::Failed, error.what(), true);
  }
}

void Session::finish(Phase phase, const std::string& message, bool problem) {
  const std::lock_guard lock(mutex_);
  playing_ = false;
  shown_.phase = phase;
  shown_.message = message;
  shown_.problem = problem;
}

void Session::open(const std::string& source) {
  command(Kind::Open, [this, source] {
    source_name_ = source;
    begin();
  });
}

void Session::reset() {
  command(Kind::Open, [this] {
    if (!source_name_.empty()) begin();
  });
}

void Session::begin() {
  update([&](Snapshot& s) {
    playing_ = false;
    const std::uint64_t generation = s.generation + 1;
    s = Snapshot{};
    s.generation = generation;
    s.phase = Phase::Opening;
    s.source = source_name_;
    s.message = "Opening " + source_name_ + " ...";
    s.settings = settings_;
    s.path = std::make_shared<std::vector<PathPoint>>();
    s.swarm = std::make_shared<std::vector<SwarmIteration>>();
  });
  pipeline_.reset();
  source_.reset();
  path_ = {};
  SourceOptions options = source_options_;
  options.sequence.colour = settings_.volume.colour;
  const auto stop = [this] {  // what is to be done with this source waits for it
    const std::lock_guard lock(mutex_);
    return stopping_ || std::any_of(commands_.begin(), commands_.end(),
                                    [](const Command& c) { return c.kind == Kind::Open; });
  };
  std::unique_ptr<FrameSource> opened = openSource(source_name_, options, stop);
  if (!opened) return;
  auto peeked = std::make_unique<PeekedSource>(std::move(opened));
  const SequenceInfo& info = peeked->info();
  scene_ = sceneOf(*peeked, settings_, stop);
  source_ = std::move(peeked);
  const Settings taken = resolved(settings_, scene_);
  const std::vector<std::string> choices = choicesOf(settings_, taken, scene_);
  for (const std::string& choice : choices) spdlog::info("{}", choice);
  pipeline_ = std::make_unique<Pipeline>(device_, taken, info.intrinsics, info.depth_units_per_metre,
                                         [this](Severity, const std::string& sentence) { say(sentence); });
  pipeline_->observe([this](const SearchIteration& seen) { swarm_.push_back(iterationOf(seen)); });
  update([&](Snapshot& s) {
    s.phase = Phase::Paused;
    s.expected = source_->expectedFrames();
    s.camera = info.intrinsics;
    s.choices = choices;
    s.message = info.format + (info.warnings.empty() ? ", ready to play" + toldShortly(choices, taken) + "."
                                                     : "; " + info.warnings.front());
  });
}

void Session::play() {
  command(Kind::Other, [this] {
    if (!pipeline_) return;
    const std::lock_guard lock(mutex_);
    if (shown_.phase != Phase::Paused) return;
    playing_ = true;
    shown_.phase = Phase::Playing;
  });
}

void Session::pause() {
  command(Kind::Other, [this] {
    const std::lock_guard lock(mutex_);
    if (shown_.phase != Phase::Playing) return;
    playing_ = false;
    shown_.phase = Phase::Paused;
  });
}

void Session::step() {
  command(Kind::Step, [this] {
    if (pipeline_ && snapshot().phase == Phase::Paused) nextFrame();
  });
}

void Session::nextFrame() {
  SourceFrame frame;
  const auto start = Clock::now();
  bool said_waiting = false;
  const auto stop = [&] {
    const auto waited = Clock::now() - start;
    if (waited > kSilence && !std::exchange(said_waiting, true))
      say("No frame has come for a while; waiting for the camera or the sender.", true);
    // Steps in a row are all carried out; only one that waits for a camera gives way.
    const std::lock_guard lock(mutex_);
    return stopping_ || ((playing_ || waited > kGivesWay) &&
                         std::any_of(commands_.begin(), commands_.end(),
                                     [](const Command& c) { return c.kind != Kind::Step; }));
  };
  SourceState state = SourceState::End;
  try {
    state = source_->next(frame, stop);
  } catch (const InputError& error) {  // a camera that was pulled out gives no more frames
    return finish(Phase::Finished, error.what(), true);
  }
  if (state == SourceState::Stopped) return;
  if (state == SourceState::End) return end();
  if (!frame.problem.empty()) say(frame.problem, true);
  if (!frame.usable) return;
  swarm_.clear();
  publish(frame, pipeline_->processFrame(frame.frame));
}

/// Weighs the loops once more, as Pipeline::finish() does.
void Session::end() {
  pipeline_->finish();
  if (path_.correct(pipeline_->trajectory()))
    update([&](Snapshot& s) {
      if (s.last && path_.last()) s.last->world_from_camera = path_.last()->world_from_camera;
      s.path = std::make_shared<std::vector<PathPoint>>(path_.points());
      ++s.model_number;
      s.model = pipeline_->volume().view();
    });
  finish(Phase::Finished, "The sequence has ended.", false);
}

void Session::publish(const SourceFrame& frame, const FrameResult& result) {
  const bool found = result.status != TrackingStatus::Lost;
  path_.add(result, pipeline_->trajectory(), source_->info().seconds_per_stamp);
  if (result.loop) say(told(*result.loop));
  for (const JoinedMap& joined : result.joined)
    if (joined.into == 1) say("A map that was made while the camera was lost is connected to the first.");
  if (result.began_anew)
    say("The model begins anew: what it held fits neither of the last two frames.", true);
  const cv::Mat depth = colouredDepth(frame.frame.depth, source_->info().depth_units_per_metre);
  update([&](Snapshot& s) {
    ++s.frames;
    s.dropped += frame.dropped;
    s.last = result;
    s.speed = path_.speed();
    s.turn_rate = path_.turnRate();
    s.frames_per_second = 1000 / std::max(result.milliseconds.total, 1e-3);
    s.path = std::make_shared<std::vector<PathPoint>>(path_.points());
    s.swarm = std::make_shared<std::vector<SwarmIteration>>(swarm_);
    s.depth = depth;
    ++s.depth_number;
    s.model_number += found;
    s.model = pipeline_->volume().view();
    s.model_bytes = pipeline_->volume().memoryBytes();
    s.device_bytes = device_.allocatedBytes();
    if (Clock::now() - said_ > kReadable) {
      s.message = "Frame " + std::to_string(frame.index) + ".";
      s.problem = false;
    }
  });
}

void Session::set(const std::string& key, const std::string& value) {
  command(Kind::Other, [this, key, value] {
    Settings changed = settings_;
    setField(changed, key, value, "the viewer");
    requireConsistent(changed);
    settings_ = changed;
    if (pipeline_ && isLiveSetting(key)) pipeline_->changeLive(resolved(settings_, scene_));
    update([&](Snapshot& s) {
      s.settings = settings_;
      s.settings_wait |= pipeline_ && !isLiveSetting(key);
    });
    say(key + " = " + value + (isLiveSetting(key) ? "." : ": from the next reset on."));
  });
}

void Session::saveMesh(const std::filesystem::path& file) {
  command(Kind::Other, [this, file] {
    if (!pipeline_ || pipeline_->volume().blockCount() == 0)
      return say("There is no surface to save yet.", true);
    say("Writing " + file.string() + " ...");
    const MeshSettings& mesh = pipeline_->settings().mesh;
    ExtractPass extract(device_);
    writePly(file, extractMesh(
                       extract, pipeline_->volume(),
                       {static_cast<float>(mesh.min_weight), static_cast<std::size_t>(mesh.min_component)}));
    say("Saved " + file.string() + ".");
  });
}

void Session::saveTrajectory(const std::filesystem::path& file) {
  command(Kind::Other, [this, file] {
    if (!pipeline_ || pipeline_->trajectory().empty())
      return say("There is no trajectory to save yet.", true);
    writeTumTrajectory(file, pipeline_->trajectory());
    writeFileAtomically(file.parent_path() / "settings.yaml", toYaml(pipeline_->settings()));
    say("Saved " + file.string() + ".");
  });
}

}  // namespace rosefusion::viewer
