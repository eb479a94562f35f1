#include "host/run/recording.h"

#include "host/core/error.h"
#include "host/core/file_io.h"
#include "host/core/number_text.h"
#include "host/export/png.h"

namespace rosefusion {
namespace {

namespace fs = std::filesystem;

constexpr const char* kDescription = "sequence.yaml";

}  // namespace

void RecordingWriter::requireUsable(const fs::path& folder) {
  const fs::path part = settledPath(folder) += ".part";
  if (fs::exists(part / kDescription))
    throw InputError(part.string() +
                     ": is a recording that was not finished; rename it to keep it, or remove it.");
  StagedFolder::requireUsable(folder, "");
}

RecordingWriter::RecordingWriter(const fs::path& folder, const SequenceInfo& info)
    : folder_((requireUsable(folder), folder), ""), info_(info) {
  if (!info_.truth.empty()) {
    Trajectory truth = info_.truth;
    for (StampedPose& pose : truth) pose.timestamp *= info_.seconds_per_stamp;
    writeTumTrajectory(folder_.part() / "groundtruth.txt", truth);
  }
}

bool RecordingWriter::add(const Frame& frame) {
  const double seconds = frame.timestamp * info_.seconds_per_stamp;
  const std::string name = printed("%.6f.png", seconds);
  if (frames_ > 0 && (name == last_name_ || seconds < last_seconds_)) return false;
  writePng(folder_.part() / "depth" / name, frame.depth);
  const bool coloured = frame.colour.size() == frame.depth.size();
  if (coloured) writePng(folder_.part() / "rgb" / name, frame.colour);
  if (frames_ == 0 || (coloured && !has_colour_)) {
    describe(coloured);
    folder_.keep();
  }
  has_colour_ |= coloured;
  ++frames_;
  last_name_ = name;
  last_seconds_ = seconds;
  return true;
}

void RecordingWriter::describe(bool colour) const {
  const Intrinsics& k = info_.intrinsics;
  std::string text = printed("# Recorded from %s (%s)\n", info_.path.string().c_str(), info_.format.c_str());
  text += printed("intrinsics: {width: %d, height: %d, fx: %.9g, fy: %.9g, cx: %.9g, cy: %.9g}\n", k.width,
                  k.height, k.fx, k.fy, k.cx, k.cy);
  text += printed("depth_units_per_metre: %.9g\ndepth: depth/*.png\ntimestamps: names\n",
                  info_.depth_units_per_metre);
  if (colour) text += "colour: rgb/*.png\n";
  if (!info_.truth.empty()) text += "trajectory: groundtruth.txt\n";
  writeFileAtomically(folder_.part() / kDescription, text);
}

void RecordingWriter::finish() {
  folder_.takePlace();
}

}  // namespace rosefusion
