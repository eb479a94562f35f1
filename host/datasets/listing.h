// What a folder reader finds out before any image is opened, and the readers' declarations.
#pragma once
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "host/datasets/camera_source.h"
#include "host/datasets/sequence.h"

namespace rosefusion::datasets {

/// Of the formats that number their frames instead of stamping them.
inline constexpr double kFramesPerSecond = 30;

struct FrameFiles {
  double timestamp = 0;
  std::filesystem::path depth;
  std::filesystem::path colour;      ///< empty when the frame has none
  std::filesystem::path confidence;  ///< 8-bit map of how far the sensor trusts each depth; empty: none
};

struct Listing {
  std::string format;
  std::filesystem::path path;
  std::vector<FrameFiles> frames;  ///< in the order of the files; ImageSequence sorts them by time
  CameraSource camera;
  double depth_units_per_metre = 0;
  bool depth_units_assumed = true;  ///< by the format's convention, rather than read from a file
  int least_confidence = 1;         ///< depths of less are left out, where frames have a map
  bool colour_scaled = false;       ///< colour shows what depth shows at another size, to which it is brought
  double seconds_per_stamp = 1;
  Trajectory truth;
  std::vector<std::string> notes;
  std::vector<std::string> warnings;
};

/// A reader: `matches` looks at names only and never throws; `list` throws InputError for unusable lists.
struct Reader {
  const char* format;
  const char* looks_for;  ///< for the error about an unknown folder
  bool (*matches)(const std::filesystem::path& folder);
  Listing (*list)(const std::filesystem::path& folder);
};

extern const Reader kPngFolderReader;
extern const Reader kEth3dReader;
extern const Reader kIclNuimReader;
extern const Reader kTumReader;
extern const Reader kSevenScenesReader;
extern const Reader kReplicaReader;
extern const Reader kFastCaMoReader;
extern const Reader kOpen3dReader;
extern const Reader kScanNetReader;
extern const Reader kStrayReader;

/// Layout shared by TUM RGB-D and ETH3D: depth.txt, rgb.txt, associations, groundtruth.txt. `camera` is what
/// to use without a calibration.txt.
Listing listTumLayout(const std::filesystem::path& folder, const std::string& format,
                      const CameraSource& camera);

/// The release's packed file: int32 frames, height, width, then per frame uint16 millimetres and BGR bytes.
/// Throws InputError when the file's size is not what its header says.
std::unique_ptr<Sequence> openPackedSeq(const std::filesystem::path& file, const SequenceOptions& options);

/// A ROS recording (.bag, .db3, .mcap): the depth images of one topic, and colour where it is of their size.
/// Throws InputError for files that cannot be read and recordings without depth images.
std::unique_ptr<Sequence> openRosRecording(const std::filesystem::path& file, const SequenceOptions& options);

/// ScanNet's .sens, ElasticFusion's .klg and Record3D's .r3d. One that was cut is read up to there, with a
/// warning. Throws InputError for files that are none, and where not one depth image can be read.
std::unique_ptr<Sequence> openSens(const std::filesystem::path& file, const SequenceOptions& options);
std::unique_ptr<Sequence> openKlg(const std::filesystem::path& file, const SequenceOptions& options);
std::unique_ptr<Sequence> openRecord3d(const std::filesystem::path& file, const SequenceOptions& options);

/// An Azure Kinect's recording (.mkv); the same.
std::unique_ptr<Sequence> openAzureRecording(const std::filesystem::path& file,
                                             const SequenceOptions& options);

}  // namespace rosefusion::datasets
