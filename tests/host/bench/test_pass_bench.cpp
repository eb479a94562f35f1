// A bench run as short as possible: its report has what readers of the JSON rely on.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "host/bench/pass_agreement.h"
#include "host/bench/pass_bench.h"

namespace rosefusion::testing {
namespace test_pass_bench {

TEST(PassBench, ReportHasTheRequiredFigures) {
  const auto cache = std::filesystem::temp_directory_path() / "rosefusion_test_bench";
  setenv("XDG_CACHE_HOME", cache.c_str(), 1);
  BenchOptions options;
  options.frames = 4;
  options.repeat = 1;
  options.settings.volume.voxel_size = 0.04;
  options.settings.volume.truncation = 0.12;
  options.settings.volume.colour = false;
  options.settings.volume.thin_walls = true;
  options.settings.depth.edge_sigmas = 4;
  options.settings.depth.footprint = true;
  options.settings.refine.model_noise = 0.01;
  options.settings.refine.front_only = true;
  options.settings.tracking.templates_per_level = 1;
  options.settings.swarm.levels = {{256, 32}, {128, 16}};
  Device device;
  const BenchReport report = benchPasses(device, options);
  std::filesystem::remove_all(cache);

  const nlohmann::ordered_json json = benchJson(report);
  for (const char* key :
       {"/fitness/ns_per_lookup", "/fitness/native_ns_per_lookup", "/fitness/ratio", "/preprocess/ms",
        "/allocate/ms", "/integrate/ms", "/refine/ms", "/raycast/ms", "/extract/ms", "/preprocess/ratio",
        "/integrate/ratio", "/refine/ratio", "/raycast/ratio", "/refine/native_ms"})
    EXPECT_GT(json.at(nlohmann::ordered_json::json_pointer(key)).get<double>(), 0) << key;
  for (const char* pass : {"preprocess", "integrate", "refine", "raycast"}) {
    EXPECT_LT(json.at(pass).at("differing_share").get<double>(), 0.01) << pass;
    EXPECT_NE(benchTable(report).find(pass), std::string::npos);
  }
  EXPECT_TRUE(json.at("fitness").at("kahan_cost_percent").is_number());
  EXPECT_EQ(json.at("device").at("name"), device.info().name);
  EXPECT_GT(report.triangles, 1000u);
  // 640 x 480 at strides 32 and 16, nearly every pixel valid.
  EXPECT_LE(report.fitness.lookups, 300u * 256 + 1200u * 128);
  EXPECT_GE(report.fitness.lookups, (300u * 256 + 1200u * 128) / 2);
  EXPECT_NE(benchTable(report).find(device.info().name), std::string::npos);
  EXPECT_TRUE(device.validationMessages().empty());
}

TEST(PassBench, LossesThatDisagreeAreAnError) {
  const std::vector<float> native(100, 0.25f);
  std::vector<float> device = native;
  EXPECT_EQ(requireAgreement("GPU", device, native, 1000), 0);
  device[40] += 0.9f * static_cast<float>(lossTolerance(1000));
  EXPECT_NEAR(requireAgreement("GPU", device, native, 1000), 0.9 * lossTolerance(1000), 1e-6);
  device[40] += 0.2f * static_cast<float>(lossTolerance(1000));
  EXPECT_THROW(requireAgreement("GPU", device, native, 1000), std::runtime_error);
  device = native;
  for (float& loss : device) loss += 2 * static_cast<float>(kMeanLossTolerance);
  EXPECT_THROW(requireAgreement("GPU", device, native, 1000), std::runtime_error);
  device = native;
  device[3] = std::nanf("");
  EXPECT_THROW(requireAgreement("GPU", device, native, 1000), std::runtime_error);
}

}  // namespace test_pass_bench
}  // namespace rosefusion::testing
