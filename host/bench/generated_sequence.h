// Sequences that a suite generates, or finds where it has left them.
#pragma once
#include <filesystem>
#include <memory>

#include "host/datasets/sequence.h"
#include "host/synth/options.h"

namespace rosefusion {

/// Generates the sequence unless the folder holds the same one, and opens it. Throws InputError as
/// writeTumSequence().
std::unique_ptr<Sequence> generatedSequence(const std::filesystem::path& folder, const SynthOptions& synth);

/// Opens a recording. Throws InputError, also where it has no true trajectory.
std::unique_ptr<Sequence> sequenceWithTruth(const std::filesystem::path& folder, bool colour);

}  // namespace rosefusion
