#include "rosefusion/reconstructor.h"

#include "engine/caller_device.h"
#include "engine/passes/extract.h"
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
  queue.push_back({std::move(frame), semaphores});
  if (!worker.joinable()) worker = std::thread([this] { workOff(); });
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
    try {
      const std::lock_guard one_at_a_time(work);
      outcome = guarded([&] { return process(next.frame, next.semaphores); });
    } catch (...) {
      outcome = std::current_exception();
    }
    lock.lock();
    results.push_back(std::move(outcome));
    busy = false;
    if (queue.empty()) idle.notify_all();
  }
}

Reconstructor::Reconstructor(const Camera& camera, const Options& options)
    : impl_(guarded([&] { return std::make_unique<Impl>(camera, nullptr, options); })) {}
Reconstructor::Reconstructor(const Camera& camera, const VulkanHandles& handles, const Options& options)
    : impl_(guarded([&] { return std::make_unique<Impl>(camera, &handles, options); })) {}
Reconstructor::~Reconstructor() = default;
Reconstructor::Reconstructor(Reconstructor&&) noexcept = default;
Reconstructor& Reconstructor::operator=(Reconstructor&&) noexcept = default;

Result Reconstructor::process(const DepthFrame& frame, const Semaphores* semaphores) {
  return guarded([&] {
    const Frame copy = copyOf(frame, impl_->intrinsics);
    impl_->requireNothingPushed();
    const std::lock_guard lock(impl_->work);
    return impl_->process(copy, semaphores ? *semaphores : Semaphores());
  });
}

void Reconstructor::integrate(const DepthFrame& frame, const Matrix& world_from_camera) {
  guarded([&] {
    const Frame copy = copyOf(frame, impl_->intrinsics);
    impl_->requireNothingPushed();
    const std::lock_guard lock(impl_->work);
    impl_->pipeline.fuseFrame(copy, toPose(world_from_camera));
    impl_->publish(frame.timestamp, &world_from_camera);
  });
}

bool Reconstructor::push(const DepthFrame& frame, const Semaphores* semaphores) {
  return guarded(
      [&] { return impl_->push(copyOf(frame, impl_->intrinsics), semaphores ? *semaphores : Semaphores()); });
}

std::optional<Result> Reconstructor::poll() {
  std::variant<Result, std::exception_ptr> outcome;
  {
    const std::lock_guard lock(impl_->state);
    if (impl_->results.empty()) return std::nullopt;
    outcome = std::move(impl_->results.front());
    impl_->results.pop_front();
  }
  if (const auto* failure = std::get_if<std::exception_ptr>(&outcome)) std::rethrow_exception(*failure);
  return std::get<Result>(std::move(outcome));
}

void Reconstructor::wait() {
  std::unique_lock lock(impl_->state);
  impl_->idle.wait(lock, [&] { return impl_->queue.empty() && !impl_->busy; });
}

Mesh Reconstructor::mesh() {
  return guarded([&] {
    const std::lock_guard lock(impl_->work);
    ExtractPass extract(impl_->device);
    const MeshSettings& settings = impl_->pipeline.settings().mesh;
    return toMesh(extractMesh(
        extract, impl_->pipeline.volume(),
        {static_cast<float>(settings.min_weight), static_cast<std::size_t>(settings.min_component)}));
  });
}

std::vector<TimedPose> Reconstructor::trajectory() const {
  const std::lock_guard lock(impl_->state);
  return impl_->trajectory;
}

std::size_t Reconstructor::blockCount() const {
  return impl_->view().blockCount();
}

std::string Reconstructor::setting(const std::string& key) const {
  return guarded([&] { return fieldText(impl_->pipeline.settings(), key, "setting()"); });
}

std::string Reconstructor::device() const {
  return impl_->device.info().name;
}

}  // namespace rosefusion
