#include "apps/cli/export_texture.h"

#include <spdlog/spdlog.h>

#include <optional>

#include "apps/cli/exit_code.h"
#include "apps/cli/export_views.h"
#include "apps/cli/interrupt.h"
#include "apps/cli/progress.h"
#include "host/core/error.h"
#include "host/settings/settings.h"

namespace rosefusion::cli {
namespace {

/// Tells of each part of the work on its own, and ends it after Ctrl-C.
class TextureProgress {
 public:
  void update(const std::string& what, std::size_t done, std::size_t total) {
    if (interrupted()) {
      progress_.reset();  // ends its line
      spdlog::warn("Interrupted; no mesh with a texture is written.");
      throw ExitCode(kExitInterrupted);
    }
    if (what != what_) progress_.emplace("images");
    what_ = what;
    progress_->update(done, total, what);
    if (done == total) progress_.reset();
  }

 private:
  std::string what_;
  std::optional<Progress> progress_;
};

}  // namespace

TexturedMesh texturedResult(const RunResult& result, const TriangleMesh& mesh,
                            const std::filesystem::path& recording, int largest) {
  const auto sequence = openImages(result, recording);
  if (!sequence->info().has_colour)
    throw InputError(sequence->info().path.string() +
                     ": has no colour images registered to depth, which a texture is made of; export without "
                     "--texture.");
  const std::filesystem::path settings_file = result.folder / "settings.yaml";
  const Settings settings =
      std::filesystem::exists(settings_file) ? loadSettings(settings_file.string()) : Settings();
  catchInterrupts();
  TextureProgress progress;
  TexturingOptions options;
  options.camera = result.camera.value_or(sequence->info().intrinsics);
  options.depth_units_per_metre = sequence->info().depth_units_per_metre;
  options.detail = settings.volume.voxel_size;
  // What lies further off than the truncation was not fused into this surface.
  options.depth_tolerance = [&settings](double depth) {
    return settings.volume.truncation + 3 * settings.depth.deviationAt(depth);
  };
  options.largest = largest;
  options.read = [&](std::size_t number, Frame& frame) {
    std::string problem;
    return number < sequence->size() && sequence->read(number, frame, problem) && !frame.colour.empty() &&
           frame.colour.cols == options.camera.width && frame.colour.rows == options.camera.height;
  };
  options.progress = [&](const char* what, std::size_t done, std::size_t total) {
    progress.update(what, done, total);
  };
  TexturedMesh textured_mesh = textured(mesh, result.frames, options);
  if (2 * textured_mesh.unseen > textured_mesh.mesh.triangles.size())
    spdlog::warn(
        "{} of {} triangles are seen whole by no image and keep their vertices' colours; is {} the recording "
        "of {}?",
        textured_mesh.unseen, textured_mesh.mesh.triangles.size(), sequence->info().path.string(),
        result.folder.string());
  return textured_mesh;
}

}  // namespace rosefusion::cli
