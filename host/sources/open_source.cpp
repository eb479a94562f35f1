#include "host/sources/open_source.h"

#include <spdlog/spdlog.h>

#include "host/core/error.h"
#include "host/sources/camera.h"

namespace rosefusion {
namespace {

/// Refuses what only a recording can do.
void requireNoSelection(const std::string& text, const SourceOptions& options) {
  if (options.selection.start > 0)
    throw InputError(text + ": --start is for recorded sequences; a live source begins when it is opened.");
  if (options.selection.stride > 1)
    throw InputError(text + ": --stride is for recorded sequences; a live source is taken as it comes.");
  if (options.pace == Pace::Recorded)
    throw InputError(text + ": --realtime is for recorded sequences; this source has its own speed.");
}

std::unique_ptr<FrameSource> openStream(const std::string& text, const SourceOptions& options,
                                        const StopQuestion& stop) {
  requireNoSelection(text, options);
  if (options.sequence.intrinsics || options.sequence.depth_units_per_metre)
    throw InputError(text +
                     ": the sender says what its camera is like; give --intrinsics and --depth-scale there.");
  auto receiver = std::make_unique<StreamReceiver>(text, options.stream);
  spdlog::info(
      "listening on {}{}", receiver->endpoint(),
      options.stream.secret_key.empty() ? ", unencrypted and open to all who can reach it" : ", encrypted");
  if (!receiver->waitForStream(stop)) return nullptr;
  return receiver;
}

}  // namespace

bool isLiveSource(const std::string& text) {
  std::string device;
  return isStreamEndpoint(text) || cameraKindOf(text, device);
}

std::unique_ptr<FrameSource> openSource(const std::string& text, const SourceOptions& options,
                                        const StopQuestion& stop) {
  if (isStreamEndpoint(text)) return openStream(text, options, stop);
  CameraOptions camera;
  if (const CameraKind* kind = cameraKindOf(text, camera.device)) {
    requireNoSelection(text, options);
    if (options.sequence.depth_units_per_metre)
      throw InputError(text + ": the camera says what its depths mean; leave out --depth-scale.");
    camera.colour = options.sequence.colour;
    camera.intrinsics = options.sequence.intrinsics;
    return openCamera(*kind, camera);
  }
  auto sequence = openSequence(text, options.sequence);
  if (options.selection.start >= sequence->size())
    throw InputError(text + ": --start " + std::to_string(options.selection.start) +
                     " leaves nothing of its " + std::to_string(sequence->size()) +
                     " frames; give a smaller number.");
  return std::make_unique<SequenceSource>(std::move(sequence), options.selection, options.pace);
}

}  // namespace rosefusion
