// The Reconstructor's insides, for the other classes of the public headers.
#pragma once
#include <condition_variable>
#include <deque>
#include <exception>
#include <mutex>
#include <thread>
#include <variant>

#include "engine/device.h"
#include "host/core/system.h"
#include "host/embedding/convert.h"
#include "rosefusion/vulkan.h"

namespace rosefusion {

struct ROSEFUSION_HIDDEN Reconstructor::Impl {
  /// With handles: on the caller's device, else on one of its own.
  Impl(const Camera& camera, const VulkanHandles* handles, const Options& options);
  ~Impl();

  /// False in a child of fork(), which has neither the threads of the process that made this, nor its device.
  bool isOfThisProcess() const { return process_number == processNumber(); }
  /// Itself. Throws Error (Misuse) in a child of fork().
  Impl& inItsProcess();

  /// The model as the last finished frame left it. Any thread.
  VolumeView view() const;
  /// One frame on this thread, which must hold `work`.
  Result process(const Frame& frame, const Semaphores& semaphores);
  /// Publishes what a frame did to the model; `pose` empty: it was lost.
  void publish(double timestamp, const Matrix* world_from_camera);
  /// Throws Error (Misuse) while pushed frames are waiting or under way.
  void requireNothingPushed() const;
  bool push(Frame frame, const Semaphores& semaphores);
  void workOff();

  std::uint64_t process_number = processNumber();
  Intrinsics intrinsics;
  std::size_t queue_length;
  Device device;
  Pipeline pipeline;
  double last_timestamp = 0;  ///< of the frame processed last
  std::mutex work;            ///< held while anything is done to pipeline; taken before `state`

  mutable std::mutex state;  ///< of all below; held for moments only
  struct Pushed {
    Frame frame;
    Semaphores semaphores;
  };
  std::deque<Pushed> queue;
  bool busy = false, stopping = false;
  std::deque<std::variant<Result, std::exception_ptr>> results;
  std::vector<TimedPose> trajectory;
  VolumeView current;
  std::condition_variable wake, idle;
  std::thread worker;  ///< from the first pushed frame on
};

/// Ends `owned`, something of `owner`'s or itself, but in a child of fork(), where to end it would be to wait
/// for threads that are not there: its memory is left as it is.
template <typename Owned>
void endUnlessForked(std::unique_ptr<Owned>& owned, const Reconstructor::Impl& owner) {
  if (!owner.isOfThisProcess()) (void)owned.release();
  owned.reset();
}

}  // namespace rosefusion
