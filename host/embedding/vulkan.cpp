#include "rosefusion/vulkan.h"

#include "engine/passes/raycast.h"
#include "host/embedding/at_work.h"
#include "host/embedding/reconstructor_impl.h"
#include "host/embedding/vulkan_handles.h"
#include "host/slam/shader_types.h"

namespace rosefusion {

CallerDevice toCallerDevice(const VulkanHandles& h) {
  return {h.get_instance_proc_addr, h.instance,  h.api_version,    h.physical_device, h.device,      h.queue,
          h.queue_family,           h.allocator, h.pipeline_cache, h.lock_queue,      h.unlock_queue};
}

std::vector<SemaphorePoint> toPoints(const std::vector<Semaphores::Point>& points) {
  std::vector<SemaphorePoint> out;
  for (const auto& point : points) out.push_back({point.semaphore, point.value});
  return out;
}

VulkanRequirements vulkanRequirements() {
  const DeviceRequirements needs = deviceRequirements();
  return {needs.api_version,
          needs.queue_flags,
          needs.features,
          needs.extensions_where_offered,
          needs.instance_extension_where_offered,
          needs.instance_flag_with_it};
}

std::vector<std::string> missingFor(const VulkanHandles& handles) {
  return guarded([&] { return missingOf(toCallerDevice(handles)); });
}

struct View::Impl {
  Reconstructor::Impl& owner;
  Intrinsics camera;
  struct Slot {
    Recorder recorder;
    RaycastPass raycast;
  };
  std::vector<Slot> slots;
};

View::View(const Reconstructor& reconstructor, const Camera& camera, std::uint32_t slots)
    : impl_(guarded([&] {
        const AtWork at_work;
        auto impl =
            std::make_unique<Impl>(Impl{reconstructor.impl().inItsProcess(), toIntrinsics(camera), {}});
        Device& device = impl->owner.device;
        const auto kernels = std::make_shared<RaycastKernels>(device);
        kernels->prepare(impl->owner.view());
        for (std::uint32_t i = 0; i < slots; ++i)
          impl->slots.push_back(
              {Recorder(device), RaycastPass(device, toShader(impl->camera), Memory::Device, kernels)});
        return impl;
      })) {}
View::~View() {
  if (impl_) endUnlessForked(impl_, impl_->owner);
}
View::View(View&&) noexcept = default;
View& View::operator=(View&& other) noexcept {
  if (impl_) endUnlessForked(impl_, impl_->owner);
  impl_ = std::move(other.impl_);
  return *this;
}

void View::record(VkCommandBuffer commands, std::uint32_t slot, const Look& look, const ViewImages& images) {
  guarded([&] {
    (void)impl_->owner.inItsProcess();
    const AtWork at_work;
    if (!commands || slot >= impl_->slots.size())
      throw Error(Error::Kind::Misuse, "A View records into a command buffer and one of its " +
                                           std::to_string(impl_->slots.size()) + " slots; this is none.");
    auto& [recorder, raycast] = impl_->slots[slot];
    const auto& d = look.depth_value;
    std::optional<glm::vec4> depth_value;
    if (images.depth) depth_value = glm::vec4(d[0], d[1], d[2], d[3]);
    recorder.recordInto(commands);
    raycast.record(
        recorder, impl_->owner.view(),
        {toShader(look.world_from_camera), look.near, look.far, look.colour, look.clear, depth_value});
    const auto width = static_cast<std::uint32_t>(impl_->camera.width),
               height = static_cast<std::uint32_t>(impl_->camera.height);
    const bool general = images.layout == VK_IMAGE_LAYOUT_GENERAL;
    if (images.picture)
      recorder.copyToImage(raycast.picture(), images.picture, ImageAspect::Colour, width, height, general);
    if (images.depth)
      recorder.copyToImage(
          raycast.depth(), images.depth,
          images.depth_aspect == VK_IMAGE_ASPECT_DEPTH_BIT ? ImageAspect::Depth : ImageAspect::Colour, width,
          height, general);
  });
}

struct Fusion::Impl {
  Reconstructor::Impl& owner;
  Recorder recorder;
  FrameIntegrator fuser;
  struct Searched {
    TimedPose pose;
    cv::Mat depth;  ///< empty where it is on the device alone
  };
  std::optional<Searched> searched;  ///< and not fused yet

  template <typename Depth>
  void recordSearch(VkCommandBuffer commands, const Depth& depth, const Searched& frame) {
    owner.inItsProcess().requireNothingPushed();
    const Pose pose = toPose(frame.pose.world_from_camera);
    searched.reset();
    recorder.recordInto(commands);
    fuser.recordFrame(recorder, depth);
    fuser.recordSearch(recorder, owner.pipeline.volume(), pose);
    searched = frame;
  }
};

Fusion::Fusion(Reconstructor& reconstructor)
    : impl_(guarded([&] {
        const AtWork at_work;
        Reconstructor::Impl& owner = reconstructor.impl().inItsProcess();
        return std::make_unique<Impl>(Impl{owner, Recorder(owner.device), owner.pipeline.makeFuser()});
      })) {}
Fusion::~Fusion() {
  if (impl_) endUnlessForked(impl_, impl_->owner);
}
Fusion::Fusion(Fusion&&) noexcept = default;
Fusion& Fusion::operator=(Fusion&& other) noexcept {
  if (impl_) endUnlessForked(impl_, impl_->owner);
  impl_ = std::move(other.impl_);
  return *this;
}

void Fusion::recordSearch(VkCommandBuffer commands, const DepthFrame& frame,
                          const Matrix& world_from_camera) {
  guarded([&] {
    const Frame copy = copyOf(frame, impl_->owner.intrinsics);
    impl_->recordSearch(commands, copy, {{frame.timestamp, world_from_camera}, copy.depth});
  });
}

void Fusion::recordSearch(VkCommandBuffer commands, const DeviceDepth& depth,
                          const Matrix& world_from_camera) {
  guarded([&] {
    const DevicePixels pixels{depth.buffer, depth.offset, depth.image,
                              depth.layout == VK_IMAGE_LAYOUT_GENERAL};
    impl_->recordSearch(commands, pixels, {{depth.timestamp, world_from_camera}, {}});
  });
}

bool Fusion::grow() {
  return guarded([&] {
    const AtWork at_work;
    const std::lock_guard lock(impl_->owner.inItsProcess().work);
    Recorder own(impl_->owner.device);
    const bool again = impl_->fuser.grow(own, impl_->owner.pipeline.volume());
    own.submit();
    return again;
  });
}

void Fusion::recordFusion(VkCommandBuffer commands) {
  guarded([&] {
    Impl& d = *impl_;
    if (!d.searched)
      throw Error(
          Error::Kind::Misuse,
          "recordFusion() fuses the frame of the last recordSearch(), and there is none; call that first.");
    const AtWork at_work;
    const std::lock_guard lock(d.owner.inItsProcess().work);
    const auto& [stamped, depth] = *d.searched;
    const Pose pose = toPose(stamped.world_from_camera);
    d.recorder.recordInto(commands);
    d.fuser.recordFusion(d.recorder, d.owner.pipeline.volume(), pose);
    d.owner.pipeline.accept(pose, stamped.timestamp, depth);
    d.owner.publish(stamped.timestamp, &stamped.world_from_camera);
    d.searched.reset();
  });
}

VolumeBuffers volumeBuffers(const Reconstructor& reconstructor) {
  const auto view = std::make_shared<const VolumeView>(reconstructor.impl().view());
  VolumeBuffers out;
  out.layout = view->layoutBuffer().handle();
  out.table = view->table().handle();
  out.blocks = view->blockBuffer().handle();
  for (std::uint32_t chunk = 0; chunk < shader::kMaxPoolChunks; ++chunk) {
    out.tsdf[chunk] = view->tsdf()[chunk].handle();
    out.weight[chunk] = view->weight()[chunk].handle();
    out.colour[chunk] = view->colour()[chunk].handle();
  }
  out.chunks = view->chunks();
  out.block_count = view->blockCount();
  out.hold = view;
  return out;
}

}  // namespace rosefusion
