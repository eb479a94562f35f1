// rosefusion devices: what Vulkan offers here, what each device can do, and whether its sums can be trusted.
#include <cstdio>
#include <nlohmann/json.hpp>

#include "apps/cli/commands.h"
#include "engine/error.h"
#include "engine/passes/sum_check.h"
#include "host/core/error.h"

namespace rosefusion::cli {
namespace {

using Json = nlohmann::ordered_json;

Json toJson(const DeviceInfo& info, bool sums_work) {
  const DeviceLimits& l = info.limits;
  Json json = {{"index", info.index},         {"name", info.name},
               {"type", toString(info.type)}, {"driver", info.driver},
               {"vulkan", info.api_version},  {"usable", info.rejected_because.empty()}};
  if (!info.rejected_because.empty()) json["rejected_because"] = info.rejected_because;
  if (info.rejected_because.empty()) json["compensated_sums_work"] = sums_work;
  json["limits"] = {{"memory_bytes", l.memory_bytes},
                    {"max_storage_buffer_bytes", l.max_storage_buffer_bytes},
                    {"max_storage_buffers", l.max_storage_buffers},
                    {"max_texels", l.max_texels},
                    {"max_workgroup_invocations", l.max_workgroup_invocations},
                    {"max_push_constant_bytes", l.max_push_constant_bytes},
                    {"max_shared_memory_bytes", l.max_shared_memory_bytes},
                    {"subgroup_size", l.subgroup_size}};
  return json;
}

void print(const DeviceInfo& info, bool sums_work) {
  const DeviceLimits& l = info.limits;
  std::printf("[%d] %s (%s)\n", info.index, info.name.c_str(), toString(info.type));
  std::printf("    driver                %s, Vulkan %s\n", info.driver.c_str(), info.api_version.c_str());
  std::printf("    memory                %.1f GiB\n", l.memory_bytes / 1073741824.0);
  std::printf("    storage binding       %llu MiB, %u per stage\n",
              static_cast<unsigned long long>(l.max_storage_buffer_bytes >> 20), l.max_storage_buffers);
  std::printf("    workgroup             %u invocations, %u KiB shared, subgroups of %u\n",
              l.max_workgroup_invocations, l.max_shared_memory_bytes >> 10, l.subgroup_size);
  if (info.rejected_because.empty())
    std::printf("    compensated sums      %s\n",
                sums_work ? "exact" : "BROKEN by this driver's compiler: tracking loses accuracy");
  std::printf("    usable                %s\n",
              info.rejected_because.empty() ? "yes" : ("no: " + info.rejected_because).c_str());
}

bool checkSums(const DeviceInfo& info) {
  if (!info.rejected_because.empty()) return false;
  Device device({std::to_string(info.index), false});
  return compensatedSumsWork(device);
}

void devices(const std::string& json_file) {
  Json list = Json::array();
  bool any = false;
  for (const DeviceInfo& info : listDevices()) {
    const bool sums_work = checkSums(info);
    any = any || info.rejected_because.empty();
    if (json_file != "-") print(info, sums_work);
    list.push_back(toJson(info, sums_work));
  }
  writeJson(json_file, Json{{"devices", list}}.dump(2));
  if (!any)
    throw DeviceError(DeviceErrorCode::NoDevice,
                      "No usable Vulkan device; install your GPU's driver, or mesa-vulkan-drivers, "
                      "which also runs without a GPU.");
}

}  // namespace

void addDevicesCommand(CLI::App& app) {
  auto json = std::make_shared<std::string>();
  CLI::App* command =
      app.add_subcommand("devices", "List Vulkan devices, their limits and the compensated-sum self-test");
  command->add_option("--json", *json, "Also write the list here; '-': standard output");
  command->footer(
      "Example:\n  rosefusion devices\nChoose one with 'rosefusion run --device INDEX|NAME|TYPE' or "
      "$ROSEFUSION_DEVICE.");
  command->callback([json] { devices(*json); });
}

}  // namespace rosefusion::cli
