#include "host/settings/automatic.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include "host/core/number_text.h"

namespace rosefusion {
namespace {

constexpr double kRoomVoxel = 0.02;
// Where the view is smaller than a room's: the step nearest to this share of its width at the median depth.
// In rooms finer voxels cost time and bring nothing (tests/bench/notes/sensors.md#voxel-size).
constexpr double kVoxelsAcross = 80;
constexpr double kMostAcrossFar = 600;  // of the view at its far end: what is seen later may be there
constexpr double kPixelsOfVoxel = 1;    // at least, or most voxels of a surface are seen by chance
constexpr double kSteps[] = {0.0025, 0.005, 0.01, 0.02, 0.04, 0.08};
// A fine voxel's truncation has to hold the noise and the motion of a frame, which do not shrink as the voxel
// does.
constexpr double kFineTruncation = 4, kTruncation = 3;  // voxels
// The far depths of one surface must meet in what is truncated around it, or a model of one image has none.
constexpr double kFarDeviations = 1.4;
// Finer voxels hold nothing but noise.
constexpr double kDeviationsOfVoxel = 0.8;
// Of the share of pixels that have depth in the first images, that later ones need: a thing that is cut out
// covers little of the image, and on its narrow side less.
constexpr double kShareOfFirst = 0.25;
// More than so many times another deviation is another sensor's.
const double kAnotherSensor = std::log2(2.5);

/// By its logarithm.
double nearestStep(double size) {
  return *std::min_element(std::begin(kSteps), std::end(kSteps), [&](double a, double b) {
    return std::abs(std::log(a / size)) < std::abs(std::log(b / size));
  });
}

/// Of a depth in the middle of the scene, as it was measured there: what a surface is off as a whole, which a
/// sensor's model counts too, blurs none of it (tests/bench/notes/sensors.md#voxels-of-small-things). The
/// sensor's where nothing was measured, and of a phone, whose depths are interpolated and look smoother than
/// they are.
double deviationInTheMiddle(const SceneMeasures& scene, const DepthSettings& depth) {
  const auto nearer = [&](const auto& one, const auto& other) {
    return std::abs(one.depth - scene.median_depth) < std::abs(other.depth - scene.median_depth);
  };
  const auto measured = std::min_element(scene.flat.begin(), scene.flat.end(), nearer);
  const bool is_measured = measured != scene.flat.end();
  if (is_measured && !scene.phone) return measured->deviation;
  return std::max(depth.deviationAt(scene.median_depth), is_measured ? measured->deviation : 0);
}

double voxelFor(const SceneMeasures& scene, const DepthSettings& depth) {
  const double across = scene.view_width * scene.median_depth / kVoxelsAcross;
  const double least =
      std::max({scene.view_width * scene.far_depth / kMostAcrossFar,
                kPixelsOfVoxel * scene.pixel_width * scene.median_depth,
                std::min(kDeviationsOfVoxel * deviationInTheMiddle(scene, depth), 2 * kRoomVoxel)});
  return std::max(std::min(nearestStep(across), kRoomVoxel), nearestStep(least));
}

/// The model nearest to what was measured; none where nothing was, or none within that misfit.
const SensorModel* nearestModel(const SceneMeasures& scene, double largest_misfit = kAnotherSensor) {
  if (scene.phone) return sensorModel(DepthSensor::Iphone);
  const SensorModel* nearest = nullptr;
  double least = largest_misfit;
  for (const SensorModel& model : sensorModels()) {
    if (model.sensor == DepthSensor::Iphone || scene.far_depth > model.reach) continue;
    const std::optional<double> off = misfit(model, scene);
    if (!off || *off >= least) continue;
    least = *off;
    nearest = &model;
  }
  return nearest;
}

/// Whether the depth is far noisier than that sensor's: with its noise most pixels would pass for edges and
/// most poses for wrong ones.
bool isNoisierThan(const SensorModel& model, const SceneMeasures& scene) {
  double sum = 0;
  for (const SceneMeasures::Deviation& at : scene.flat)
    sum += std::log2(at.deviation / model.flatDeviation(at.depth));
  return sum > kAnotherSensor * static_cast<double>(scene.flat.size());
}

void take(const SensorModel& model, Settings& settings) {
  settings.depth.sensor = model.sensor;
  settings.depth.noise_floor = model.noise_floor;
  settings.depth.noise_growth = model.noise_growth;
  settings.depth.bias_growth = model.bias_growth;
  settings.refine.model_noise = 2 * model.noise_floor;
}

}  // namespace

bool hasAutomatic(const Settings& settings) {
  return settings.volume.voxel_size == 0 || settings.volume.truncation == 0 ||
         settings.depth.sensor != DepthSensor::Given;
}

std::optional<double> misfit(const SensorModel& model, const SceneMeasures& scene) {
  if (scene.flat.empty()) return {};
  double sum = 0;
  for (const SceneMeasures::Deviation& at : scene.flat)
    sum += std::abs(std::log2(at.deviation / model.flatDeviation(at.depth)));
  return sum / static_cast<double>(scene.flat.size());
}

Settings resolved(Settings settings, const std::optional<SceneMeasures>& scene) {
  if (scene && hasAutomatic(settings))
    settings.tracking.min_valid_share =
        std::min(settings.tracking.min_valid_share, kShareOfFirst * scene->valid_share);
  const bool by_recording = settings.depth.sensor == DepthSensor::Auto && scene;
  if (const SensorModel* named =
          by_recording ? sensorModel(scene->sensor) : sensorModel(settings.depth.sensor)) {
    const bool contradicted = scene && isNoisierThan(*named, *scene);
    const SensorModel* nearest =
        contradicted ? nearestModel(*scene, std::numeric_limits<double>::infinity()) : nullptr;
    take(nearest ? *nearest : *named, settings);
  }
  if (settings.depth.sensor == DepthSensor::Auto && scene)
    if (const SensorModel* nearest = nearestModel(*scene)) take(*nearest, settings);
  const double far_deviation = scene ? settings.depth.deviationAt(scene->far_depth) : 0;
  VolumeSettings& volume = settings.volume;
  if (volume.voxel_size == 0) {
    volume.voxel_size = scene ? voxelFor(*scene, settings.depth) : kRoomVoxel;
    if (volume.truncation > 0) volume.voxel_size = std::min(volume.voxel_size, volume.truncation / 2);
  }
  if (volume.truncation == 0)
    volume.truncation =
        std::max((volume.voxel_size < kRoomVoxel ? kFineTruncation : kTruncation) * volume.voxel_size,
                 std::ceil(100 * kFarDeviations * far_deviation) / 100);
  return settings;
}

std::vector<std::string> choicesOf(const Settings& asked, const Settings& taken,
                                   const std::optional<SceneMeasures>& scene) {
  std::vector<std::string> said;
  if (!scene && hasAutomatic(asked))
    said.push_back(printed(
        "The first images show too little depth to choose by; voxels are %g cm and the depth's noise is %s "
        "(volume.voxel_size, depth.sensor; --start leaves out frames).",
        100 * taken.volume.voxel_size, sensorModel(taken.depth.sensor) ? "as told" : "a Kinect's"));
  if (!scene) return said;
  if (asked.volume.voxel_size == 0)
    said.push_back(printed(
        "Voxels of %g cm, truncated at %g cm: half of the depths are nearer than %.2f m, nine tenths "
        "than %.2f m (volume.voxel_size).",
        100 * taken.volume.voxel_size, 100 * taken.volume.truncation, scene->median_depth, scene->far_depth));
  if (taken.tracking.min_valid_share < asked.tracking.min_valid_share)
    said.push_back(
        printed("Images are taken from %.2g %% of valid pixels on, for the first ones have %.2g %% "
                "(tracking.min_valid_share).",
                100 * taken.tracking.min_valid_share, 100 * scene->valid_share));
  const SensorModel* model = sensorModel(taken.depth.sensor);
  if (asked.depth.sensor == DepthSensor::Auto)
    said.push_back(
        model && model->name == scene->sensor ? printed("The recording is of a sensor %s, and so is taken "
                                                        "the depth's noise (depth.sensor, --sensor).",
                                                        model->name)
        : model ? printed("The depth's noise is like that of a %s (depth.sensor, --sensor).", model->name)
        : scene->flat.empty()
            ? "Too few flat surfaces are in view to measure the depth's noise; it is taken as a Kinect's "
              "(depth.sensor, --sensor)."
            : "The depth's noise is like that of no sensor known; it is taken as a Kinect's (depth.sensor, "
              "--sensor).");
  else if (model && taken.depth.sensor != asked.depth.sensor)
    said.push_back(printed(
        "The depth is far noisier than a %s's, which depth.sensor (--sensor) says it is; it is taken as a "
        "%s's (depth.sensor=given takes depth.noise_floor and depth.noise_growth as they are set).",
        sensorModel(asked.depth.sensor)->name, model->name));
  else if (model && misfit(*model, *scene).value_or(0) > kAnotherSensor)
    said.push_back(
        printed("The depth's noise is unlike a %s's, which depth.sensor (--sensor) says it is; 'auto' "
                "measures it.",
                model->name));
  return said;
}

}  // namespace rosefusion
