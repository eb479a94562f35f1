// A depth image on the device, as the passes read it.
#pragma once
#include <cstdint>

#include "engine/buffer.h"
#include "engine/depth_reach.h"

namespace rosefusion {

/// Made by PreprocessPass, valid once what that recorded has run.
struct DeviceFrame {
  Buffer depth;   ///< float metres per pixel, 0 = invalid
  Buffer points;  ///< vec4 per pixel, camera frame, w = 1 where valid
  Buffer colour;  ///< one word 0x00BBGGRR per pixel, read only where has_colour
  Buffer tiles;   ///< for the host: the largest depth in each tile of the image, metres
  int tile_columns = 0, tile_rows = 0;
  int tile_pixels = 1;  ///< along a tile's side
  bool has_colour = false;

  /// How far each part of the image sees.
  DepthReach reach() const {
    return {tiles.as<float>().first(std::size_t(tile_columns) * tile_rows), tile_columns, tile_pixels};
  }
};

}  // namespace rosefusion
