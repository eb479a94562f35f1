// Settings that follow from what the camera sees: volume.voxel_size, volume.truncation and depth.sensor where
// they are 'auto', and with them tracking.min_valid_share.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "host/settings/settings.h"

namespace rosefusion {

/// Measured on the first images of a recording or camera; lengths in metres. host/survey/ makes it.
struct SceneMeasures {
  double valid_share = 1;  ///< of the pixels
  double median_depth = 0;
  double far_depth = 0;    ///< a tenth of the depths are farther
  double view_width = 0;   ///< of what has depth in the image, at a depth of 1
  double pixel_width = 0;  ///< the same of a pixel
  bool phone = false;      ///< the images have a phone's size
  struct Deviation {
    double depth, deviation;
  };
  /// What flat pieces of the image deviate from planes by, by depth; see SensorModel::flatDeviation(). Empty
  /// where too few are flat.
  std::vector<Deviation> flat;
  std::string sensor;  ///< whose recording it is, as depth.sensor has it; empty: the recording does not say
};

/// Frames whose images are looked at: enough that one of them may be dark or covered.
inline constexpr std::size_t kSurveyedFrames = 5;

/// Whether anything in it follows from what the camera sees, or could contradict it.
bool hasAutomatic(const Settings& settings);

/// How far the measured deviations are from a model's: mean of |log2 of their ratio|. None where none were
/// measured.
std::optional<double> misfit(const SensorModel& model, const SceneMeasures& scene);

/// `settings` with a value for each that is 'auto': what suits the scene, or a room and Kinect-like noise
/// where nothing is known of it.
Settings resolved(Settings settings, const std::optional<SceneMeasures>& scene = {});

/// What was chosen and why, for people; one sentence each.
std::vector<std::string> choicesOf(const Settings& asked, const Settings& resolved,
                                   const std::optional<SceneMeasures>& scene);

}  // namespace rosefusion
