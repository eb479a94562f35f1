// A result's images beside their poses, as programs for radiance fields and photogrammetry want them.
#pragma once
#include <filesystem>

#include "host/datasets/sequence.h"
#include "host/run/result.h"

namespace rosefusion::cli {

/// The recording of a result, with colour where it has any: at `recording`, or where that is empty where the
/// run found it. Throws InputError.
std::unique_ptr<Sequence> openImages(const RunResult& result, const std::filesystem::path& recording);

enum class ViewFormat { Nerfstudio, Colmap };

/// Into a folder: the recording's colour images (and depth in millimetres for nerfstudio) of all frames that
/// have a pose, with transforms.json, or sparse/0 of a COLMAP model. Reads the recording again: from
/// `recording`, or where empty from where the run found it. Throws InputError.
void exportViews(const RunResult& result, const std::filesystem::path& recording,
                 const std::filesystem::path& folder, ViewFormat format);

}  // namespace rosefusion::cli
