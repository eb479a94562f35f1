#include "rosefusion/reconstructor.h"

#include <system_error>

#include "engine/caller_device.h"
#include "engine/passes/extract.h"
#include "host/embedding/at_work.h"
#include "host/embedding/reconstructor_impl.h"
#include "host/embedding/vulkan_handles.h"
#include "host/slam/mapping/mesh_extraction.h"

namespace rosefusion {
namespace {

Device openDevice(const VulkanHandles* handles, const Options& options) {
  return handles ? Device(toCallerDevice(*handles)) : Device({.select = options.device});
}

Log logOf(const Options& options) {
  if (!options.log) return {};
  return [&options](Severity severity, const std::string& sentence) {
    options.log(severity == Severity::Warning ? LogLevel::Warning : LogLevel::Info, sentence);
  };
}

Settings settingsOf(const Options& options) {
  const Log log = logOf(options);
  Settings settings = loadSettings(options.preset, log);
  for (const Setting& s : options.settings)
    setField(settings, s.key, s.value, "the options handed over", log);
  return settings;
}

double unitsOf(const Camera& camera) {
  if (!(camera.depth_units_per_metre > 0))
    throw Error(Error::Kind::BadInput, "The camera's depth_units_per_metre must be larger than 0.");
  return camera.depth_units_per_metre;
}

}  // namespace

Reconstructor::Impl::Impl(const Camera& camera, const VulkanHandles* handles, const Options& options)
    : intrinsics(toIntrinsics(camera)),
      queue_length(options.queue_length),
      device(openDevice(handles, options)),
      pipeline(device, settingsOf(options), intrinsics, unitsOf(camera), logOf(options)),
      current(pipeline.volume().view()) {}

Reconstructor::Impl::~Impl() {
  {
    const std::lock_guard lock(state);
    stopping = true;
  }
  wake.notify_all();
  if (worker.joinable()) worker.join();
}

Reconstructor::Impl& Reconstructor::Impl::inItsProcess() {
  if (isOfThisProcess()) return *this;
  throw Error(
      Error::Kind::Misuse,
      "A Reconstructor made before fork() cannot be used in the child process; make a new one there.");
}

VolumeView Reconstructor::Impl::view() const {
  const std::lock_guard lock(state);
  return current;
}

void Reconstructor::Impl::publish(double timestamp, const Matrix* world_from_camera) {
  const std::lock_guard lock(state);
  current = pipeline.volume().view();
  if (world_from_camera) trajectory.push_back({timestamp, *world_from_camera});
}

Result Reconstructor::Impl::process(const Frame& frame, const Semaphores& semaphores) {
  submitSemaphores(device, toPoints(semaphores.wait), {});
  FrameResult processed;
  try {
    processed = pipeline.processFrame(frame);
  } catch (...) {
    submitSemaphores(device, {}, toPoints(semaphores.signal));  // who waits for them must not wait forever
    throw;
  }
  submitSemaphores(device, {}, toPoints(semaphores.signal));
  const Result result = toResult(processed);
  if (processed.began_anew) {
    const std::lock_guard lock(state);
    trajectory.assign(1, {last_timestamp, kIdentity});
  }
  last_timestamp = result.timestamp;
  publish(result.timestamp, result.status == Status::Lost ? nullptr : &result.world_from_camera);
  if (processed.loop || processed.stretch_closed || !processed.recovered.empty()) {
    const std::lock_guard lock(state);
    trajectory.clear();
    for (const StampedPose& pose : pipeline.trajectory())
      trajectory.push_back({pose.timestamp, toMatrix(pose.world_from_camera)});
  }
  return result;
}

void Reconstructor::Impl::requireNothingPushed() const {
  const std::lock_guard lock(state);
  if (busy || !queue.empty())
    throw Error(Error::Kind::Misuse, "Pushed frames are still waiting; call wait() before other frames.");
}

bool Reconstructor::Impl::push(Frame frame, const Semaphores& semaphores) {
  const std::lock_guard lock(state);
  if (queue.size() >= queue_length) return false;
  try {
    if (!worker.joinable()) worker = std::thread([this] { workOff(); });
  } catch (const std::system_error& error) {
    throw Error(Error::Kind::OutOfMemory, std::string("The system gives no thread for pushed frames (") +
                                              error.what() +
                                              "); end other programs, or use process(), which needs none.");
  }
  queue.push_back({std::move(frame), semaphores});
  wake.notify_one();
  return true;
}

void Reconstructor::Impl::workOff() {
  std::unique_lock lock(state);
  for (;;) {
    wake.wait(lock, [&] { return stopping || !queue.empty(); });
    if (stopping) return;
    const Pushed next = std::move(queue.front());
    queue.pop_front();
    busy = true;
    lock.unlock();
    std::variant<Result, std::exception_ptr> outcome;
    bool begun = false;
    try {
      const AtWork at_work(begun);
      const std::lock_guard one_at_a_time(work);
      if (begun) outcome = guarded([&] { return process(next.frame, next.semaphores); });
    } catch (...) {
      outcome = std::current_exception();
    }
    lock.lock();
    busy = false;
    if (!begun) queue.clear();  // the process ends
    if (begun) results.push_back(std::move(outcome));
    if (queue.empty()) idle.notify_all();
    if (!begun) return;
  }
}

Reconstructor::Reconstructor(const Camera& camera, const Options& options)
    : impl_(guarded([&] {
        const AtWork at_work;
        return std::make_unique<Impl>(camera, nullptr, options);
      })) {}
Reconstructor::Reconstructor(const Camera& camera, const VulkanHandles& handles, const Options& options)
    : impl_(guarded([&] {
        const AtWork at_work;
        return std::make_unique<Impl>(camera, &handles, options);
      })) {}
Reconstructor::~Reconstructor() {
  if (impl_) endUnlessForked(impl_, *impl_);
}
Reconstructor::Reconstructor(Reconstructor&&) noexcept = default;
Reconstructor& Reconstructor::operator=(Reconstructor&& other) noexcept {
  if (impl_) endUnlessForked(impl_, *impl_);
  impl_ = std::move(other.impl_);
  return *this;
}

Result Reconstructor::process(const DepthFrame& frame, const Semaphores* semaphores) {
  return guarded([&] {
    Impl& r = impl_->inItsProcess();
    const Frame copy = copyOf(frame, r.intrinsics);
    r.requireNothingPushed();
    const AtWork at_work;
    const std::lock_guard lock(r.work);
    return r.process(copy, semaphores ? *semaphores : Semaphores());
  });
}

void Reconstructor::integrate(const DepthFrame& frame, const Matrix& world_from_camera) {
  guarded([&] {
    Impl& r = impl_->inItsProcess();
    const Frame copy = copyOf(frame, r.intrinsics);
    r.requireNothingPushed();
    const AtWork at_work;
    const std::lock_guard lock(r.work);
    r.pipeline.fuseFrame(copy, toPose(world_from_camera));
    r.publish(frame.timestamp, &world_from_camera);
  });
}

bool Reconstructor::push(const DepthFrame& frame, const Semaphores* semaphores) {
  return guarded([&] {
    Impl& r = impl_->inItsProcess();
    return r.push(copyOf(frame, r.intrinsics), semaphores ? *semaphores : Semaphores());
  });
}

std::optional<Result> Reconstructor::poll() {
  Impl& r = impl_->inItsProcess();
  std::variant<Result, std::exception_ptr> outcome;
  {
    const std::lock_guard lock(r.state);
    if (r.results.empty()) return std::nullopt;
    outcome = std::move(r.results.front());
    r.results.pop_front();
  }
  if (const auto* failure = std::get_if<std::exception_ptr>(&outcome)) std::rethrow_exception(*failure);
  return std::get<Result>(std::move(outcome));
}

void Reconstructor::wait() {
  Impl& r = impl_->inItsProcess();
  std::unique_lock lock(r.state);
  r.idle.wait(lock, [&] { return r.queue.empty() && !r.busy; });
}

Mesh Reconstructor::mesh() {
  return guarded([&] {
    Impl& r = impl_->inItsProcess();
    const AtWork at_work;
    const std::lock_guard lock(r.work);
    ExtractPass extract(r.device);
    const MeshSettings& settings = r.pipeline.settings().mesh;
    return toMesh(extractMesh(
        extract, r.pipeline.volume(),
        {static_cast<float>(settings.min_weight), static_cast<std::size_t>(settings.min_component)}));
  });
}

std::vector<TimedPose> Reconstructor::trajectory() const {
  Impl& r = impl_->inItsProcess();
  const std::lock_guard lock(r.state);
  return r.trajectory;
}

std::size_t Reconstructor::blockCount() const {
  return impl_->inItsProcess().view().blockCount();
}

std::string Reconstructor::setting(const std::string& key) const {
  return guarded([&] { return fieldText(impl_->pipeline.settings(), key, "setting()"); });
}

std::string Reconstructor::device() const {
  return impl_->device.info().name;
}

}  // namespace rosefusion
