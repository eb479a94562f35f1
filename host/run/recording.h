// A source's frames kept as a recording that 'run' takes.
#pragma once
#include "host/core/staged_folder.h"
#include "host/sources/frame_source.h"

namespace rosefusion {

/// Writes a folder of PNGs with a sequence.yaml: depth as it comes, in the source's units, named after its
/// stamps in seconds, colour where a frame has it, the truth where the source knows it. Until finish() it is
/// FOLDER.part, which is a recording too, of the frames so far. One thread.
class RecordingWriter {
 public:
  /// Throws InputError where the folder cannot be made, or a recording that was not finished is in its way.
  static void requireUsable(const std::filesystem::path& folder);

  /// Throws as requireUsable().
  RecordingWriter(const std::filesystem::path& folder, const SequenceInfo& info);
  /// Throws InputError where it cannot be written. False, and it is left out, where its stamp is not after
  /// the one before: its name would be taken, or the order another one.
  bool add(const Frame& frame);
  std::size_t frames() const { return frames_; }
  /// Throws InputError; then the frames are in FOLDER.part.
  void finish();

 private:
  void describe(bool colour) const;

  StagedFolder folder_;
  SequenceInfo info_;
  std::size_t frames_ = 0;
  bool has_colour_ = false;
  std::string last_name_;
  double last_seconds_ = 0;
};

}  // namespace rosefusion
