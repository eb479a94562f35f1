// Every setting of the reconstruction, and the one table behind YAML files, --set key=value and the viewer.
#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "host/core/log.h"
#include "host/settings/sensor_models.h"
#include "host/swarm/swarm_settings.h"

namespace rosefusion {

struct DepthSettings {
  double min = 0.1;
  double max = 8.0;
  double edge_sigmas = 0;
  double noise_floor = 0.005;
  double noise_growth = 0;
  double bias_growth = 0;
  DepthSensor sensor =
      DepthSensor::Given;  ///< where it names one, the three before it are that one's; resolved()
  bool footprint = false;
  bool rolling_shutter = false;
  double readout = 0;  ///< seconds; 0: measured

  /// Standard deviation of a depth, metres, without what a surface's share.
  double deviationAt(double depth) const;
};

/// 0: chosen by what the camera sees; resolved() in automatic.h.
struct VolumeSettings {
  double voxel_size = 0.02;
  double truncation = 0.06;
  double max_weight = 128;
  bool colour = true;
  bool thin_walls = false;
  std::uint64_t memory_limit_mb = 0;
};

/// Which pixels a particle counts: all valid ones, those in the overlap of the current best pose with the
/// last frame (the paper), or those in the overlap of the particle's own pose (the authors' release).
enum class Overlap { None, BestPose, EachParticle };

/// How a frame's pose is found; all but the first start from the last frame's.
enum class TrackingMethod {
  Default,      ///< this program's: motion model, swarm and descent compete, lost cameras are searched for
  Pst,          ///< the paper: the swarm template alone
  Pfo,          ///< particle filter optimisation
  Pso,          ///< particle swarm optimisation
  GaussNewton,  ///< the descent alone (Bylow et al. 2013)
  Icp,          ///< point-to-plane against the raycast model (KinectFusion)
};

struct TrackingSettings {
  TrackingMethod method = TrackingMethod::Pst;
  Overlap overlap = Overlap::BestPose;
  bool normalise = true;
  bool compensate = true;
  double race_margin = 0;
  std::uint64_t seed = 1;
  int templates_per_level = 20;
  double min_valid_share = 0.02;
  double uncertain_overlap = 0.3;
  double uncertain_residual = 0.35;
  double uncertain_deviation = 0.005;
  double lost_residual = 0.6;
  double relocalised_share = 0.5;
  double intruding_share = 1;
};

/// The descent onto the model's surface. What goes beyond the paper, with method default: starts from a
/// motion model, and the descent around the swarm.
struct RefineSettings {
  int coarse_iterations = 10;
  int iterations = 15;
  int pixel_stride = 4;
  double huber = 0.02;
  double model_noise = 0;
  bool front_only = false;
  int coarse_pixel_stride = 8;
  double least_constraint = 0.001;
  double motion_preference = 0.05;
  double minimum_move = 5e-5;
  double colour_weight = 0;
};

/// Iterative closest points, of method icp.
struct IcpSettings {
  double distance = 0.1;
  double angle = 0.35;
  double minimum_move = 1e-5;
};

/// Loop closure: the memory of places, and what is believed about coming back to one.
struct LoopSettings {
  bool enabled = false;
  double keyframe_shift = 0.15;
  double keyframe_turn = 0.15;
  std::uint64_t memory_mb = 512;
  double min_travel = 5;
  double reach = 1;
  double share = 0.6;
  double tolerance = 0.02;
};

struct MeshSettings {
  double min_weight = 2;
  int min_component = 100;
};

struct Settings {
  DepthSettings depth;
  VolumeSettings volume;
  SwarmSettings swarm;
  TrackingSettings tracking;
  RefineSettings refine;
  PfoSettings pfo;
  PsoSettings pso;
  IcpSettings icp;
  LoopSettings loops;
  MeshSettings mesh;
};

/// A setting whose value is one of a few words.
struct ChoiceRef {
  std::vector<std::string> words;
  std::function<int()> get;
  std::function<void(int)> set;
};
using FieldRef = std::variant<double*, int*, bool*, std::uint64_t*, std::vector<SwarmLevel>*, ChoiceRef>;

/// One row of the table.
struct SettingsField {
  std::string key;   ///< "group.name", as in YAML and --set
  std::string unit;  ///< empty for pure numbers
  std::string help;
  double min = 0;  ///< allowed range of numbers, inclusive
  double max = 0;
  std::function<FieldRef(Settings&)> ref;
  bool automatic = false;  ///< a number that may be 'auto', which is kept as 0

  std::string groupName() const { return key.substr(0, key.find('.')); }
};

/// The table, in the order in which files show it: by groups, a user's settings before those for experts.
const std::vector<SettingsField>& settingsTable();

/// A key that was called otherwise in earlier versions: files and programs with the old one go on to work.
struct RenamedSetting {
  std::string_view old_key, key;
};
std::span<const RenamedSetting> renamedSettings();

/// Sets one field from text. Throws InputError naming the key (with the nearest known key for an unknown
/// one), what is allowed, and `source`, the file or option it came from. `log` hears of a key's old name.
void setField(Settings& settings, std::string_view key, const std::string& value, const std::string& source,
              const Log& log = {});
/// Whether only those who work on the method itself meet the setting: constants of the paper's search, of
/// what it is compared with, and of the refinement. The others are a user's.
bool isExpertSetting(std::string_view key);
/// Whether a running pipeline can take the setting over; the others take effect when it is made.
bool isLiveSetting(std::string_view key);
std::string fieldText(const Settings& settings, const SettingsField& field);
/// The same by its key. Throws InputError as setField().
std::string fieldText(const Settings& settings, std::string_view key, const std::string& source);

/// Applies "key=value". Throws InputError. `log`, here and below, as of setField().
void applyAssignment(Settings& settings, const std::string& assignment, const Log& log = {});
/// Applies the YAML file's fields over what is there. Throws InputError for unreadable files and unknown
/// keys.
void applyYamlFile(Settings& settings, const std::filesystem::path& file, const Log& log = {});
void applyYamlText(Settings& settings, const std::string& text, const std::string& source,
                   const Log& log = {});
/// A preset's name ("default", "paper"), or a YAML file over the preset "default". Throws InputError.
Settings loadSettings(const std::string& preset_or_file, const Log& log = {});
std::vector<std::string> presetNames();

/// All fields with their units and help as comments; applyYamlText reads it back to equal settings.
std::string toYaml(const Settings& settings);

/// Combinations that no single field's range catches. Throws InputError naming the settings.
void requireConsistent(const Settings& settings);

/// Throws InputError for images, in pixels, that are too small for what the settings look at in them.
void requireImagesFit(const Settings& settings, int width, int height);

}  // namespace rosefusion
