// Records kernels and copies into a command buffer, and runs them.
#pragma once
#include <cstdint>
#include <exception>
#include <initializer_list>
#include <memory>
#include <span>

#include "engine/buffer.h"
#include "engine/kernel.h"

struct VkBuffer_T;  // what Vulkan's handles point to
struct VkCommandBuffer_T;
struct VkImage_T;

namespace rosefusion {

/// Numbers of invocations (not workgroups); rounded up to whole workgroups, so shaders check their range.
struct Threads {
  std::uint32_t x = 1;
  std::uint32_t y = 1;
  std::uint32_t z = 1;
};

/// A number of workgroups.
struct Groups {
  std::uint32_t count = 0;
};

/// What some of a kernel's bindings in a row are given: a buffer, or several, of which those beyond the first
/// `used` do not exist and the first stands in for them.
class BoundBuffers {
 public:
  BoundBuffers(const Buffer& one) : buffers_(&one, 1), used_(1) {}
  BoundBuffers(std::span<const Buffer> several, std::uint32_t used) : buffers_(several), used_(used) {}
  std::size_t size() const { return buffers_.size(); }
  const Buffer& operator[](std::size_t i) const { return buffers_[i < used_ ? i : 0]; }

 private:
  std::span<const Buffer> buffers_;
  std::uint32_t used_;
};

/// Which part of an image a copy writes.
enum class ImageAspect { Colour, Depth };

/// Pixels that a caller keeps on the device: in `buffer` from `offset` bytes on, row by row without gaps, or,
/// where that is null, in the colour aspect of `image`.
struct DevicePixels {
  VkBuffer_T* buffer = nullptr;
  std::uint64_t offset = 0;
  VkImage_T* image = nullptr;
  bool general = false;  ///< the image is in VK_IMAGE_LAYOUT_GENERAL, else in TRANSFER_SRC_OPTIMAL
};

/// Commands run in order, each seeing all that the ones before wrote, and all that was submitted to the
/// Device's queue before. Nothing runs before submit() or start(), or before the caller submits its own
/// command buffer. Movable; one thread. A pass object owns the buffers it fills, so record it once per
/// submit. Buffers and kernels are held until what uses them has run.
class Recorder {
 public:
  explicit Recorder(Device& device);
  ~Recorder();
  Recorder(Recorder&&) noexcept;
  Recorder& operator=(Recorder&&) noexcept;

  /// `buffers` in the order of the shader's bindings. Throws DeviceError (Programming) for a wrong number of
  /// buffers, an empty buffer, a wrong push size, or more than 256 dispatches since the last submit;
  /// (MissingLimit) for more workgroups along x than the device runs.
  template <typename Params>
  void dispatch(const Kernel& kernel, std::initializer_list<BoundBuffers> buffers, const Params& params,
                Threads threads) {
    dispatchBytes(kernel, {buffers.begin(), buffers.size()}, &params, sizeof(Params), threads);
  }
  /// The same with workgroups laid out on x and y, for kernels with one workgroup per item: the item is
  /// gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x, and may exceed groups - 1.
  template <typename Params>
  void dispatch(const Kernel& kernel, std::initializer_list<BoundBuffers> buffers, const Params& params,
                Groups groups) {
    dispatchBytes(kernel, {buffers.begin(), buffers.size()}, &params, sizeof(Params), groups);
  }
  /// The same where not all buffers are known beforehand.
  void dispatchBytes(const Kernel& kernel, std::span<const BoundBuffers> buffers, const void* push,
                     std::uint32_t push_bytes, Threads threads);
  void dispatchBytes(const Kernel& kernel, std::span<const BoundBuffers> buffers, const void* push,
                     std::uint32_t push_bytes, Groups groups);
  /// Throws DeviceError (Programming) when the bytes lie outside a buffer; so does fill().
  void copy(const Buffer& from, const Buffer& to, std::uint64_t bytes, std::uint64_t from_offset = 0,
            std::uint64_t to_offset = 0);
  /// Offset and size in bytes, multiples of 4.
  void fill(const Buffer& buffer, std::uint32_t word, std::uint64_t offset, std::uint64_t bytes);

  /// Fills `image`, of 4 bytes per texel in that aspect, from its upper left corner on; rows follow each
  /// other without a gap. The image must be in VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL or _GENERAL, as `general`
  /// says, and stays there; the write is a transfer write in the transfer stage, and no barrier for the image
  /// is recorded on either side.
  void copyToImage(const BufferPart& from, VkImage_T* image, ImageAspect aspect, std::uint32_t width,
                   std::uint32_t height, bool general = false);

  /// The other way round; reads in the transfer stage, and records no barrier before. Throws DeviceError
  /// (Programming) when there is no source or `to` is too small.
  void copyPixels(const DevicePixels& from, const Buffer& to, std::uint32_t width, std::uint32_t height,
                  std::uint32_t bytes_per_pixel);

  /// Runs what was recorded and waits for its end; mapped buffers then show the results. Throws DeviceError.
  void submit();
  /// Lets the device begin with what was recorded, and does not wait. What it reads must stay as it is until
  /// finish(): passes see to that, since each record() of theirs waits first.
  void start();
  /// Waits for what was started, if anything was. Throws DeviceError, also for what went wrong meanwhile.
  void finish();

  /// From now on commands go into `commands`, a primary command buffer that the caller has begun, outside of
  /// a render pass, and submits itself to the Device's queue; submit() throws DeviceError (Programming). What
  /// was recorded into an earlier one must have completed: its descriptor sets are let go, and the buffers
  /// that it used. Null: let go, and record for submit() again.
  void recordInto(VkCommandBuffer_T* commands);

  /// What was recorded since the last submit will not run. Of a caller's command buffer nothing is taken
  /// back: the caller resets it.
  void discard();
  /// Lives while commands are recorded that belong together, whose buffers the host may fill: what was
  /// started has ended before. An exception that ends it discards them, so that half of them does not run
  /// with what is recorded next.
  class Whole {
   public:
    explicit Whole(Recorder& recorder) : recorder_(recorder), exceptions_(std::uncaught_exceptions()) {
      recorder.finish();
    }
    Whole(const Whole&) = delete;
    ~Whole() {
      if (std::uncaught_exceptions() > exceptions_) recorder_.discard();
    }

   private:
    Recorder& recorder_;
    int exceptions_;
  };

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace rosefusion
