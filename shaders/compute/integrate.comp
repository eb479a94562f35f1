#version 450
#extension GL_GOOGLE_include_directive : require
// Fuses one depth image into the listed blocks: signed distance along the ray, truncated; running mean with capped
// weight. Space in front of the surface is carved; what lies further behind than the truncation is left alone.
#include "shaders/compute/interface/integrate.h"

#define VOLUME_UNIFORM_LAYOUT kIntegrateBindLayout
#include "shaders/compute/lib/depth_noise.glsl"
#include "shaders/compute/lib/parameters.glsl"
#include "shaders/compute/lib/volume.glsl"
#include "shaders/compute/lib/written_pool.glsl"
WRITTEN_POOL(setTsdfWord, tsdf, kIntegrateBindTsdf)
READ_WRITTEN_POOL(tsdf, kIntegrateBindTsdfTexels)
CHUNK_FUNCTION(uint, tsdfWord, tsdf_0, tsdf_1, tsdf_2, tsdf_3)
WRITTEN_POOL(setWeightWord, weight, kIntegrateBindWeight)
READ_WRITTEN_POOL(weight, kIntegrateBindWeightTexels)
CHUNK_FUNCTION(uint, weightWord, weight_0, weight_1, weight_2, weight_3)
WRITTEN_POOL(setColourWord, colour, kIntegrateBindColour)
READ_WRITTEN_POOL(colour, kIntegrateBindColourTexels)
CHUNK_FUNCTION(uint, colourWord, colour_0, colour_1, colour_2, colour_3)

// A constant: llvmpipe runs what stands behind a condition with all lanes masked, for colours that are nowhere.
layout(constant_id = 1) const bool kFuseColour = true;

layout(local_size_x = kIntegrateGroup) in;
PUSHED_PARAMETERS(IntegrateParams)
BLOCKS(kIntegrateBindBlocks)
READ_WORDS(visibleAt, kIntegrateBindVisible)
READ_FLOATS(depthAt, kIntegrateBindDepth)
READ_WORDS(colourAt, kIntegrateBindColourImage)

// The image pixel that sees a camera-frame point; -1 when none does.
int pixelOf(vec3 p) {
  if (p.z <= 0.0) return -1;
  ivec2 uv = ivec2(floor(params.focal_centre.xy * p.xy / p.z + params.focal_centre.zw + 0.5));
  bool inside = uv.x >= 0 && uv.y >= 0 && uv.x < params.size.x && uv.y < params.size.y;
  return inside ? uv.y * params.size.x + uv.x : -1;
}

void fuseColour(uint chunk, uint word, uint rgb, bool anew) {
  const float kColourWeightCap = 64.0;  // enough to average noise, fits the byte
  uint old = anew ? 0u : colourWord(chunk, word);
  float weight = float(old >> 24);
  vec3 mean = (unpackUnorm4x8(old).xyz * weight + unpackUnorm4x8(rgb).xyz) / (weight + 1.0);
  uint packed = packUnorm4x8(vec4(mean, 0.0));
  setColourWord(chunk, word, (packed & 0xFFFFFFu) | (uint(min(weight + 1.0, kColourWeightCap)) << 24));
}

// The least difference, in truncations, by which two views contradict each other about a voxel.
float contradiction(float z) {
  const float kDeviations = 4.0, kVoxels = 0.5;
  float noise = depthNoise(params.noise_floor, params.noise_growth, z);
  return max(kDeviations * noise, kVoxels * volume.scale.x) / volume.scale.z;
}

// What the image says of a voxel at a camera-frame point.
struct Sight {
  int pixel;
  float z;
  float distance_;  // along the ray, positive in front of the surface
  bool told;        // whether it says anything: a depth, not too far in front of the voxel
};

Sight sightOf(vec3 p) {
  Sight sight;
  sight.pixel = pixelOf(p);
  sight.z = sight.pixel >= 0 ? depthAt(uint(sight.pixel)) : 0.0;
  sight.distance_ = (sight.z / p.z - 1.0) * length(p);
  sight.told = sight.z > 0.0 && sight.distance_ >= -volume.scale.z;
  return sight;
}

// Fuses it into a voxel, whose colour is that word.
void fuse(Sight sight, inout float tsdf, inout float weight, uint chunk, uint colour) {
  float truncation = volume.scale.z, max_weight = volume.scale.w;
  float value = min(sight.distance_ / truncation, 1.0);
  float noise = depthNoise(params.noise_floor, params.noise_growth, sight.z);
  float variance = depthVariance(noise, params.bias_growth, sight.z);
  float gain = max(params.noise_floor * params.noise_floor / variance, 1.0 / kWeightOne);
  // A solid lies behind every surface seen of it: behind surfaces, of two distances that differ by more than noise the larger
  // is right, and their mean would be neither of a thin wall's two sides.
  bool anew = false, told = sight.told;
  if (params.thin_walls != 0u && weight > 0.0) {
    float least = contradiction(sight.z);
    told = told && !(tsdf < least && value < min(-least, tsdf - least));
    anew = tsdf < min(-least, value - least);
  }
  if (!told) return;
  float before = anew ? 0.0 : weight;
  tsdf = (tsdf * before + value * gain) / (before + gain);
  weight = min(before + gain, max_weight);
  if (kFuseColour && sight.distance_ < truncation) fuseColour(chunk, colour, colourAt(uint(sight.pixel)), anew);
}

void main() {
  uint item = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
  if (item >= uint(params.size.z)) return;
  uint slot = visibleAt(item);
  uint chunk = chunkOf(slot);
  uint row = gl_LocalInvocationID.x;
  ivec3 voxel = blockAt(slot) * kBlockSide + ivec3(0, row & 7u, row >> 3);
  float voxel_size = volume.scale.x;
  vec3 p = (params.camera_from_world * vec4((vec3(voxel) + 0.5) * voxel_size, 1.0)).xyz;
  vec3 step_x = params.camera_from_world[0].xyz * voxel_size;
  uint first = localIndex(voxel);
  uint first_word = slotInChunk(slot) * kBlockTsdfWords + first / 2u;
  uint first_colour = slotInChunk(slot) * kBlockColourWords + first;

  uint pair = 0u;
  do {
    Sight a = sightOf(p + float(2u * pair) * step_x), b = sightOf(p + float(2u * pair + 1u) * step_x);
    if (a.told || b.told) {
      uint word = first_word + 4u * pair, colour = first_colour + 8u * pair;
      uint t = tsdfWord(chunk, word), w = weightWord(chunk, word);
      vec2 tsdf = vec2(tsdfOf(t << 16), tsdfOf(t));
      vec2 weight = vec2(w & 0xFFFFu, w >> 16) * (1.0 / kWeightOne);
      fuse(a, tsdf.x, weight.x, chunk, colour);
      fuse(b, tsdf.y, weight.y, chunk, colour + 1u);
      setTsdfWord(chunk, word, packSnorm2x16(tsdf));
      uvec2 units = uvec2(weight * kWeightOne + 0.5);
      setWeightWord(chunk, word, units.x | (units.y << 16));
    }
  } while (++pair < 4u);
}
