#include "engine/passes/select_points.h"

#include "engine/error.h"

namespace rosefusion {

using namespace shader;

SelectPointsPass::SelectPointsPass(Device& device, const CameraIntrinsics& camera, std::uint32_t parts)
    : device_(device),
      camera_(camera),
      // To fill a GPU; a CPU spends more on a second dispatch than it saves by its other cores.
      parts_(parts                                   ? parts
             : device.info().type == DeviceType::Cpu ? 1
                                                     : 64),
      count_parts_(device, readerCode(device, "select_count"), kSelectCountBindings, sizeof(SelectParams)),
      kernel_(device, readerCode(device, "select_points"), kSelectBindings, sizeof(SelectParams)),
      counts_(device, 8 * parts_, Memory::Device),
      count_(device, 8, Memory::Device),
      told_(device, 8, Memory::Readback) {}

void SelectPointsPass::record(Recorder& recorder, const DeviceFrame& frame, const PixelGrid& grid,
                              const glm::mat4* previous_from_current) {
  const Recorder::Whole whole(recorder);
  if (grid.stride < 1 || grid.offset_x < 0 || grid.offset_y < 0 || grid.offset_x >= camera_.size.x ||
      grid.offset_y >= camera_.size.y)
    throw DeviceError(DeviceErrorCode::Programming, "The pixel grid does not lie inside the image.");
  const int columns = (camera_.size.x - grid.offset_x + grid.stride - 1) / grid.stride;
  const int rows = (camera_.size.y - grid.offset_y + grid.stride - 1) / grid.stride;
  cells_ = static_cast<std::uint32_t>(columns) * rows;
  const std::uint64_t bytes = 16ull * cells_;
  if (selected_.bytes() < bytes) selected_ = Buffer(device_, bytes, Memory::Device);
  SelectParams params{};
  params.previous_from_current = previous_from_current ? *previous_from_current : glm::mat4(1);
  params.focal_centre = camera_.focal_centre;
  params.size = glm::ivec4(camera_.size.x, camera_.size.y, grid.stride, previous_from_current != nullptr);
  params.grid = glm::ivec4(grid.offset_x, grid.offset_y, columns, rows);
  if (parts_ > 1) recorder.dispatch(count_parts_, {frame.points, counts_}, params, Groups{parts_});
  recorder.dispatch(kernel_, {frame.points, counts_, selected_, count_, told_}, params, Groups{parts_});
}

}  // namespace rosefusion
