// The table of all settings: key, unit, help, range, and where the value lives.
#include <algorithm>

#include "host/settings/settings.h"

namespace rosefusion {
namespace {

template <typename Get>
SettingsField row(std::string key, std::string unit, double min, double max, std::string help, Get get) {
  return {std::move(key),
          std::move(unit),
          std::move(help),
          min,
          max,
          [get](Settings& s) { return FieldRef(&get(s)); }};
}

SettingsField orAutomatic(SettingsField field) {
  field.automatic = true;
  return field;
}

template <typename Enum, typename Get>
SettingsField choice(std::string key, std::vector<std::string> words, std::string help, Get get) {
  return {std::move(key), "", std::move(help), 0, 0, [words, get](Settings& s) {
            Enum& value = get(s);
            return FieldRef(ChoiceRef{words, [&value] { return static_cast<int>(value); },
                                      [&value](int i) { value = static_cast<Enum>(i); }});
          }};
}

std::vector<std::string> sensorWords() {
  std::vector<std::string> words{"given", "auto"};
  for (const SensorModel& model : sensorModels()) words.emplace_back(model.name);
  return words;
}

std::vector<SettingsField> makeTable() {
  constexpr double kMany = 1e9;
  const auto S = [](auto member) {
    return [member](Settings & s) -> auto& {
      return s.swarm.*member;
    };
  };
  const auto T = [](auto member) {
    return [member](Settings & s) -> auto& {
      return s.tracking.*member;
    };
  };
  const auto R = [](auto member) {
    return [member](Settings & s) -> auto& {
      return s.refine.*member;
    };
  };
  const auto L = [](auto member) {
    return [member](Settings & s) -> auto& {
      return s.loops.*member;
    };
  };
  using W = SwarmSettings;
  return {
      row(
          "depth.min", "m", 0.01, 10, "nearer depths are invalid",
          [](Settings & s) -> auto& { return s.depth.min; }),
      row(
          "depth.max", "m", 0.1, 60, "farther depths are invalid",
          [](Settings & s) -> auto& { return s.depth.max; }),
      row(
          "depth.edge_sigmas", "", 0, 1000,
          "pixels that leave their neighbours' plane by more standard deviations are invalid; 0: edges are "
          "kept",
          [](Settings & s) -> auto& { return s.depth.edge_sigmas; }),
      row(
          "depth.noise_floor", "m", 1e-5, 1, "standard deviation of a depth close to the camera",
          [](Settings & s) -> auto& { return s.depth.noise_floor; }),
      row(
          "depth.noise_growth", "1/m", 0, 1,
          "its growth with (depth - 0.4 m)^2; 0, and no bias_growth: all depths weigh the same, as in the "
          "paper",
          [](Settings & s) -> auto& { return s.depth.noise_growth; }),
      row(
          "depth.bias_growth", "1/m", 0, 1,
          "growth with depth^2 of what the depths of a surface are off together, as by calibration, which "
          "no average takes out; 0: none",
          [](Settings & s) -> auto& { return s.depth.bias_growth; }),
      choice<DepthSensor>(
          "depth.sensor", sensorWords(),
          "whose noise the depths have: that of a camera, or of one like the first images if those are far "
          "noisier; auto, of the one that the recording names, else that the first images look like; given, "
          "as "
          "noise_floor, noise_growth, bias_growth and refine.model_noise say",
          [](Settings & s) -> auto& { return s.depth.sensor; }),
      row(
          "depth.footprint", "", 0, 1,
          "where depths lie on a plane, a pixel's is that of all that a voxel there covers, which fills the "
          "sensor's holes; off, as in the paper: each pixel stands for itself",
          [](Settings & s) -> auto& { return s.depth.footprint; }),
      row(
          "depth.rolling_shutter", "", 0, 1,
          "rows that were exposed one after the other are put where they would have been seen at once",
          [](Settings & s) -> auto& { return s.depth.rolling_shutter; }),
      orAutomatic(row(
          "depth.readout", "s", -0.2, 0.2,
          "from the exposure of an image's first row to that of the last, negative from the bottom up; auto: "
          "measured by how the rows fit the model while the camera moves",
          [](Settings & s) -> auto& { return s.depth.readout; })),

      orAutomatic(row(
          "volume.voxel_size", "m", 0.001, 0.5,
          "edge of a voxel; auto: 0.02 for rooms, less where the first images show something small",
          [](Settings & s) -> auto& { return s.volume.voxel_size; })),
      orAutomatic(row(
          "volume.truncation", "m", 0.002, 2,
          "distances are truncated to +- this; at least 2 voxels; auto: 3 or, of small ones, 4",
          [](Settings & s) -> auto& { return s.volume.truncation; })),
      row(
          "volume.max_weight", "frames", 1, 255,
          "cap of the running mean: higher is smoother, lower adapts faster",
          [](Settings & s) -> auto& { return s.volume.max_weight; }),
      row(
          "volume.colour", "", 0, 1, "fuse colour where the sequence has it",
          [](Settings & s) -> auto& { return s.volume.colour; }),
      row(
          "volume.thin_walls", "", 0, 1,
          "what a view says of the space behind its surface gives way to a view of a surface there",
          [](Settings & s) -> auto& { return s.volume.thin_walls; }),
      row(
          "volume.memory_limit_mb", "MiB", 0, kMany, "largest volume; 0: 80 % of the device's memory",
          [](Settings & s) -> auto& { return s.volume.memory_limit_mb; }),

      choice<FitnessLoss>("swarm.loss", {"squared", "absolute"}, "per point: psi^2 [eq. normallh] or |psi|",
                          S(&W::loss)),
      row("swarm.tau", "", 1e-6, 1e6, "temperature of the fitness [eq. pfolh]", S(&W::tau)),
      row("swarm.levels", "", 0, 0, "particles/pixel stride, used in turn [Multi-resolution PST]",
          S(&W::levels)),
      row("swarm.restart_levels_when_empty", "", 0, 1, "an empty advantage set leads back to the first level",
          S(&W::restart_levels_when_empty)),
      row("swarm.pixel_shift", "px", 0, 1000, "the pixel grid moves by this each iteration",
          S(&W::pixel_shift)),
      row("swarm.max_iterations", "", 1, 1000, "iterations per frame [Convergence criteria]",
          S(&W::max_iterations)),
      row("swarm.max_empty_sets", "", 1, 1000, "empty advantage sets in a row that end the search",
          S(&W::max_empty_sets)),
      row("swarm.minimum_move", "", 0, 1, "a move below this in all six dimensions ends the search",
          S(&W::minimum_move)),
      row("swarm.max_advantage_particles", "", 0, kMany, "advantage particles averaged; 0: all",
          S(&W::max_advantage_particles)),
      row("swarm.minimum_counted_share", "", 0, 1, "a particle needs this share of particle 0's pixels",
          S(&W::minimum_counted_share)),
      row("swarm.axis_scale", "", 1e-6, 1e3, "factor of (1 - rho) v/|v| [eq. rsinter]", S(&W::axis_scale)),
      choice<Rescaling>("swarm.rescaling", {"both", "anisotropic", "isotropic"},
                        "parts of [eq. rsinter] in use: the direction of the last move, 1 - rho",
                        S(&W::rescaling)),
      row("swarm.axis_epsilon", "", 0, 1, "least axis length [eq. rsinter]", S(&W::axis_epsilon)),
      row("swarm.axis_momentum", "", 0, 1, "share of the previous lengths [eq. momentum]",
          S(&W::axis_momentum)),
      row("swarm.empty_set_scale", "", 0, 1e3, "factor of the sphere after an empty set [PST update]",
          S(&W::empty_set_scale)),
      row("swarm.initial_likelihood", "", 0, 1, "likelihood before anything is built [PST update]",
          S(&W::initial_likelihood)),
      row("swarm.first_axis_scale", "", 1e-6, 1e3, "factor of the very first sphere",
          S(&W::first_axis_scale)),
      choice<FrameStart>("swarm.frame_start", {"previous-first-lengths", "failure-loss"},
                         "axis lengths a frame starts with [PST initialization]", S(&W::frame_start)),

      choice<TrackingMethod>(
          "tracking.method", {"default", "pst", "pfo", "pso", "gauss-newton", "icp"},
          "how a pose is found: default, motion model, swarm and descent; pst, the paper's swarm alone; "
          "others for comparison",
          T(&TrackingSettings::method)),
      choice<Overlap>("tracking.overlap", {"none", "best-pose", "particle"},
                      "pixels counted: all, or in the overlap with the last frame [eq. validness] at the "
                      "best pose or at the "
                      "particle's own",
                      T(&TrackingSettings::overlap)),
      row("tracking.normalise", "", 0, 1,
          "losses are means over a particle's counted pixels [eq. normallh]; off: sums over them, as shares "
          "of "
          "the pixels looked at [eq. ourlh]",
          T(&TrackingSettings::normalise)),
      row("tracking.compensate", "", 0, 1, "Kahan-compensated sums [GPU implementation]",
          T(&TrackingSettings::compensate)),
      row("tracking.race_margin", "", 0, 100,
          "a particle of the search is given up as soon as its mean loss over n pixels exceeds the "
          "centre's by more than this / sqrt(n); 0: never; raced on devices that walk a particle's pixels in "
          "one "
          "piece, as CPUs do",
          T(&TrackingSettings::race_margin)),
      row("tracking.seed", "", 0, 1e15, "seed of the swarm templates", T(&TrackingSettings::seed)),
      row("tracking.templates_per_level", "", 1, 1000, "templates of each size, used in turn",
          T(&TrackingSettings::templates_per_level)),
      row("tracking.min_valid_share", "", 0, 1, "a frame with fewer valid pixels is lost",
          T(&TrackingSettings::min_valid_share)),
      row("tracking.uncertain_overlap", "", 0, 1, "less overlap with the last frame makes a pose uncertain",
          T(&TrackingSettings::uncertain_overlap)),
      row("tracking.uncertain_residual", "truncations", 0, 1, "a larger RMS residual makes a pose uncertain",
          T(&TrackingSettings::uncertain_residual)),
      row("tracking.uncertain_deviation", "m", 0, 1,
          "a direction that the depth holds weakly makes a pose uncertain if its standard deviation is "
          "larger",
          T(&TrackingSettings::uncertain_deviation)),
      row("tracking.lost_residual", "truncations", 0, 1,
          "a larger RMS residual means lost: the frame is not fused", T(&TrackingSettings::lost_residual)),
      row("tracking.relocalised_share", "", 0, 1,
          "once lost, a pose is believed when this share of the pixels meets the model; three fifths where "
          "nothing contradicts it",
          T(&TrackingSettings::relocalised_share)),
      row("tracking.intruding_share", "", 0, 1,
          "a frame is not fused where more of its pixels than this lie in space that the last fused frame "
          "saw to "
          "be empty; 1: never asked",
          T(&TrackingSettings::intruding_share)),

      row("refine.coarse_iterations", "", 1, 1000, "most steps of a start's descent",
          R(&RefineSettings::coarse_iterations)),
      row("refine.iterations", "", 1, 1000, "most steps of the last descent", R(&RefineSettings::iterations)),
      row("refine.pixel_stride", "px", 1, 64, "every so many pixels are looked at",
          R(&RefineSettings::pixel_stride)),
      row("refine.huber", "m", 1e-4, 1, "larger residuals count linearly", R(&RefineSettings::huber)),
      row("refine.model_noise", "m", 0, 1,
          "standard deviation of the surface in a voxel of weight 1 (one near depth), / sqrt(weight)",
          R(&RefineSettings::model_noise)),
      row("refine.front_only", "", 0, 1,
          "leave out points where the model shows the back of a surface, as a thin wall's other side",
          R(&RefineSettings::front_only)),
      row("refine.coarse_pixel_stride", "px", 1, 64, "the same while starts are compared",
          R(&RefineSettings::coarse_pixel_stride)),
      row("refine.least_constraint", "", 0, 1,
          "the motion model holds directions that the depth constrains less (1: as a plane does its normal)",
          R(&RefineSettings::least_constraint)),
      row("refine.motion_preference", "", 0, 1,
          "share of the points by which an unexpected motion must explain the frame better",
          R(&RefineSettings::motion_preference)),
      row("refine.minimum_move", "m, rad", 0, 1, "a smaller step ends the descent",
          R(&RefineSettings::minimum_move)),
      row("refine.colour_weight", "", 0, 1000,
          "what colour weighs beside depth where depth holds a direction weakly and the sequence has colour; "
          "0: "
          "never asked",
          R(&RefineSettings::colour_weight)),

      row(
          "pfo.shift_deviation", "m", 0, 1, "of the proposal [eq. proposal]; the pfo group is of method pfo",
          [](Settings & s) -> auto& { return s.pfo.shift_deviation; }),
      row(
          "pfo.turn_deviation", "", 0, 1, "the same of the quaternion's imaginary part",
          [](Settings & s) -> auto& { return s.pfo.turn_deviation; }),
      row(
          "pfo.temperature", "", 1e-6, 1e6, "particles are resampled by exp(-loss / this) [eq. pfolh]",
          [](Settings & s) -> auto& { return s.pfo.temperature; }),
      row(
          "pso.inertia", "", 0, 1,
          "share of a particle's velocity that it keeps; the pso group is of method pso",
          [](Settings & s) -> auto& { return s.pso.inertia; }),
      row(
          "pso.own_pull", "", 0, 10, "towards the best place that the particle has seen",
          [](Settings & s) -> auto& { return s.pso.own_pull; }),
      row(
          "pso.swarm_pull", "", 0, 10, "towards the best place of all",
          [](Settings & s) -> auto& { return s.pso.swarm_pull; }),
      row(
          "icp.distance", "m", 1e-3, 10, "farther points are no pairs; the icp group is of method icp",
          [](Settings & s) -> auto& { return s.icp.distance; }),
      row(
          "icp.angle", "rad", 0, 3.2, "nor are points whose normals differ by more",
          [](Settings & s) -> auto& { return s.icp.angle; }),
      row(
          "icp.minimum_move", "m, rad", 0, 1, "a smaller step ends a level's iterations",
          [](Settings & s) -> auto& { return s.icp.minimum_move; }),

      row("loops.enabled", "", 0, 1,
          "places that the camera comes back to are recognised, and drift is taken out of all poses and of "
          "the "
          "model",
          L(&LoopSettings::enabled)),
      row("loops.keyframe_shift", "m", 0.01, 10, "after so much a frame is kept as keyframe",
          L(&LoopSettings::keyframe_shift)),
      row("loops.keyframe_turn", "rad", 0.01, 3, "or after so much", L(&LoopSettings::keyframe_turn)),
      row("loops.memory_mb", "MiB", 1, kMany,
          "of compressed keyframe images; beyond it they are thinned, and the model is made from the others",
          L(&LoopSettings::memory_mb)),
      row("loops.min_travel", "m + rad", 0.1, 1e6, "younger keyframes are not looked at",
          L(&LoopSettings::min_travel)),
      row("loops.reach", "m", 0.05, 100,
          "nor are those further away that do not see the same; a small model is made of keyframes within "
          "this",
          L(&LoopSettings::reach)),
      row("loops.share", "", 0.1, 1, "a place is recognised when this share of the pixels meets what it was",
          L(&LoopSettings::share)),
      row("loops.tolerance", "m, rad", 1e-3, 10, "smaller drift is left alone", L(&LoopSettings::tolerance)),

      row(
          "mesh.min_weight", "frames", 0, 255,
          "voxels seen less are left out of the mesh; a frame weighs less from afar",
          [](Settings & s) -> auto& { return s.mesh.min_weight; }),
      row(
          "mesh.min_component", "triangles", 0, kMany,
          "smaller connected parts of the mesh are dropped as noise",
          [](Settings & s) -> auto& { return s.mesh.min_component; }),
  };
}

}  // namespace

std::span<const RenamedSetting> renamedSettings() {
  static constexpr RenamedSetting kRenamed[] = {{"tracker.method", "tracking.method"}};
  return kRenamed;
}

const std::vector<SettingsField>& settingsTable() {
  static const std::vector<SettingsField> table = [] {
    std::vector<SettingsField> made = makeTable();
    for (auto first = made.begin(); first != made.end();) {
      const auto past = std::find_if(
          first, made.end(), [&](const SettingsField& f) { return f.groupName() != first->groupName(); });
      std::stable_partition(first, past, [](const SettingsField& f) { return !isExpertSetting(f.key); });
      first = past;
    }
    return made;
  }();
  return table;
}

}  // namespace rosefusion
