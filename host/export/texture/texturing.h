// A mesh with a texture, made from the images of the recording that it comes from.
#pragma once
#include <functional>
#include <opencv2/core/mat.hpp>
#include <span>

#include "host/core/camera.h"
#include "host/core/frame.h"
#include "host/core/mesh.h"
#include "host/export/page.h"

namespace rosefusion {

/// mesh: no colours; vertices are there once for each part of the texture that they are in.
/// texture_coordinates: one per vertex, 0 to 1, from the left and from the top. texture: CV_8UC3 in BGR
/// order.
struct TexturedMesh {
  TriangleMesh mesh;
  std::vector<Eigen::Vector2f> texture_coordinates;
  cv::Mat texture;
  std::size_t views = 0;   ///< images that it is made of
  std::size_t charts = 0;  ///< pieces of them
  std::size_t unseen = 0;  ///< triangles that no view sees: with their vertices' colours
};

struct TexturingOptions {
  Intrinsics camera;  ///< of colour and depth images
  double depth_units_per_metre = 1000;
  double detail = 0.02;  ///< metres that the mesh tells surfaces apart by: a voxel
  /// Metres by which a depth image may differ from the mesh where it shows the same surface, at a depth in
  /// metres.
  std::function<double(double)> depth_tolerance = [](double) { return 0.06; };
  int largest = 4096;            ///< texels that the texture may be wide or high
  std::size_t most_views = 300;  ///< that are looked at
  /// Reads a frame of the recording, colour and depth; false where either is not there.
  std::function<bool(std::size_t, Frame&)> read;
  /// Called after each image that was read; what it throws ends the work. `what`: "looked at" or "used".
  std::function<void(const char* what, std::size_t done, std::size_t total)> progress;
};

/// Each triangle's texture comes from the tracked frame that sees it most sharply, with as few seams between
/// frames as are worth it. Images are read one after the other, those that are used twice. Large triangles
/// are split, since no single image shows the whole of them. Throws InputError where no frame is tracked,
/// none has colour, or the texture would be too small, and where this build cannot do it.
TexturedMesh textured(const TriangleMesh& mesh, std::span<const PageFrame> frames,
                      const TexturingOptions& options);

}  // namespace rosefusion
