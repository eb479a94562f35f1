// One name for every source: a folder, "tcp://ADDRESS:PORT", or a camera such as "openni2:".
#pragma once
#include <memory>
#include <string>

#include "host/sources/sequence_source.h"
#include "host/sources/stream.h"

namespace rosefusion {

struct SourceOptions {
  SequenceOptions sequence;
  RunOptions selection;  ///< of recorded sequences; others are taken as they come
  Pace pace = Pace::AsTaken;
  StreamOptions stream;
};

/// Whether `text` means a source that goes on while nobody takes its frames.
bool isLiveSource(const std::string& text);

/// Opens what `text` names; a stream is waited for. Null when stopped while waiting. Throws InputError.
std::unique_ptr<FrameSource> openSource(const std::string& text, const SourceOptions& options,
                                        const StopQuestion& stop = {});

}  // namespace rosefusion
