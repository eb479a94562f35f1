// A recorded depth sequence of any known layout, opened by openSequence() and read frame by frame.
#pragma once
#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host/core/camera.h"
#include "host/core/frame.h"
#include "host/core/trajectory.h"

namespace rosefusion {

/// What the caller knows better than the files do.
struct SequenceOptions {
  bool colour = false;                          ///< load Frame::colour where there is any
  std::optional<Intrinsics> intrinsics;         ///< width and height 0: those of the images
  std::optional<double> depth_units_per_metre;  ///< depth in metres = value / this
  std::string topic;                            ///< of the depth images in a ROS recording; empty: chosen
};

/// Everything known about a sequence before its frames are read.
struct SequenceInfo {
  std::string format;  ///< such as "TUM RGB-D"
  std::filesystem::path path;
  SequenceOptions opened_with;      ///< which opens it again
  Intrinsics intrinsics;            ///< of the depth images; width and height are always set
  std::string intrinsics_source;    ///< the file or the convention they come from
  bool intrinsics_assumed = false;  ///< by convention rather than read from a file or given by the caller
  double depth_units_per_metre = 0;
  bool depth_units_assumed = false;  ///< by the format's convention
  std::size_t frames = 0;
  std::string sensor;       ///< whose recording it is, as depth.sensor has it, where the file tells
  bool has_colour = false;  ///< colour exists for at least one frame, whether it is asked for or not
  /// Seconds that one unit of the time stamps lasts: 1, except where the data set stamps with frame numbers
  /// (ICL-NUIM: 1/30). Stamps are passed on as the data set has them, so that its own truth file still fits.
  double seconds_per_stamp = 1;
  Trajectory truth;  ///< world_from_camera at the stamps of the truth file, ascending; empty when unknown
  std::vector<std::string> notes;     ///< what the reader decided by itself
  std::vector<std::string> warnings;  ///< input that was wrong and was worked around
};

/// One recorded sequence. Not thread-safe: one reading thread at a time.
class Sequence {
 public:
  virtual ~Sequence() = default;
  const SequenceInfo& info() const { return info_; }
  std::size_t size() const { return info_.frames; }
  /// Time stamp of frame `index` < size() without reading it; ascending in `index`.
  virtual double timestamp(std::size_t index) const = 0;
  /// Reads frame `index` < size(). False when its depth is unusable (missing, truncated, 8-bit, of another
  /// size): `problem` is then one sentence that names the file, and the caller should warn and go on with the
  /// next frame. True with a non-empty `problem`: the depth is good but its colour could not be read and is
  /// left empty, or its confidence map could not be read and all of it is taken.
  virtual bool read(std::size_t index, Frame& frame, std::string& problem) = 0;

 protected:
  SequenceInfo info_;
};

/// Opens a folder (or a recording in one file: .bag, .db3, .mcap, .mkv, .sens, .klg, .r3d, .seq), choosing
/// the reader by what lies in it: TUM RGB-D, ETH3D SLAM, ICL-NUIM, 7-Scenes, Replica (NICE-SLAM), FastCaMo,
/// Stray Scanner, ScanNet, Open3D, or PNGs described by a sequence.yaml, which wins over all others. Throws
/// InputError for a missing, empty or unknown folder (the sentence lists what was looked for), an unreadable
/// list, implausible intrinsics, or when not one of its depth images can be read.
std::unique_ptr<Sequence> openSequence(const std::filesystem::path& path,
                                       const SequenceOptions& options = {});

}  // namespace rosefusion
