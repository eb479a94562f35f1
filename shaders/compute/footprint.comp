#version 450
#extension GL_GOOGLE_include_directive : require
// Gives every pixel the depth that a voxel there sees: of the plane through all valid depths that the voxel's footprint
// covers, where they lie on one plane; else its own. Holes of the sensor are filled by the plane around them, where it is as
// sure as a depth.
#include "shaders/compute/interface/footprint.h"
#include "shaders/compute/lib/depth_noise.glsl"
#include "shaders/compute/lib/moments.glsl"
#include "shaders/compute/lib/parameters.glsl"
#include "shaders/compute/lib/read.glsl"

layout(local_size_x = kFootprintGroup) in;
PUSHED_PARAMETERS(FootprintParams)
READ_WORDS(rawPair, kFootprintBindRaw)
READ_FLOATS(ownAt, kFootprintBindOwn)
READ_VECTORS(cellsA, kFootprintBindCells)
READ_VECTORS(cellsB, kFootprintBindCells + 1u)
READ_VECTORS(cellsC, kFootprintBindCells + 2u)
READ_VECTORS(cellsD, kFootprintBindCells + 3u)
layout(std430, binding = kFootprintBindDepth) writeonly restrict buffer Depth { float depth[]; };
layout(std430, binding = kFootprintBindPoints) writeonly restrict buffer Points { vec4 points[]; };

const float kDeviations = 4.0;  // of the sum of squares: more is not noise

vec4 vectorAt(int level, uint i) {
  return level == 0 ? cellsA(i) : level == 1 ? cellsB(i) : level == 2 ? cellsC(i) : cellsD(i);
}

Moments momentsAt(int level, ivec2 cell) {
  int columns = (params.size.x + (kFootprintSide << level) - 1) / (kFootprintSide << level);
  uint i = kMomentVectors * uint((cell.y >> level) * columns + (cell.x >> level));
  return unpacked(vectorAt(level, i), vectorAt(level, i + 1u), vectorAt(level, i + 2u));
}

// Whether noise explains what the depths differ from one plane.
bool isFlat(Moments m, Plane plane) {
  float z = 1.0 / m.q, deviation = depthNoise(params.noise_floor, params.noise_growth, z) * m.q * m.q;
  float freedom = m.n - 3.0;
  return plane.squares <= deviation * deviation * (freedom + kDeviations * sqrt(2.0 * freedom));
}

void main() {
  uint group = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
  int number = int(group * kFootprintGroup + gl_LocalInvocationID.x);
  if (number >= params.size.z * params.size.w) return;
  ivec2 cell = ivec2(number % params.size.z, number / params.size.z);
  float pixels_per_inverse = params.voxel_size * params.focal_centre.x;  // a voxel's, times its inverse depth
  Moments m = noMoments();
  Plane plane = Plane(vec2(0.0), 0.0, 0.0);
  bool whole = false, covered = false;
  int level = kFootprintLevels - 1;
  if (params.voxel_size > 0.0) do {
    m = momentsAt(level, cell);
    covered = float(kFootprintSide << level) <= pixels_per_inverse * m.q;
    if (m.n > 3.0 && (covered || level == 0)) {
      plane = planeThrough(m);
      whole = plane.det > 0.0 && isFlat(m, plane);
    }
  } while (!whole && --level >= 0);

  for (int i = 0; i < kFootprintSide * kFootprintSide; ++i) {
    ivec2 at = kFootprintSide * cell + ivec2(i % kFootprintSide, i / kFootprintSide);
    if (any(greaterThanEqual(at, params.size.xy))) continue;
    uint pixel = uint(at.y * params.size.x + at.x);
    float z = ownAt(pixel);
    uint raw = (rawPair(pixel >> 1) >> (16u * (pixel & 1u))) & 0xFFFFu;
    bool hole = raw == 0u || raw == 65535u;
    float q = m.q + dot(plane.slope, vec2(at) - m.at);
    // A steep plane may run out to its horizon within a cell.
    bool within = q * params.max_depth >= 1.0 && q * params.min_depth <= 1.0;
    if (whole && within && (hole || (z > 0.0 && covered)) && leverage(m, plane, vec2(at)) <= 1.0) z = 1.0 / q;
    vec2 ray = (vec2(at) - params.focal_centre.zw) / params.focal_centre.xy;
    depth[pixel] = z;
    points[pixel] = z > 0.0 ? vec4(ray * z, z, 1.0) : vec4(0.0);
  }
}
