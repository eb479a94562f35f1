#include "apps/viewer/scene.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "host/slam/shader_types.h"

namespace rosefusion::viewer {
namespace {

using namespace std::chrono_literals;

constexpr double kCoarsePixels = 70'000;  // what a software device casts beside tracking in some 15 ms
constexpr auto kBetweenModels = 250ms;    // a growing model is looked at so often; a moving view, every frame
constexpr auto kStill = 400ms;            // after which the full resolution is worth its time
constexpr float kFar = 60;                // metres

Intrinsics scaled(const Intrinsics& k, double factor) {
  const int width = std::max(8, static_cast<int>(k.width * factor)),
            height = std::max(8, static_cast<int>(k.height * factor));
  const double x = double(width) / k.width, y = double(height) / k.height;
  return {width, height, k.fx * x, k.fy * y, (k.cx + 0.5) * x - 0.5, (k.cy + 0.5) * y - 0.5};
}

}  // namespace

Scene::Scene(Gpu& gpu, Device& device)
    : gpu_(gpu),
      device_(device),
      coarse_pixels_(device.info().type == DeviceType::Cpu ? kCoarsePixels : 1e9),
      recorder_(device),
      kernels_(std::make_shared<RaycastKernels>(device)) {}

Scene::Caster& Scene::casterFor(const Intrinsics& camera) {
  Caster& caster = double(camera.width) * camera.height > coarse_pixels_ ? fine_ : coarse_;
  if (caster.pass && caster.camera == camera) return caster;
  caster.camera = camera;
  caster.pass = std::make_unique<RaycastPass>(device_, toShader(camera), Memory::Device, kernels_);
  caster.image = Image(gpu_, camera.width, camera.height, 0);
  return caster;
}

void Scene::record(VkCommandBuffer commands, const Snapshot& snapshot, const Pose& world_from_view,
                   const Intrinsics& view, bool finest) {
  recorder_.recordInto(commands);
  if (snapshot.generation != shown_generation_) {
    shown_ = nullptr;
    shown_depth_ = 0;
    shown_generation_ = snapshot.generation;
  }
  recordDepth(commands, snapshot);
  provisional_ = false;
  if (!snapshot.model || snapshot.model->blockCount() == 0) return;

  const auto now = Clock::now();
  const bool moved = !shown_ || !world_from_view.isApprox(shown_pose_, 1e-9) || !(view == shown_view_);
  const bool grown = snapshot.model_number != shown_model_;
  if (moved) last_move_ = now;
  const double coarse = std::min(1.0, std::sqrt(coarse_pixels_ / (double(view.width) * view.height)));
  const bool still = snapshot.phase != Phase::Playing && now - last_move_ > kStill;
  const bool is_fine = shown_ && shown_->camera.width == view.width;
  const bool refine = !is_fine && (finest || still);
  provisional_ = !is_fine || grown;
  if (!moved && !refine && !(grown && now - last_cast_ > kBetweenModels)) return;

  Caster& caster = casterFor(scaled(view, finest || still ? 1 : coarse));
  RaycastView cast;
  cast.world_from_camera = toShader(world_from_view);
  cast.far = kFar;
  caster.pass->record(recorder_, *snapshot.model, cast);
  caster.image.change(commands, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, true);
  recorder_.copyToImage(caster.pass->picture(), caster.image.handle(), ImageAspect::Colour,
                        static_cast<std::uint32_t>(caster.camera.width),
                        static_cast<std::uint32_t>(caster.camera.height));
  caster.image.change(commands, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL);
  shown_ = &caster;
  shown_pose_ = world_from_view;
  shown_view_ = view;
  shown_model_ = snapshot.model_number;
  last_cast_ = now;
}

void Scene::recordDepth(VkCommandBuffer commands, const Snapshot& snapshot) {
  if (snapshot.depth.empty() || snapshot.depth_number == shown_depth_) return;
  const std::size_t bytes = 4 * snapshot.depth.total();
  if (depth_.width() != snapshot.depth.cols || depth_.height() != snapshot.depth.rows) {
    depth_ = Image(gpu_, snapshot.depth.cols, snapshot.depth.rows, 0);
    depth_pixels_ = Buffer(device_, bytes, Memory::Upload);
  }
  std::memcpy(depth_pixels_.as<std::uint8_t>().data(), snapshot.depth.data, bytes);
  depth_.change(commands, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, true);
  recorder_.copyToImage(depth_pixels_, depth_.handle(), ImageAspect::Colour,
                        static_cast<std::uint32_t>(depth_.width()),
                        static_cast<std::uint32_t>(depth_.height()));
  depth_.change(commands, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL);
  shown_depth_ = snapshot.depth_number;
}

void Scene::place(VkCommandBuffer commands, VkImage canvas, const Rectangle& surface,
                  const Rectangle& depth) {
  if (shown_) recordScaled(commands, shown_->image, canvas, surface);
  // The second picture lies on the first.
  recordBarrier(commands, canvas, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL);
  if (shown_depth_ > 0 && depth.width > 0) recordScaled(commands, depth_, canvas, depth);
}

}  // namespace rosefusion::viewer
