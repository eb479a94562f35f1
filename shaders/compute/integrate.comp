#version 450
#extension GL_GOOGLE_include_directive : require
// Fuses one depth image into the listed blocks: signed distance along the ray, truncated; running mean with capped
// weight. Space in front of the surface is carved; what lies further behind than the truncation is left alone.
#include "shaders/compute/interface/integrate.h"

#define VOLUME_ACCESS
#define VOLUME_LAYOUT kIntegrateBindLayout
#define VOLUME_TSDF kIntegrateBindTsdf
#define VOLUME_WEIGHT kIntegrateBindWeight
#define VOLUME_COLOUR kIntegrateBindColour
#include "shaders/compute/lib/depth_noise.glsl"
#include "shaders/compute/lib/volume.glsl"
POOL_WRITER(tsdf)
POOL_WRITER(weight)
POOL_WRITER(colour)

layout(local_size_x = kIntegrateGroup) in;
layout(push_constant) uniform Push { IntegrateParams params; };
layout(std430, binding = kIntegrateBindBlocks) readonly restrict buffer Blocks { ivec4 blocks[]; };
layout(std430, binding = kIntegrateBindVisible) readonly restrict buffer Visible { uint visible[]; };
layout(std430, binding = kIntegrateBindDepth) readonly restrict buffer Depth { float depth[]; };
layout(std430, binding = kIntegrateBindColourImage) readonly restrict buffer ColourImage { uint colour_image[]; };

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
  setcolourWord(chunk, word, (packed & 0xFFFFFFu) | (uint(min(weight + 1.0, kColourWeightCap)) << 24));
}

// The least difference, in truncations, by which two views contradict each other about a voxel.
float contradiction(float z) {
  const float kDeviations = 4.0, kVoxels = 0.5;
  float noise = depthNoise(params.noise_floor, params.noise_growth, z);
  return max(kDeviations * noise, kVoxels * volume.scale.x) / volume.scale.z;
}

void main() {
  uint item = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
  if (item >= uint(params.size.z)) return;
  uint slot = visible[item];
  uint chunk = chunkOf(slot);
  uint row = gl_LocalInvocationID.x;
  ivec3 voxel = blocks[slot].xyz * kBlockSide + ivec3(0, row & 7u, row >> 3);
  float voxel_size = volume.scale.x, truncation = volume.scale.z, max_weight = volume.scale.w;
  vec3 p = (params.camera_from_world * vec4((vec3(voxel) + 0.5) * voxel_size, 1.0)).xyz;
  vec3 step_x = params.camera_from_world[0].xyz * voxel_size;
  uint first_word = slotInChunk(slot) * kBlockTsdfWords + row * 4u;
  uint first_colour = slotInChunk(slot) * kBlockColourWords + row * 8u;

  for (uint pair = 0u; pair < 4u; ++pair) {
    vec2 tsdf = vec2(0.0), weight = vec2(0.0);
    bool changed = false, loaded = false;
    for (uint half_ = 0u; half_ < 2u; ++half_) {
      vec3 q = p + float(2u * pair + half_) * step_x;
      int pixel = pixelOf(q);
      float z = pixel >= 0 ? depth[pixel] : 0.0;
      float distance_ = (z / q.z - 1.0) * length(q);  // along the ray, positive in front of the surface
      if (z <= 0.0 || distance_ < -truncation) continue;
      if (!loaded) {
        uint t = tsdfWord(chunk, first_word + pair), w = weightWord(chunk, first_word + pair);
        tsdf = vec2(tsdfOf(t << 16), tsdfOf(t));
        weight = vec2(w & 0xFFFFu, w >> 16) * (1.0 / kWeightOne);
        loaded = true;
      }
      float value = min(distance_ / truncation, 1.0);
      float gain = max(depthWeight(params.noise_floor, params.noise_growth, z), 1.0 / kWeightOne);
      // A solid lies behind every surface seen of it: behind surfaces, of two distances that differ by more than noise the larger
      // is right, and their mean would be neither of a thin wall's two sides.
      bool anew = false;
      if (params.thin_walls != 0u && weight[half_] > 0.0) {
        float least = contradiction(z), old = tsdf[half_];
        if (old < least && value < min(-least, old - least)) continue;
        anew = old < min(-least, value - least);
        if (anew) weight[half_] = 0.0;
      }
      tsdf[half_] = (tsdf[half_] * weight[half_] + value * gain) / (weight[half_] + gain);
      weight[half_] = min(weight[half_] + gain, max_weight);
      changed = true;
      if (params.size.w != 0 && distance_ < truncation)
        fuseColour(chunk, first_colour + 2u * pair + half_, colour_image[pixel], anew);
    }
    if (changed) {
      settsdfWord(chunk, first_word + pair, packSnorm2x16(tsdf));
      uvec2 w = uvec2(weight * kWeightOne + 0.5);
      setweightWord(chunk, first_word + pair, w.x | (w.y << 16));
    }
  }
}
