// A generated sequence as a TUM RGB-D folder.
#pragma once
#include <filesystem>
#include <functional>

#include "host/synth/sequence.h"

namespace rosefusion {

/// Throws InputError when `folder` exists and is not empty (unless `force`), or is no folder. To be called
/// before any long work.
void requireUsableOutput(const std::filesystem::path& folder, bool force);

/// Renders and writes everything: depth/*.png (16 bit, 5000 a metre), depth.txt, groundtruth.txt,
/// calibration.txt (fx fy cx cy), mesh.ply (the true surface), mesh_seen.ply (what of it the camera saw),
/// with colour rgb/*.png and rgb.txt, and synth.json. Written beside `folder` as FOLDER.part and renamed at
/// the end, so that a folder that is there is whole; with `force` it replaces what is there.
/// `progress`(frames done, of) may be called by any thread, one at a time; what it throws ends the work, and
/// nothing of it is left.
void writeTumSequence(const std::filesystem::path& folder, const SynthPlan& plan, bool force,
                      const std::function<void(int, int)>& progress = {});

/// The text of synth.json: options, and statistics of the true motion.
std::string synthReport(const SynthPlan& plan);

}  // namespace rosefusion
