#version 450
#extension GL_GOOGLE_include_directive : require
// Follows one ray per pixel to the first place where the TSDF falls from observed free space through zero. Blocks
// without a negative voxel are crossed in one step, the others in steps of the distance they store.
#include "shaders/compute/interface/raycast.h"
#include "shaders/compute/interface/raycast_range.h"

#define VOLUME_UNIFORM_LAYOUT kRaycastBindLayout
#define VOLUME_TABLE kRaycastBindTable
#define VOLUME_TSDF kRaycastBindTsdf
#define VOLUME_TSDF_QUADS
#define VOLUME_WEIGHT kRaycastBindWeight
#define VOLUME_COLOUR kRaycastBindColour
#include "shaders/compute/lib/parameters.glsl"
#include "shaders/compute/lib/volume.glsl"
#include "shaders/compute/lib/interpolate.glsl"
#include "shaders/compute/lib/shade.glsl"
#include "shaders/compute/lib/direction.glsl"

layout(local_size_x = kRaycastGroup, local_size_y = kRaycastGroup) in;
PUSHED_PARAMETERS(RaycastParams)
layout(std430, binding = kRaycastBindImages) writeonly restrict buffer Images { uint images[]; };
READ_WORDS(tileWord, kRaycastBindTiles)
READ_WORDS(solidEntry, kRaycastBindSolid)

// For llvmpipe, which branches only from a loop's end to its begin and runs all else with lanes masked: loops test at
// their end, for with the test at the head the body runs once more for nothing; and what a loop reads and later code needs
// is kept in a variable set where the loop is left, for the turns of other lanes overwrite the rest (Mesa 22.3).
const float kStepShare = 0.8;   // of the stored distance, which a slanted view makes too long
// Voxels. With one more at both ends, their cells and the normal's neighbours the voxels read then lie at most 8 apart:
// in one patch of blocks.
const float kLongestStep = 3.0;
const float kPastExit = 0.01;   // voxels behind a skipped block's face, against rounding,
const float kPastShare = 1e-6;  // ... and a share of the way so far, which far away is more
const float kBeforeExit = 0.5;  // voxels before it: the sample that stands for the block
const int kMaxCandidates = 8;   // sign changes looked at per ray
const float kLeastSlope = -1e-3;  // TSDF per voxel along the ray; keeps Newton steps finite
const int kMaxSteps = 5;          // of Newton's method
const float kConverged = 0.2;    // voxels of TSDF left; one more step then ends closer than a hundredth
const float kMaxResidual = 0.5;  // voxels; a larger TSDF at its end means the ray passes by

// A ray in voxels from the table's corner; `t` counts voxels.
struct Ray {
  vec3 origin;
  vec3 direction;  // unit length
  vec3 inverse;    // its sign is the one that counts: an axis that the ray hardly moves along is +1e9
};

vec3 at(Ray ray, float t) { return ray.origin + t * ray.direction; }

// Part of the ray inside the table, its border left out.
vec2 insideTable(Ray ray) {
  vec3 a = (float(kBlockSide) - ray.origin) * ray.inverse;
  vec3 b = (vec3((volume.table_size.xyz - 1) * kBlockSide) - ray.origin) * ray.inverse;
  vec3 enter = min(a, b), leave = max(a, b);
  return vec2(max(max(enter.x, enter.y), enter.z), min(min(leave.x, leave.y), leave.z));
}

float blockExit(Ray ray, ivec3 entry) {
  vec3 face = vec3(entry * kBlockSide) + mix(vec3(0.0), vec3(kBlockSide), greaterThan(ray.inverse, vec3(0.0)));
  vec3 leave = (face - ray.origin) * ray.inverse;
  return min(min(leave.x, leave.y), leave.z);
}

uint solidAt(ivec3 entry) { return solidEntry(uint((entry.z * volume.table_size.y + entry.y) * volume.table_size.x + entry.x)); }

// Whether all 8 voxels around a position were observed. Only +1 can be one that was not.
bool wellObserved(vec3 position, float largest) {
  bool observed = true;
  int corner = 0;
  if (largest >= 1.0) [[dont_unroll]] do {
    ivec3 voxel = ivec3(floor(position - 0.5)) + (ivec3(corner) >> ivec3(0, 1, 2) & 1);
    observed = observed && weightInBlock(slotAt(voxel >> 3), localIndex(voxel)) > 0.0;
  } while (++corner < 8);
  return observed;
}

struct Hit {
  float t;  // negative: none
  vec3 gradient;
};

// Samples along a ray, one at a time.
struct Walk {
  float t;        // of the last one
  float value;    // of the last one behind a surface
  bool front;     // whether the one before, at front_t, was in front
  float front_t;
};

// Goes on from walk.t to the first sample behind a surface; false: none before `end`.
bool crosses(Ray ray, float end, float band, inout Walk walk) {
  bool found = false;
  do {
    uint slot = 0u;
    do {  // empty blocks
      ivec3 entry = ivec3(at(ray, walk.t)) >> 3;
      uint here = solidAt(clampToTable(entry));
      if (here != 0u) {
        slot = here;
        break;
      }
      float leave = blockExit(ray, entry);
      walk.front = true;
      walk.front_t = leave - kBeforeExit;
      walk.t = max(leave, walk.t) + max(kPastExit, kPastShare * walk.t);
    } while (walk.t < end);
    if (walk.t >= end) break;
    float value = tsdfInBlock(slot, localIndex(ivec3(at(ray, walk.t))));
    if (value < 0.0 && walk.front) {
      walk.value = value;
      found = true;
      break;
    }
    walk.front = value >= 0.0;
    walk.front_t = walk.t;
    walk.t += clamp(abs(value) * band * kStepShare, 1.0, kLongestStep);
  } while (walk.t < end);
  return found;
}

// The surface between the walk's last two samples; none where not all voxels there were `observed`, or the ray passes by.
Hit surfaceBetween(Ray ray, float band, Walk walk, out bool observed) {
  float front_t = max(walk.front_t, walk.t - kLongestStep);  // farther after a candidate that was none
  ivec3 voxel = ivec3(at(ray, front_t));
  uint slot = slotAt(voxel >> 3);
  float front_value = tsdfInBlock(slot, localIndex(voxel));
  observed = front_value < 1.0 || weightInBlock(slot, localIndex(voxel)) > 0.0;
  // Newton's method from where a straight line through the two samples is zero, kept between their ends, until the
  // rest is small; the last step takes its value from the same 27 voxels as the normal.
  float ahead = front_t - 1.0, behind = walk.t + 1.0;
  vec3 one_end = at(ray, ahead), other_end = at(ray, behind);
  Patch slots = patchOf(ivec3(min(one_end, other_end)) - 1, ivec3(max(one_end, other_end)) + 1);
  float guess = mix(front_t, walk.t, mix(0.5, front_value / (front_value - walk.value), front_value > 0.0));
  bool near_enough;
  int steps = 0;
  do {
    vec4 field = trilinear(cellIn(slots, at(ray, guess)));
    near_enough = abs(field.w) * band < kConverged;
    bool in_front = field.w > 0.0;
    ahead = mix(ahead, guess, in_front);
    behind = mix(guess, behind, in_front);
    float next = guess - field.w / min(dot(field.xyz, ray.direction), kLeastSlope);
    guess = mix(0.5 * (ahead + behind), next, next >= ahead && next <= behind);
  } while (!near_enough && ++steps < kMaxSteps);
  Neighbourhood near = neighbourhoodIn(slots, at(ray, guess));
  float correction = near.value / min(dot(near.gradient, ray.direction), kLeastSlope);
  observed = observed && wellObserved(at(ray, guess), near.largest_in_cell);
  return Hit(observed && abs(near.value) * band < kMaxResidual ? guess - clamp(correction, -0.5, 0.5) : -1.0, near.gradient);
}

// First hit in [begin, end].
Hit firstHit(Ray ray, float begin, float end) {
  float band = volume.scale.z * volume.scale.y;  // truncation in voxels
  Walk walk = Walk(begin, 1.0, false, begin);
  Hit hit = Hit(-1.0, vec3(0.0));
  int candidates = 0;
  do {
    if (!crosses(ray, end, band, walk)) break;
    bool observed;
    hit = surfaceBetween(ray, band, walk, observed);
    walk.front = observed;
    walk.t += 1.0;
  } while (hit.t < 0.0 && walk.t < end && ++candidates < kMaxCandidates);
  return hit;
}

// Colour of the voxels around a position, as far as they have one.
vec3 colourAt(vec3 position) {
  vec3 corner = floor(position - 0.5), fraction = position - 0.5 - corner, sum = vec3(0.0);
  float total = 0.0;
  int i = 0;
  if ((params.size.z & kRaycastColoured) != 0) [[dont_unroll]] do {
    ivec3 offset = ivec3(i) >> ivec3(0, 1, 2) & 1, voxel = ivec3(corner) + offset;
    uint slot = slotAt(voxel >> 3);
    uint word = colourWord(chunkOf(slot), slotInChunk(slot) * kBlockColourWords + localIndex(voxel));
    vec3 share = mix(1.0 - fraction, fraction, vec3(offset));
    float weight = word >> 24 > 0u ? share.x * share.y * share.z : 0.0;
    sum += weight * unpackUnorm4x8(word).xyz;
    total += weight;
  } while (++i < 8);
  return total > 0.0 ? sum / total : kClay;
}

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (pixel.x >= params.size.x || pixel.y >= params.size.y) return;
  vec3 camera_ray = vec3((vec2(pixel) - params.focal_centre.zw) / params.focal_centre.xy, 1.0);
  Ray ray;
  ray.origin = params.world_from_camera[3].xyz * volume.scale.y - vec3(volume.table_origin.xyz * kBlockSide);
  ray.direction = normalize(mat3(params.world_from_camera) * camera_ray);
  ray.inverse = 1.0 / mix(ray.direction, vec3(1e-9), lessThan(abs(ray.direction), vec3(1e-9)));
  float voxels_per_depth = length(camera_ray) * volume.scale.y;
  uint word = 2u * uint((pixel.y / kRaycastTile) * params.size.w + pixel.x / kRaycastTile);
  RaycastTile tile = RaycastTile(tileWord(word), tileWord(word + 1u));
  vec2 depths = tile.nearest == kEmptyTile ? vec2(0.0) : uintBitsToFloat(uvec2(tile.nearest, ~tile.farthest_complement));
  vec2 span = insideTable(ray);
  Hit hit = firstHit(ray, max(span.x, depths.x * voxels_per_depth), min(span.y, depths.y * voxels_per_depth));

  vec3 normal = vec3(0.0);
  float z = 0.0;
  bool clear = (params.size.z & kRaycastClear) != 0;
  vec4 shaded = clear ? vec4(0.0) : vec4(backgroundColour(float(pixel.y) / float(params.size.y)), 1.0);
  float value = params.depth_value.w;
  if (hit.t > 0.0) {
    vec3 position = at(ray, hit.t);
    z = hit.t / voxels_per_depth;
    normal = normalize(hit.gradient);
    shaded = vec4(shadedColour(colourAt(position), normal, ray.direction), 1.0);
    value = params.depth_value.x + params.depth_value.y / z + params.depth_value.z * z;
  }
  uint index = uint(pixel.y * params.size.x + pixel.x), pixels = uint(params.size.x * params.size.y);
  images[2u * index] = packedDirection(normal);
  images[2u * index + 1u] = floatBitsToUint(z);
  images[kRaycastPreviewAt * pixels + index] = packUnorm4x8(shaded);
  if ((params.size.z & kRaycastDepth) != 0) images[kRaycastDepthAt * pixels + index] = floatBitsToUint(value);
}
