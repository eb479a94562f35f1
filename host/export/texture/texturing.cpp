#include "host/export/texture/texturing.h"

#include <algorithm>
#include <map>
#include <opencv2/imgproc.hpp>

#include "host/core/error.h"
#include "host/core/split_edges.h"
#include "host/export/texture/exposure.h"
#include "host/export/texture/layout.h"
#include "host/export/texture/packing.h"
#include "host/export/texture/paint.h"

namespace rosefusion {
namespace {

class Texturing {
 public:
  Texturing(const TriangleMesh& mesh, std::span<const PageFrame> frames, const TexturingOptions& options)
      : options_(options),
        mesh_(mesh),
        views_(chooseViews(frames, options.camera, mesh, options.most_views)) {
    if (views_.empty())
      throw InputError(
          "--texture: the result has no tracked frame, whose image a texture could be made of; "
          "export it without.");
    // An image shows such a triangle whole, or next to nothing of it.
    constexpr double kPixels = 32;
    splitLongEdges(mesh_, static_cast<float>(usualLength(views_, options.camera, kPixels)));
  }

  TexturedMesh make() {
    const std::vector<int> labels = chosenLabels();
    layout_ = layOut(mesh_, labels, views_, options_.camera, options_.largest);
    paint();
    TexturedMesh out = withCoordinates();
    out.texture = texture_;
    return out;
  }

 private:
  std::vector<int> chosenLabels() {
    ViewQualities qualities(mesh_.triangles.size());
    gains_.assign(views_.size(), Gains::all(1));
    std::size_t read = 0;
    for (std::size_t i = 0; i < views_.size(); ++i) {
      Frame frame;
      std::vector<SeenTriangle> seen;
      if (options_.read(views_[i].frame, frame) && !frame.colour.empty()) {
        ++read;
        seen = seenTriangles(mesh_, options_.camera, views_[i], metresOf(frame.depth),
                             {options_.detail, options_.depth_tolerance});
        gains_[i] = gainsOf(mesh_, seen, views_[i], options_.camera, frame.colour);
      }
      qualities.add(std::move(seen));
      if (options_.progress) options_.progress("looked at", i + 1, views_.size());
    }
    if (read == 0)
      throw InputError(
          "--texture: none of the recording's frames that were tracked has a colour image that can be "
          "read; say where the recording is with --recording, or export without.");
    qualities.forgetTheWorst();
    return chooseLabels(mesh_, qualities);
  }

  cv::Mat metresOf(cv::Mat depth) const {
    depth.setTo(0, depth == 65535);
    cv::Mat metres;
    depth.convertTo(metres, CV_32F, 1 / options_.depth_units_per_metre);
    return metres;
  }

  void paint() {
    texture_ = cv::Mat(layout_.height, layout_.width, CV_8UC3, cv::Scalar::all(128));
    paintSwatches(texture_, layout_, mesh_);
    std::map<int, std::vector<const Chart*>> charts;
    for (const Chart& chart : layout_.charts) charts[chart.view].push_back(&chart);
    used_ = charts.size();
    std::size_t done = 0;
    for (const auto& [view, its_charts] : charts) {
      const auto i = static_cast<std::size_t>(view);
      Frame frame;
      if (!options_.read(views_[i].frame, frame) || frame.colour.empty())
        throw InputError("--texture: the colour image of frame " + std::to_string(views_[i].frame) +
                         " could be read once, but not again; leave the recording alone meanwhile.");
      cv::Mat colour = levelled(frame.colour, gains_[i]);
      if (layout_.scale < 1) cv::resize(colour, colour, {}, layout_.scale, layout_.scale, cv::INTER_AREA);
      for (const Chart* chart : its_charts)
        paintChart(texture_, layout_, *chart, mesh_, views_[i], options_.camera, colour);
      if (options_.progress) options_.progress("used", ++done, charts.size());
    }
  }

  TexturedMesh withCoordinates() const {
    TexturedMesh out;
    out.views = used_;
    out.charts = layout_.charts.size();
    out.mesh.origin = mesh_.origin;
    const auto addVertex = [&](std::uint32_t v, const Eigen::Vector2d& texel) {
      out.mesh.vertices.push_back(mesh_.vertices[v]);
      if (!mesh_.normals.empty()) out.mesh.normals.push_back(mesh_.normals[v]);
      out.texture_coordinates.emplace_back((texel.x() + 0.5) / layout_.width,
                                           (texel.y() + 0.5) / layout_.height);
      return static_cast<std::uint32_t>(out.mesh.vertices.size() - 1);
    };
    std::vector<std::uint32_t> place(mesh_.vertices.size()), chart_of(mesh_.vertices.size(), 0);
    for (std::size_t i = 0; i < layout_.charts.size(); ++i) {
      const Chart& chart = layout_.charts[i];
      for (std::size_t k = 0; k < chart.triangles.size(); ++k) {
        const auto texels =
            texelsOf(layout_, chart, k, mesh_, views_[static_cast<std::size_t>(chart.view)], options_.camera);
        auto triangle = mesh_.triangles[chart.triangles[k]];
        for (std::size_t c = 0; c < 3; ++c) {
          const std::uint32_t v = triangle[c];
          if (chart_of[v] != i + 1) place[v] = addVertex(v, texels[c]);
          chart_of[v] = static_cast<std::uint32_t>(i + 1);
          triangle[c] = place[v];
        }
        out.mesh.triangles.push_back(triangle);
      }
    }
    for (const Swatches& swatches : layout_.swatches)
      for (std::size_t k = 0; k < swatches.triangles.size(); ++k) {
        const auto texels = texelsOf(layout_, swatches, k);
        auto triangle = mesh_.triangles[swatches.triangles[k]];
        for (std::size_t c = 0; c < 3; ++c) triangle[c] = addVertex(triangle[c], texels[c]);
        out.mesh.triangles.push_back(triangle);
        ++out.unseen;
      }
    return out;
  }

  const TexturingOptions& options_;
  TriangleMesh mesh_;
  std::vector<TextureView> views_;
  std::vector<Gains> gains_;
  TextureLayout layout_;
  cv::Mat texture_;
  std::size_t used_ = 0;
};

}  // namespace

TexturedMesh textured(const TriangleMesh& mesh, std::span<const PageFrame> frames,
                      const TexturingOptions& options) {
  if (!packingAvailable())
    throw InputError(
        "--texture: this rosefusion was built without it; install libstb-dev and build it again, or export "
        "without.");
  return Texturing(mesh, frames, options).make();
}

}  // namespace rosefusion
