#include "host/bench/generated_sequence.h"

#include <fstream>
#include <iterator>
#include <string>

#include "host/core/error.h"
#include "host/synth/tum_writer.h"

namespace rosefusion {
namespace {

bool holdsText(const std::filesystem::path& file, const std::string& text) {
  std::ifstream in(file, std::ios::binary);
  return in && std::string(std::istreambuf_iterator<char>(in), {}) == text;
}

}  // namespace

std::unique_ptr<Sequence> generatedSequence(const std::filesystem::path& folder, const SynthOptions& synth) {
  {
    const SynthPlan plan(synth);
    if (!holdsText(folder / "synth.json", synthReport(plan))) writeTumSequence(folder, plan, true);
  }
  return sequenceWithTruth(folder, synth.colour);
}

std::unique_ptr<Sequence> sequenceWithTruth(const std::filesystem::path& folder, bool colour) {
  SequenceOptions options;
  options.colour = colour;
  auto sequence = openSequence(folder, options);
  if (sequence->info().truth.empty())
    throw InputError(folder.string() +
                     ": has no true trajectory to measure tracking against; leave this sequence out.");
  return sequence;
}

}  // namespace rosefusion
