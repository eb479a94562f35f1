// Continuous versions of the stored TSDF and colour; include after lib/volume.glsl with VOLUME_TABLE and VOLUME_TSDF or
// VOLUME_COLOUR or both.
// Positions are in voxels from the table's corner, where voxel i has its centre at i + 0.5, and must stay two voxels
// inside the table. Derivatives are per voxel.

#extension GL_EXT_control_flow_attributes : require

// Where a 2 x 2 x 2 patch of blocks lies: the slots of all blocks that voxels low .. high (at most 8 apart) touch.
struct Patch {
  uvec4 slots_low;   // z of `low`: (x0 y0, x1 y0, x0 y1, x1 y1)
  uvec4 slots_high;  // z of `high`
};

Patch patchOf(ivec3 low, ivec3 high) {
  ivec3 a = low >> 3, b = high >> 3;
  int row = volume.table_size.x, layer = row * volume.table_size.y;
  ivec4 columns = ivec4(a.y * row + a.x, a.y * row + b.x, b.y * row + a.x, b.y * row + b.x);
  ivec4 l = columns + a.z * layer, h = columns + b.z * layer;
  return Patch(uvec4(tableEntry(l.x), tableEntry(l.y), tableEntry(l.z), tableEntry(l.w)),
               uvec4(tableEntry(h.x), tableEntry(h.y), tableEntry(h.z), tableEntry(h.w)));
}

#ifdef VOLUME_TSDF
// Values of the 8 voxels around a position.
struct Cell {
  vec4 low;   // z of `voxel`: (x0 y0, x1 y0, x0 y1, x1 y1)
  vec4 high;  // one further
  vec3 fraction;
  ivec3 voxel;
};

Cell cellAt(vec3 position) {
  vec3 corner = floor(position - 0.5);
  Cell cell;
  cell.voxel = ivec3(corner);
  cell.fraction = position - 0.5 - corner;
  ivec3 l = cell.voxel & 7, h = (cell.voxel + 1) & 7;
  Patch slots = patchOf(cell.voxel, cell.voxel + 1);
  uvec4 rows = uvec4(l.y * 8 + l.x, l.y * 8 + h.x, h.y * 8 + l.x, h.y * 8 + h.x);
  uint zl = uint(l.z * 64), zh = uint(h.z * 64);
  cell.low = vec4(tsdfInBlock(slots.slots_low.x, rows.x + zl), tsdfInBlock(slots.slots_low.y, rows.y + zl),
                  tsdfInBlock(slots.slots_low.z, rows.z + zl), tsdfInBlock(slots.slots_low.w, rows.w + zl));
  cell.high = vec4(tsdfInBlock(slots.slots_high.x, rows.x + zh), tsdfInBlock(slots.slots_high.y, rows.y + zh),
                   tsdfInBlock(slots.slots_high.z, rows.z + zh), tsdfInBlock(slots.slots_high.w, rows.w + zh));
  return cell;
}

// Trilinear interpolation: gradient in xyz, value in w.
vec4 trilinear(Cell c) {
  vec3 f = c.fraction;
  vec2 l = mix(c.low.xz, c.low.yw, f.x), h = mix(c.high.xz, c.high.yw, f.x);
  float bottom = mix(l.x, l.y, f.y), top = mix(h.x, h.y, f.y);
  vec2 dl = c.low.yw - c.low.xz, dh = c.high.yw - c.high.xz;
  return vec4(mix(mix(dl.x, dl.y, f.y), mix(dh.x, dh.y, f.y), f.z), mix(l.y - l.x, h.y - h.x, f.z), top - bottom,
              mix(bottom, top, f.z));
}

// The 27 voxels around a position, summed up in two ways. `value` is the trilinear interpolation. `gradient` is that
// of the quadratic B-spline, which, unlike the trilinear one, is continuous across cells: surfaces shade smoothly.
struct Neighbourhood {
  float value;
  vec3 gradient;
  float largest;  // size among the 27
};

Neighbourhood neighbourhoodOf(vec3 position) {
  ivec3 centre = ivec3(position);
  vec3 f = position - vec3(centre) - 0.5;
  vec3 linear[3] = vec3[3](max(-f, 0.0), 1.0 - abs(f), max(f, 0.0));
  vec3 a = 0.5 - f, b = 0.5 + f;
  vec3 spline[3] = vec3[3](0.5 * a * a, 0.75 - f * f, 0.5 * b * b);
  vec3 slope[3] = vec3[3](-a, -2.0 * f, b);

  ivec3 low = centre - 1;
  Patch slots = patchOf(low, centre + 1);
  ivec3 block = low >> 3;
  bool odd = (low.x & 1) != 0, crosses = ((low.x + 2) >> 3) != block.x;
  int word_low = (low.x & 7) >> 1, word_high = ((low.x + 2) & 7) >> 1;
  Neighbourhood sum = Neighbourhood(0.0, vec3(0.0), 0.0);
  [[unroll]] for (int k = 0; k < 3; ++k) {
    uvec4 layer = ((low.z + k) >> 3) != block.z ? slots.slots_high : slots.slots_low;
    [[unroll]] for (int j = 0; j < 3; ++j) {
      uvec2 pair = ((low.y + j) >> 3) != block.y ? layer.zw : layer.xy;
      int row = ((low.z + k) & 7) * 32 + ((low.y + j) & 7) * 4;
      // Three voxels along x lie in two words, the middle one in either.
      uint first = tsdfWordInBlock(pair.x, uint(row + word_low));
      uint second = tsdfWordInBlock(crosses ? pair.y : pair.x, uint(row + word_high));
      vec3 v = odd ? vec3(tsdfOf(first), tsdfOf(second << 16), tsdfOf(second))
                   : vec3(tsdfOf(first << 16), tsdfOf(first), tsdfOf(second << 16));
      sum.largest = max(sum.largest, max(abs(v.x), max(abs(v.y), abs(v.z))));
      float along = spline[0].x * v.x + spline[1].x * v.y + spline[2].x * v.z;
      sum.gradient += vec3((slope[0].x * v.x + slope[1].x * v.y + slope[2].x * v.z) * spline[j].y * spline[k].z,
                           along * slope[j].y * spline[k].z, along * spline[j].y * slope[k].z);
      sum.value += (linear[0].x * v.x + linear[1].x * v.y + linear[2].x * v.z) * linear[j].y * linear[k].z;
    }
  }
  return sum;
}
#endif

#ifdef VOLUME_COLOUR
float luminanceOf(uint rgb) { return dot(unpackUnorm4x8(rgb).xyz, vec3(0.299, 0.587, 0.114)); }  // Rec. 601

// The same of the voxels' luminance, from 0 (black) to 1.
struct Luminance {
  float value;
  vec3 gradient;
  bool known;  // whether all 27 have a colour
};

Luminance luminanceAt(vec3 position) {
  ivec3 centre = ivec3(position);
  vec3 f = position - vec3(centre) - 0.5;
  vec3 linear[3] = vec3[3](max(-f, 0.0), 1.0 - abs(f), max(f, 0.0));
  vec3 a = 0.5 - f, b = 0.5 + f;
  vec3 spline[3] = vec3[3](0.5 * a * a, 0.75 - f * f, 0.5 * b * b);
  vec3 slope[3] = vec3[3](-a, -2.0 * f, b);

  ivec3 low = centre - 1, block = low >> 3;
  Patch slots = patchOf(low, centre + 1);
  Luminance sum = Luminance(0.0, vec3(0.0), true);
  [[unroll]] for (int k = 0; k < 3; ++k) {
    uvec4 layer = ((low.z + k) >> 3) != block.z ? slots.slots_high : slots.slots_low;
    [[unroll]] for (int j = 0; j < 3; ++j) {
      uvec2 pair = ((low.y + j) >> 3) != block.y ? layer.zw : layer.xy;
      [[unroll]] for (int i = 0; i < 3; ++i) {
        uint slot = ((low.x + i) >> 3) != block.x ? pair.y : pair.x;
        uint word = colourWord(chunkOf(slot), slotInChunk(slot) * kBlockColourWords + localIndex(low + ivec3(i, j, k)));
        sum.known = sum.known && word >> 24 != 0u;
        float v = luminanceOf(word);
        sum.gradient += v * vec3(slope[i].x * spline[j].y * spline[k].z, spline[i].x * slope[j].y * spline[k].z,
                                 spline[i].x * spline[j].y * slope[k].z);
        sum.value += v * linear[i].x * linear[j].y * linear[k].z;
      }
    }
  }
  return sum;
}
#endif
