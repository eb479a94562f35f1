// rosefusion doctor: what a report about this program needs to say of the machine, in one text.
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "apps/cli/commands.h"
#include "engine/error.h"
#include "engine/passes/sum_check.h"
#include "host/core/error.h"
#include "host/core/file_io.h"
#include "host/core/log_to_spdlog.h"
#include "host/core/number_text.h"
#include "host/core/system.h"
#include "host/run/report.h"
#include "host/sources/camera.h"
#include "host/sources/stream.h"
#include "host/synth/sequence.h"

namespace rosefusion::cli {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double kTrialSeconds = 3;
constexpr double kGoodEnough_m =
    0.02;  // of a generated room's first second, which every device has under 5 mm

/// A heading, and what it says line by line.
struct Section {
  std::string name;
  std::vector<std::pair<std::string, std::string>> lines;
};

struct Diagnosis {
  std::vector<Section> sections;
  std::vector<std::string> problems;
};

std::string firstLineWith(const char* file, const std::string& key) {
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);)
    if (line.starts_with(key)) {
      const std::size_t at = line.find_first_not_of(" \t\":=", key.size());
      std::string value = at == line.npos ? "" : line.substr(at);
      while (!value.empty() && (value.back() == '"' || value.back() == ' ')) value.pop_back();
      return value;
    }
  return "not told";
}

/// Without what a name in a path would tell of a person.
std::string environment(const char* name) {
  const char* value = std::getenv(name);
  if (!value) return "not set";
  std::string text = value;
  if (const char* home = std::getenv("HOME"); home && *home && text.starts_with(home))
    text.replace(0, std::string(home).size(), "~");
  return text;
}

Section machine() {
  Section out{"Machine", {}};
  out.lines = {{"rosefusion", ROSEFUSION_VERSION},
               {"built with", std::string(__VERSION__)},
               {"system", firstLineWith("/etc/os-release", "PRETTY_NAME") + ", " + kernelName()},
               {"processor",
                processorName() + ", " + std::to_string(std::thread::hardware_concurrency()) + " threads"},
               {"memory", firstLineWith("/proc/meminfo", "MemTotal") + ", free " +
                              firstLineWith("/proc/meminfo", "MemAvailable")}};
  std::string cameras;
  for (const CameraKind& kind : cameraKinds()) cameras += std::string(kind.open ? " " : " no ") + kind.name;
  out.lines.emplace_back("parts", std::string(streamsAvailable() ? "network streams" : "no network streams") +
                                      "; cameras:" + cameras);
  for (const char* name : {"LANG", "LC_ALL", "ROSEFUSION_DEVICE", "VK_ICD_FILENAMES", "VK_DRIVER_FILES",
                           "VK_LOADER_LAYERS_ENABLE", "XDG_CACHE_HOME", "TMPDIR"})
    if (std::getenv(name)) out.lines.emplace_back(name, environment(name));
  return out;
}

Section folders(Diagnosis& diagnosis) {
  Section out{"Folders", {}};
  std::error_code error;
  const std::filesystem::path here = std::filesystem::current_path(error);
  const std::filesystem::path temporary = std::filesystem::temp_directory_path(error);
  for (const auto& [name, folder] :
       {std::pair{"working folder", here}, std::pair{"temporary files", temporary}}) {
    const auto space = std::filesystem::space(folder, error);
    std::string says = error ? "cannot be asked (" + error.message() + ")"
                             : printed("%.1f GiB free", static_cast<double>(space.available) / 1073741824.0);
    try {
      requireWritable(folder / "rosefusion-doctor");
    } catch (const InputError& problem) {
      says += ", not writable";
      diagnosis.problems.emplace_back(problem.what());
    }
    out.lines.emplace_back(name, says);
  }
  return out;
}

Section describe(const DeviceInfo& info) {
  const DeviceLimits& l = info.limits;
  return {
      printed("Device %d", info.index),
      {{"name", info.name + " (" + toString(info.type) + ")"},
       {"driver", info.driver + ", Vulkan " + info.api_version},
       {"memory",
        printed("%.2f GiB, at most %.2f GiB at once", static_cast<double>(l.memory_bytes) / 1073741824.0,
                static_cast<double>(l.max_allocation_bytes) / 1073741824.0)},
       {"storage", printed("%llu MiB a binding, %u a stage, %u texels",
                           static_cast<unsigned long long>(l.max_storage_buffer_bytes >> 20),
                           l.max_storage_buffers, l.max_texels)},
       {"workgroup", printed("%u invocations, %u groups, %u KiB shared, %u B of constants, subgroups of %u",
                             l.max_workgroup_invocations, l.max_workgroup_count_x,
                             l.max_shared_memory_bytes >> 10, l.max_push_constant_bytes, l.subgroup_size)},
       {"usable", info.rejected_because.empty() ? "yes" : "no: " + info.rejected_because}}};
}

/// Tracks a generated flight for some seconds and compares it with its truth.
Section trial(Device& device, Diagnosis& diagnosis) {
  SynthOptions options;
  options.seed = 1;
  options.frames = 30;
  options.intrinsics = {320, 240, 160, 160, 159.5, 119.5};
  const SynthSequence sequence = makeSequence(options);
  Pipeline pipeline(device, loadSettings("default"), sequence.intrinsics, sequence.depth_units_per_metre,
                    logToSpdlog);
  const Pose start = sequence.truth[0].world_from_camera;
  const Clock::time_point begin = Clock::now();
  double seconds = 0, worst = 0;
  std::size_t frames = 0, lost = 0;
  while (frames < sequence.frames.size() && (seconds < kTrialSeconds || frames < 3)) {
    const FrameResult result = pipeline.processFrame(sequence.frames[frames]);
    const Pose truth = start.inverse() * sequence.truth[frames].world_from_camera;
    ++frames;
    if (result.status == TrackingStatus::Lost)
      ++lost;
    else
      worst = std::max(worst, (truth.translation() - result.world_from_camera.translation()).norm());
    seconds = std::chrono::duration<double>(Clock::now() - begin).count();
  }
  if (lost > 0 || worst > kGoodEnough_m)
    diagnosis.problems.push_back(
        printed("The trial run lost %zu of %zu frames and is up to %.1f cm off; it should lose "
                "none and stay within 2 cm: do not trust this device's results.",
                lost, frames, 100 * worst));
  return {"Trial run",
          {{"device", device.info().name},
           {"frames", printed("%zu of 320x240 in %.1f s, %.1f a second", frames, seconds,
                              static_cast<double>(frames) / seconds)},
           {"lost", std::to_string(lost)},
           {"furthest off", printed("%.2f cm", 100 * worst)},
           {"device memory", printed("%.0f MiB", static_cast<double>(device.allocatedBytes()) / 1048576.0)}}};
}

void examineDevices(const std::string& select, Diagnosis& diagnosis) {
  try {
    for (const DeviceInfo& info : listDevices()) {
      Section section = describe(info);
      if (info.rejected_because.empty()) {
        Device device({std::to_string(info.index), false});
        const bool exact = compensatedSumsWork(device);
        section.lines.emplace_back("compensated sums", exact ? "exact" : "BROKEN by this driver's compiler");
        if (!exact) diagnosis.problems.push_back(info.name + ": sums lose accuracy; update its driver.");
      }
      diagnosis.sections.push_back(std::move(section));
    }
    Device device({select, false});
    diagnosis.sections.push_back(trial(device, diagnosis));
  } catch (const DeviceError& error) {
    diagnosis.problems.emplace_back(error.what());
  }
}

std::string textOf(const Diagnosis& diagnosis) {
  std::string text;
  for (const Section& section : diagnosis.sections) {
    text += section.name + "\n";
    for (const auto& [name, value] : section.lines)
      text += printed("  %-18s %s\n", name.c_str(), value.c_str());
  }
  text += diagnosis.problems.empty() ? "Nothing is wrong here.\n" : "Problems\n";
  for (const std::string& problem : diagnosis.problems) text += "  " + problem + "\n";
  return text;
}

void examine(const std::string& select, const std::string& json) {
  requireWritableJson(json);
  Diagnosis diagnosis;
  diagnosis.sections.push_back(machine());
  diagnosis.sections.push_back(folders(diagnosis));
  examineDevices(select, diagnosis);
  std::fputs(textOf(diagnosis).c_str(), json == "-" ? stderr : stdout);
  nlohmann::ordered_json out;
  for (const Section& section : diagnosis.sections)
    for (const auto& [name, value] : section.lines) out[section.name][name] = value;
  out["problems"] = diagnosis.problems;
  writeJson(json, out.dump(2));
  if (!diagnosis.problems.empty()) throw DeviceError(DeviceErrorCode::NoDevice, diagnosis.problems.front());
}

}  // namespace

void addDoctorCommand(CLI::App& app) {
  auto device = std::make_shared<std::string>(), json = std::make_shared<std::string>();
  CLI::App* command = app.add_subcommand(
      "doctor", "Examine machine, devices and a run of 3 seconds; one text to paste into a report");
  command->add_option("--device", *device,
                      "Device of the run, by index, name or type (see 'rosefusion devices')");
  command->add_option("--json", *json, "Also write it here; '-': standard output");
  command->footer(
      "Example:\n  rosefusion doctor > doctor.txt\n"
      "Exit codes: 0 nothing is wrong, 3 something is (the text says what).");
  command->callback([device, json] { examine(*device, *json); });
}

}  // namespace rosefusion::cli
