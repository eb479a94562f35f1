// The structs shared by GLSL and C++: SPIR-V offsets and sizes against offsetof and sizeof.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <map>

#include "engine/caller_device.h"
#include "engine/reflection.h"
#include "shaders/compute/interface/allocate.h"
#include "shaders/compute/interface/extract_count.h"
#include "shaders/compute/interface/extract_emit.h"
#include "shaders/compute/interface/farthest.h"
#include "shaders/compute/interface/fitness.h"
#include "shaders/compute/interface/fitness_reduce.h"
#include "shaders/compute/interface/footprint.h"
#include "shaders/compute/interface/icp.h"
#include "shaders/compute/interface/integrate.h"
#include "shaders/compute/interface/preprocess.h"
#include "shaders/compute/interface/raycast.h"
#include "shaders/compute/interface/raycast_range.h"
#include "shaders/compute/interface/refine.h"
#include "shaders/compute/interface/refine_colour.h"
#include "shaders/compute/interface/select_points.h"
#include "shaders/compute/interface/sum_check.h"
#include "shaders/compute/interface/volume.h"

namespace rosefusion::testing {
namespace test_shader_interfaces {

#define MEMBER(STRUCT, NAME) \
  { #NAME, offsetof(shader::STRUCT, NAME) }
#define STRUCT(NAME, ...)            \
  {                                  \
#NAME, {                         \
#NAME, sizeof(shader::NAME), { \
        __VA_ARGS__                  \
      }                              \
    }                                \
  }

/// A new interface struct goes in here; a test fails for shaders with one that is absent.
const std::map<std::string, ShaderStruct>& structsInCpp() {
  static const std::map<std::string, ShaderStruct> structs = {
      STRUCT(AllocateParams, MEMBER(AllocateParams, world_from_camera), MEMBER(AllocateParams, focal_centre),
             MEMBER(AllocateParams, size), MEMBER(AllocateParams, capacity), MEMBER(AllocateParams, band)),
      STRUCT(AllocateHeader, MEMBER(AllocateHeader, requested), MEMBER(AllocateHeader, outside),
             MEMBER(AllocateHeader, outside_min_x), MEMBER(AllocateHeader, outside_min_y),
             MEMBER(AllocateHeader, outside_min_z), MEMBER(AllocateHeader, outside_max_x),
             MEMBER(AllocateHeader, outside_max_y), MEMBER(AllocateHeader, outside_max_z)),
      STRUCT(FitnessParams, MEMBER(FitnessParams, world_from_camera),
             MEMBER(FitnessParams, translation_lengths), MEMBER(FitnessParams, rotation_lengths),
             MEMBER(FitnessParams, particles), MEMBER(FitnessParams, first_particle),
             MEMBER(FitnessParams, slices), MEMBER(FitnessParams, race_margin)),
      STRUCT(OverlapView, MEMBER(OverlapView, image_from_world), MEMBER(OverlapView, size)),
      STRUCT(FitnessReduceParams, MEMBER(FitnessReduceParams, particles),
             MEMBER(FitnessReduceParams, slices)),
      STRUCT(IcpParams, MEMBER(IcpParams, world_from_camera), MEMBER(IcpParams, parts),
             MEMBER(IcpParams, pad0), MEMBER(IcpParams, pad1), MEMBER(IcpParams, pad2)),
      STRUCT(IcpModel, MEMBER(IcpModel, camera_from_world), MEMBER(IcpModel, focal_centre),
             MEMBER(IcpModel, size), MEMBER(IcpModel, grid), MEMBER(IcpModel, distance),
             MEMBER(IcpModel, cosine), MEMBER(IcpModel, pad0), MEMBER(IcpModel, pad1)),
      STRUCT(IntegrateParams, MEMBER(IntegrateParams, camera_from_world),
             MEMBER(IntegrateParams, focal_centre), MEMBER(IntegrateParams, size),
             MEMBER(IntegrateParams, noise_floor), MEMBER(IntegrateParams, noise_growth),
             MEMBER(IntegrateParams, bias_growth), MEMBER(IntegrateParams, thin_walls)),
      STRUCT(FarthestParams, MEMBER(FarthestParams, size)),
      STRUCT(MomentsParams, MEMBER(MomentsParams, size), MEMBER(MomentsParams, cells)),
      STRUCT(FootprintParams, MEMBER(FootprintParams, focal_centre), MEMBER(FootprintParams, size),
             MEMBER(FootprintParams, voxel_size), MEMBER(FootprintParams, noise_floor),
             MEMBER(FootprintParams, noise_growth), MEMBER(FootprintParams, pad0)),
      STRUCT(PreprocessParams, MEMBER(PreprocessParams, size), MEMBER(PreprocessParams, metres_per_unit),
             MEMBER(PreprocessParams, min_depth), MEMBER(PreprocessParams, max_depth),
             MEMBER(PreprocessParams, edge_sigmas), MEMBER(PreprocessParams, noise_floor),
             MEMBER(PreprocessParams, noise_growth), MEMBER(PreprocessParams, pad0),
             MEMBER(PreprocessParams, pad1)),
      STRUCT(RefineParams, MEMBER(RefineParams, huber), MEMBER(RefineParams, noise_floor),
             MEMBER(RefineParams, noise_growth), MEMBER(RefineParams, parts),
             MEMBER(RefineParams, last_image), MEMBER(RefineParams, bias_growth),
             MEMBER(RefineParams, model_noise), MEMBER(RefineParams, front_only)),
      STRUCT(RefineCandidate, MEMBER(RefineCandidate, world_from_camera),
             MEMBER(RefineCandidate, last_image_from_camera)),
      STRUCT(RefineColourParams, MEMBER(RefineColourParams, focal_centre), MEMBER(RefineColourParams, size),
             MEMBER(RefineColourParams, huber), MEMBER(RefineColourParams, parts),
             MEMBER(RefineColourParams, pad0), MEMBER(RefineColourParams, pad1)),
      STRUCT(RefineColourCandidate, MEMBER(RefineColourCandidate, world_from_camera),
             MEMBER(RefineColourCandidate, gain)),
      STRUCT(SelectParams, MEMBER(SelectParams, previous_from_current), MEMBER(SelectParams, focal_centre),
             MEMBER(SelectParams, size), MEMBER(SelectParams, grid)),
      STRUCT(SumCheckParams, MEMBER(SumCheckParams, first), MEMBER(SumCheckParams, count)),
      STRUCT(RaycastParams, MEMBER(RaycastParams, world_from_camera), MEMBER(RaycastParams, focal_centre),
             MEMBER(RaycastParams, size), MEMBER(RaycastParams, depth_value)),
      STRUCT(RaycastRangeParams, MEMBER(RaycastRangeParams, camera_from_world),
             MEMBER(RaycastRangeParams, focal_centre), MEMBER(RaycastRangeParams, size),
             MEMBER(RaycastRangeParams, near), MEMBER(RaycastRangeParams, far)),
      STRUCT(RaycastTile, MEMBER(RaycastTile, nearest), MEMBER(RaycastTile, farthest_complement)),
      STRUCT(ExtractCountParams, MEMBER(ExtractCountParams, first_slot), MEMBER(ExtractCountParams, blocks),
             MEMBER(ExtractCountParams, min_weight), MEMBER(ExtractCountParams, pad0)),
      STRUCT(ExtractCount, MEMBER(ExtractCount, vertices), MEMBER(ExtractCount, triangles)),
      STRUCT(ExtractEmitParams, MEMBER(ExtractEmitParams, blocks), MEMBER(ExtractEmitParams, min_weight),
             MEMBER(ExtractEmitParams, colour), MEMBER(ExtractEmitParams, pad0)),
      STRUCT(ExtractVertex, MEMBER(ExtractVertex, x), MEMBER(ExtractVertex, y), MEMBER(ExtractVertex, z),
             MEMBER(ExtractVertex, edge), MEMBER(ExtractVertex, normal_x), MEMBER(ExtractVertex, normal_y),
             MEMBER(ExtractVertex, normal_z), MEMBER(ExtractVertex, colour)),
      STRUCT(VolumeLayout, MEMBER(VolumeLayout, table_origin), MEMBER(VolumeLayout, table_size),
             MEMBER(VolumeLayout, scale)),
  };
  return structs;
}

/// What differs between the two, one line each.
std::vector<std::string> differences(const ShaderStruct& spirv, const ShaderStruct& cpp) {
  std::vector<std::string> found;
  if (spirv.name != cpp.name) found.push_back("name " + spirv.name + " and " + cpp.name);
  if (spirv.bytes != cpp.bytes)
    found.push_back(spirv.name + ": " + std::to_string(spirv.bytes) + " B in SPIR-V, " +
                    std::to_string(cpp.bytes) + " B in C++");
  if (spirv.members.size() != cpp.members.size()) {
    found.push_back(spirv.name + ": " + std::to_string(spirv.members.size()) + " members in SPIR-V");
    return found;
  }
  for (std::size_t i = 0; i < spirv.members.size(); ++i) {
    const ShaderMember &s = spirv.members[i], &c = cpp.members[i];
    if (s.name != c.name || s.offset_bytes != c.offset_bytes)
      found.push_back(spirv.name + ": " + s.name + " at " + std::to_string(s.offset_bytes) + " in SPIR-V, " +
                      c.name + " at " + std::to_string(c.offset_bytes) + " in C++");
  }
  return found;
}

TEST(ShaderInterfaces, OffsetsAndSizesAgree) {
  std::map<std::string, int> compared;
  for (const ShaderCode& code : allShaders()) {
    const ShaderInterface shader = reflect(code);
    std::vector<ShaderStruct> structs = shader.structs;
    if (shader.push.bytes > 0) structs.push_back(shader.push);
    for (const ShaderStruct& spirv : structs) {
      SCOPED_TRACE(code.name);
      const auto cpp = structsInCpp().find(spirv.name);
      ASSERT_NE(cpp, structsInCpp().end()) << spirv.name << " is not in structsInCpp(): add it";
      EXPECT_THAT(differences(spirv, cpp->second), ::testing::IsEmpty());
      ++compared[spirv.name];
    }
  }
  for (const auto& [name, cpp] : structsInCpp()) EXPECT_GT(compared[name], 0) << name << " is in no shader";
}

TEST(ShaderInterfaces, PushConstantsFitEveryDevice) {
  for (const ShaderCode& code : allShaders()) EXPECT_LE(reflect(code).push.bytes, 128u) << code.name;
}

/// What Vulkan requires of every device: maxPerStageDescriptorSampledImages, which texel buffers count as,
/// and maxPerStageDescriptorUniformBuffers. Of storage buffers it requires only 4: a device is asked for
/// those there is need of.
TEST(ShaderInterfaces, BindingsFitEveryDeviceThatIsAccepted) {
  int most_storage = 0;
  for (const ShaderCode& code : allShaders()) {
    std::map<BindingKind, int> count;
    for (const ShaderBinding& binding : reflect(code).bindings) ++count[binding.kind];
    EXPECT_LE(count[BindingKind::WordTexels] + count[BindingKind::VectorTexels], 16) << code.name;
    EXPECT_LE(count[BindingKind::Uniform], 12) << code.name;
    most_storage = std::max(most_storage, count[BindingKind::Storage]);
  }
  EXPECT_EQ(deviceRequirements().limits.max_storage_buffers, static_cast<std::uint32_t>(most_storage));
}

TEST(ShaderInterfaces, ComparisonSeesAWrongLayout) {
  const ShaderStruct spirv = reflect(shaderCode("allocate")).push;
  const ShaderStruct& right = structsInCpp().at("AllocateParams");
  EXPECT_THAT(differences(spirv, right), ::testing::IsEmpty());
  // What a vec3 in the middle would do: C++ packs it into 12 bytes, std430 gives it 16.
  struct WithVec3 {
    float world_from_camera[16];
    float focal_centre[3];
    int size[4];
    std::uint32_t capacity;
    float band;
  };
  ShaderStruct wrong{"AllocateParams",
                     sizeof(WithVec3),
                     {{"world_from_camera", offsetof(WithVec3, world_from_camera)},
                      {"focal_centre", offsetof(WithVec3, focal_centre)},
                      {"size", offsetof(WithVec3, size)},
                      {"capacity", offsetof(WithVec3, capacity)},
                      {"band", offsetof(WithVec3, band)}}};
  EXPECT_EQ(differences(spirv, wrong).size(), 4u);  // the size and three offsets
  wrong = right;
  std::swap(wrong.members[3].name, wrong.members[4].name);
  EXPECT_EQ(differences(spirv, wrong).size(), 2u);
  wrong = right;
  wrong.members.pop_back();
  EXPECT_EQ(differences(spirv, wrong).size(), 1u);
  const auto structs = reflect(shaderCode("allocate")).structs;
  ASSERT_EQ(structs.size(), 2u);
  EXPECT_FALSE(differences(structs[0], structsInCpp().at(structs[1].name)).empty());
}

}  // namespace test_shader_interfaces
}  // namespace rosefusion::testing
