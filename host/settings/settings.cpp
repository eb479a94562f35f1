#include "host/settings/settings.h"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <sstream>
#include <utility>

#include "host/core/error.h"
#include "host/core/number_text.h"
#include "host/core/text_file.h"
#include "host/settings/presets.h"

namespace rosefusion {
namespace {

template <class... Ts>
struct Overloaded : Ts... {
  using Ts::operator()...;
};
template <class... Ts>
Overloaded(Ts...) -> Overloaded<Ts...>;

std::size_t editDistance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t substituted = diagonal + (a[i - 1] != b[j - 1]);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, substituted});
    }
  }
  return row[b.size()];
}

const SettingsField& findField(std::string_view key, const std::string& source, const Log& log) {
  const auto& table = settingsTable();
  for (const RenamedSetting& renamed : renamedSettings()) {
    if (renamed.old_key != key) continue;
    if (log)
      log(Severity::Warning, source + ": '" + std::string(key) + "' is called '" + std::string(renamed.key) +
                                 "' now; the old name is still accepted.");
    key = renamed.key;
  }
  const auto found = std::find_if(table.begin(), table.end(), [&](const auto& f) { return f.key == key; });
  if (found != table.end()) return *found;
  const auto nearest = std::min_element(table.begin(), table.end(), [&](const auto& a, const auto& b) {
    return editDistance(a.key, key) < editDistance(b.key, key);
  });
  throw InputError(source + ": there is no setting '" + std::string(key) + "'; did you mean '" +
                   nearest->key + "'?");
}

constexpr const char *kAutomatic = "auto", *kSensor = "depth.sensor";

double numberOf(const std::string& text, const SettingsField& field, const std::string& source, bool whole) {
  if (field.automatic && text == kAutomatic) return 0;
  const double value = parseNumber(text).value_or(std::numeric_limits<double>::quiet_NaN());
  const bool number = std::isfinite(value) && (!whole || value == std::floor(value));
  if (!number || value < field.min || value > field.max) {
    TextStream sentence;
    sentence << source << ": " << field.key << " = '" << text << "' must be a " << (whole ? "whole " : "")
             << "number from " << field.min << " to " << field.max
             << (field.unit.empty() ? "" : " " + field.unit) << (field.automatic ? ", or auto." : ".");
    throw InputError(sentence.str());
  }
  return value;
}

bool boolOf(const std::string& text, const SettingsField& field, const std::string& source) {
  if (text == "true" || text == "1" || text == "on" || text == "yes") return true;
  if (text == "false" || text == "0" || text == "off" || text == "no") return false;
  throw InputError(source + ": " + field.key + " = '" + text + "' must be true or false.");
}

/// "10240/32 3072/16 1024/8"
std::vector<SwarmLevel> levelsOf(const std::string& text, const SettingsField& field,
                                 const std::string& source) {
  std::vector<SwarmLevel> levels;
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    SwarmLevel level;
    char slash = 0;
    std::istringstream parts(word);
    parts.imbue(std::locale::classic());
    if (!(parts >> level.particles >> slash >> level.pixel_stride) || slash != '/' || !parts.eof() ||
        level.particles < 32 || level.particles > 200000 || level.pixel_stride < 1 ||
        level.pixel_stride > 256)
      throw InputError(
          source + ": " + field.key + " has '" + word +
          "', but a level is particles/stride such as 3072/16 (32 to 200000 particles, stride 1 to 256).");
    levels.push_back(level);
  }
  if (levels.empty())
    throw InputError(source + ": " + field.key + " is empty; give levels such as '10240/32 1024/8'.");
  return levels;
}

}  // namespace

double DepthSettings::deviationAt(double depth) const {
  const double beyond = std::max(depth - 0.4, 0.0);
  return noise_floor + noise_growth * beyond * beyond;
}

void setField(Settings& settings, std::string_view key, const std::string& value, const std::string& source,
              const Log& log) {
  const SettingsField& field = findField(key, source, log);
  std::visit(
      Overloaded{
          [&](double* v) { *v = numberOf(value, field, source, false); },
          [&](int* v) { *v = static_cast<int>(numberOf(value, field, source, true)); },
          [&](std::uint64_t* v) { *v = static_cast<std::uint64_t>(numberOf(value, field, source, true)); },
          [&](bool* v) { *v = boolOf(value, field, source); },
          [&](std::vector<SwarmLevel>* v) { *v = levelsOf(value, field, source); },
          [&](const ChoiceRef& c) {
            const auto word = std::find(c.words.begin(), c.words.end(), value);
            if (word == c.words.end()) {
              std::string all;
              for (const auto& w : c.words) all += (all.empty() ? "" : ", ") + w;
              throw InputError(source + ": " + field.key + " = '" + value + "' must be one of " + all + ".");
            }
            c.set(static_cast<int>(word - c.words.begin()));
          }},
      field.ref(settings));
  if (field.key == "depth.readout" && settings.depth.readout != 0) settings.depth.rolling_shutter = true;
  // Who sets the noise by hand means it.
  if (field.key.starts_with("depth.noise_") || field.key == "depth.bias_growth" ||
      field.key == "refine.model_noise")
    settings.depth.sensor = DepthSensor::Given;
}

std::string fieldText(const Settings& settings, const SettingsField& field) {
  TextStream text;
  text.precision(12);
  Settings copy = settings;  // the table's references are to mutable settings
  std::visit(Overloaded{[&](const double* v) {
                          if (field.automatic && *v == 0)
                            text << kAutomatic;
                          else
                            text << *v;
                        },
                        [&](const int* v) { text << *v; }, [&](const std::uint64_t* v) { text << *v; },
                        [&](const bool* v) { text << (*v ? "true" : "false"); },
                        [&](const std::vector<SwarmLevel>* v) {
                          for (const SwarmLevel& level : *v)
                            text << (&level == v->data() ? "" : " ") << level.particles << '/'
                                 << level.pixel_stride;
                        },
                        [&](const ChoiceRef& c) { text << c.words[static_cast<std::size_t>(c.get())]; }},
             field.ref(copy));
  return text.str();
}

std::string fieldText(const Settings& settings, std::string_view key, const std::string& source) {
  return fieldText(settings, findField(key, source, {}));
}

bool isExpertSetting(std::string_view key) {
  static constexpr std::string_view kForUsers[] = {"swarm.max_iterations", "refine.model_noise",
                                                   "refine.front_only", "refine.colour_weight"};
  static constexpr std::string_view kForExperts[] = {
      "tracking.overlap", "tracking.normalise", "tracking.compensate", "tracking.templates_per_level",
      "loops.min_travel", "loops.reach",        "loops.share",         "loops.tolerance"};
  static constexpr std::string_view kExpertGroups[] = {"swarm.", "refine.", "pfo.", "pso.", "icp."};
  if (std::ranges::find(kForUsers, key) != std::end(kForUsers)) return false;
  return std::ranges::find(kForExperts, key) != std::end(kForExperts) ||
         std::ranges::any_of(kExpertGroups, [&](std::string_view group) { return key.starts_with(group); });
}

bool isLiveSetting(std::string_view key) {
  return key == "tracking.min_valid_share" || key == "tracking.uncertain_overlap" ||
         key == "tracking.uncertain_residual" || key == "tracking.uncertain_deviation" ||
         key == "tracking.lost_residual" || key == "tracking.relocalised_share" || key.starts_with("mesh.");
}

void applyAssignment(Settings& settings, const std::string& assignment, const Log& log) {
  const auto equals = assignment.find('=');
  if (equals == std::string::npos)
    throw InputError("--set " + assignment + ": expected key=value, such as --set volume.voxel_size=0.01.");
  setField(settings, assignment.substr(0, equals), assignment.substr(equals + 1), "--set", log);
}

void applyYamlText(Settings& settings, const std::string& text, const std::string& source, const Log& log) {
  try {
    const YAML::Node root = YAML::Load(text);
    if (root.IsNull()) return;
    if (!root.IsMap()) throw InputError(source + ": expected groups of settings such as 'volume:'.");
    std::string sensor;  // names the noise as a whole, wherever it stands
    for (const auto& group : root) {
      const auto name = group.first.as<std::string>();
      if (!group.second.IsMap())
        throw InputError(source + ": '" + name + "' must hold settings, one a line.");
      for (const auto& field : group.second) {
        const std::string key = name + "." + field.first.as<std::string>();
        if (key == kSensor)
          sensor = field.second.as<std::string>();
        else
          setField(settings, key, field.second.as<std::string>(), source, log);
      }
    }
    if (!sensor.empty()) setField(settings, kSensor, sensor, source, log);
  } catch (const YAML::Exception& error) {
    throw InputError(source + ": not readable as YAML (" + error.what() + ").");
  }
}

void applyYamlFile(Settings& settings, const std::filesystem::path& file, const Log& log) {
  std::error_code unknown;
  const bool is_file =
      std::filesystem::exists(file, unknown) && !std::filesystem::is_directory(file, unknown);
  const std::string text = is_file ? readTextFile(file) : "";
  if (text.empty())
    throw InputError(file.string() +
                     ": cannot be read, or is empty; give a YAML file or a preset (default, paper).");
  applyYamlText(settings, text, file.string(), log);
}

std::vector<std::string> presetNames() {
  std::vector<std::string> names;
  for (const Preset& preset : presets()) names.emplace_back(preset.name);
  return names;
}

Settings loadSettings(const std::string& preset_or_file, const Log& log) {
  Settings settings;
  for (const Preset& preset : presets())
    if (preset.name == preset_or_file) {
      applyYamlText(settings, std::string(preset.yaml), "preset " + preset_or_file);
      return settings;
    }
  settings = loadSettings("default");
  applyYamlFile(settings, preset_or_file, log);
  return settings;
}

std::string toYaml(const Settings& settings) {
  TextStream out;
  std::string group;
  bool for_experts = false;
  for (const SettingsField& field : settingsTable()) {
    const std::string name = field.groupName();
    if (name != group) {
      out << (group.empty() ? "" : "\n") << name << ":\n";
      for_experts = false;
    }
    group = name;
    if (isExpertSetting(field.key) && !std::exchange(for_experts, true)) out << "  # For experts:\n";
    out << "  " << field.key.substr(name.size() + 1) << ": " << fieldText(settings, field) << "  # "
        << (field.unit.empty() ? "" : field.unit + "; ") << field.help << '\n';
  }
  return out.str();
}

void requireConsistent(const Settings& settings) {
  if (settings.depth.min >= settings.depth.max) throw InputError("depth.min must be smaller than depth.max.");
  if (settings.volume.truncation > 0 && settings.volume.truncation < 2 * settings.volume.voxel_size)
    throw InputError(
        "volume.truncation must be at least 2 voxels (volume.voxel_size), or no surface can be found in it.");
  requireValid(settings.swarm);
}

void requireImagesFit(const Settings& settings, int width, int height) {
  int stride = std::max(settings.refine.pixel_stride, settings.refine.coarse_pixel_stride);
  for (const SwarmLevel& level : settings.swarm.levels) stride = std::max(stride, level.pixel_stride);
  if (width < stride || height < stride)
    throw InputError(
        printed("The depth images (%dx%d pixels) are smaller than the largest pixel stride of "
                "swarm.levels and refine, %d; give larger images, or smaller strides by --set.",
                width, height, stride));
}

}  // namespace rosefusion
