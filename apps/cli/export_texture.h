// A result's mesh with a texture from the recording's images.
#pragma once
#include <filesystem>

#include "host/export/texture/texturing.h"
#include "host/run/result.h"

namespace rosefusion::cli {

/// `mesh` is the result's, in its own axes. Reads the recording again, from `recording`, or where that is
/// empty from where the run found it. `largest`: texels that the texture may be wide or high. Throws
/// InputError, and ExitCode after Ctrl-C.
TexturedMesh texturedResult(const RunResult& result, const TriangleMesh& mesh,
                            const std::filesystem::path& recording, int largest);

}  // namespace rosefusion::cli
