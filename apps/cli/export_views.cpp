#include "apps/cli/export_views.h"

#include <spdlog/spdlog.h>

#include <opencv2/imgcodecs.hpp>

#include "apps/cli/progress.h"
#include "host/core/error.h"
#include "host/core/file_io.h"
#include "host/core/number_text.h"
#include "host/export/pose_formats.h"

namespace rosefusion::cli {
namespace {

void writeImage(const std::filesystem::path& file, const cv::Mat& image) {
  std::vector<std::uint8_t> bytes;
  cv::imencode(file.extension().string(), image, bytes);
  writeFileAtomically(file, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

}  // namespace

std::unique_ptr<Sequence> openImages(const RunResult& result, const std::filesystem::path& recording) {
  const std::filesystem::path source = recording.empty() ? result.recording : recording;
  if (!std::filesystem::exists(source))
    throw InputError(source.string() + ": the recording of " + result.folder.string() +
                     " is not there, and its images are needed; say where it is with --recording.");
  SequenceOptions options = result.opened_with;
  options.colour = true;
  return openSequence(source, options);
}

void exportViews(const RunResult& result, const std::filesystem::path& recording,
                 const std::filesystem::path& folder, ViewFormat format) {
  const auto sequence = openImages(result, recording);
  const std::string source = sequence->info().path.string();
  if (!sequence->info().has_colour)
    throw InputError(source +
                     ": has no colour images registered to depth, which this format is made of; export poses "
                     "with --as tum or kitti instead.");
  std::vector<ExportedView> views;
  Progress progress("images");
  for (const PageFrame& frame : result.frames) {
    progress.update(static_cast<std::size_t>(&frame - result.frames.data()) + 1, result.frames.size(),
                    "written");
    if (!frame.placed || frame.number >= sequence->size()) continue;
    Frame images;
    std::string problem;
    if (!sequence->read(frame.number, images, problem) || images.colour.empty()) continue;
    const std::string name = printed("frame_%06zu", frame.number);
    ExportedView view{"images/" + name + ".jpg", "", frame.world_from_camera};
    writeImage(folder / view.colour, images.colour);
    if (format == ViewFormat::Nerfstudio) {
      view.depth = "depth/" + name + ".png";
      cv::Mat millimetres;
      images.depth.setTo(0, images.depth == 65535);
      images.depth.convertTo(millimetres, CV_16U, 1000 / sequence->info().depth_units_per_metre);
      writeImage(folder / view.depth, millimetres);
    } else {
      view.colour = name + ".jpg";  // COLMAP looks for it in its own folder of images
    }
    views.push_back(view);
  }
  if (views.empty())
    throw InputError(source + ": no frame with a pose has a colour image; is it the recording of " +
                     result.folder.string() + "?");
  const Intrinsics& k = result.camera.value_or(sequence->info().intrinsics);
  if (format == ViewFormat::Nerfstudio) {
    writeFileAtomically(folder / "transforms.json", nerfstudioOf(k, views));
  } else {
    const ColmapModel model = colmapOf(k, views);
    writeFileAtomically(folder / "sparse/0/cameras.txt", model.cameras);
    writeFileAtomically(folder / "sparse/0/points3D.txt", model.points);
    writeFileAtomically(folder / "sparse/0/images.txt", model.images);
  }
}

}  // namespace rosefusion::cli
