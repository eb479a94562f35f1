// Continuous versions of the stored TSDF and colour; include after lib/volume.glsl with VOLUME_TABLE and VOLUME_TSDF or
// VOLUME_COLOUR or both, and VOLUME_TSDF_QUADS or VOLUME_COLOUR_QUADS beside it: without, a cube is read word by word.
// Positions are in voxels from the table's corner, where voxel i has its centre at i + 0.5, and must stay two voxels
// inside the table. Derivatives are per voxel.

#extension GL_EXT_control_flow_attributes : require

// A 2 x 2 x 2 patch of blocks: the slots of all blocks that voxels low .. high (at most 8 apart) touch.
struct Patch {
  uvec4 slots_low;   // of the lower two layers: (x0 y0, x1 y0, x0 y1, x1 y1)
  uvec4 slots_high;  // of the upper
  ivec3 block;       // the first one's table coordinates
};

Patch patchOf(ivec3 low, ivec3 high) {
  ivec3 a = low >> 3, b = high >> 3;
  int row = volume.table_size.x, layer = row * volume.table_size.y;
  ivec4 columns = ivec4(a.y * row + a.x, a.y * row + b.x, b.y * row + a.x, b.y * row + b.x);
  ivec4 l = columns + a.z * layer, h = columns + b.z * layer;
  return Patch(uvec4(tableEntry(l.x), tableEntry(l.y), tableEntry(l.z), tableEntry(l.w)),
               uvec4(tableEntry(h.x), tableEntry(h.y), tableEntry(h.z), tableEntry(h.w)), a);
}

// Slots of what lies at (l, l), (h, l), (l, h), (h, h) of a layer; true: in the second block along that axis.
uvec4 slotsWithin(uvec4 layer, bvec2 l, bvec2 h) {
  uvec2 first = mix(layer.xy, layer.zw, bvec2(l.y)), second = mix(layer.xy, layer.zw, bvec2(h.y));
  return mix(uvec4(first.xx, second.xx), uvec4(first.yy, second.yy), bvec4(l.x, h.x, l.x, h.x));
}

#ifdef VOLUME_TSDF
// Values of the 8 voxels around a position.
struct Cell {
  vec4 low;   // (x0 y0, x1 y0, x0 y1, x1 y1)
  vec4 high;  // the same one further along z
  vec3 fraction;
};

// 4 x 4 x 4 voxels: 2 x 2 x 2 cubes of 2 x 2 x 2, x fastest.
struct Window { uvec4 cubes[8]; };

// The window whose first cube that is, counted from the table's corner. A cube beyond the patch is read from within.
Window windowIn(Patch slots, ivec3 first) {
  ivec3 next = first + 1;
  bvec3 l = notEqual(first >> 2, slots.block), h = notEqual(next >> 2, slots.block);
  uvec4 low = slotsWithin(mix(slots.slots_low, slots.slots_high, bvec4(l.z)), l.xy, h.xy);
  uvec4 high = slotsWithin(mix(slots.slots_low, slots.slots_high, bvec4(h.z)), l.xy, h.xy);
  uvec3 a = uvec3(first & 3) << uvec3(0, 2, 4), b = uvec3(next & 3) << uvec3(0, 2, 4);
  uvec4 columns = uvec4(a.y + a.x, a.y + b.x, b.y + a.x, b.y + b.x);
  uint slot[8] = uint[8](low.x, low.y, low.z, low.w, high.x, high.y, high.z, high.w);
  Window window;
  [[unroll]] for (int i = 0; i < 8; ++i) window.cubes[i] = tsdfCube(slot[i], columns[i & 3] + (i < 4 ? a.z : b.z));
  return window;
}

// Words of the window's layer k: rows 0 to 3 along y, of its first or second pair of voxels along x.
uvec4 layerOf(Window window, int k, int second) {
  int i = 4 * (k >> 1) + second;
  return mix(uvec4(window.cubes[i].xy, window.cubes[i + 2].xy), uvec4(window.cubes[i].zw, window.cubes[i + 2].zw), bvec4((k & 1) != 0));
}
uvec4 layerOf(Window window, int k, int second, bool odd) {
  return mix(layerOf(window, k, second), layerOf(window, k + 1, second), bvec4(odd));
}

// The cell of a position whose voxels lie in the patch.
Cell cellIn(Patch slots, vec3 position) {
  vec3 corner = floor(position - 0.5);
  Cell cell;
  cell.fraction = position - 0.5 - corner;
  ivec3 voxel = ivec3(corner);
  Window window = windowIn(slots, voxel >> 1);
  bvec3 odd = notEqual(voxel & 1, ivec3(0));
  vec4 layers[2];
  [[unroll]] for (int k = 0; k < 2; ++k) {
    uvec4 first = layerOf(window, k, 0, odd.z), second = layerOf(window, k, 1, odd.z);
    uvec2 a = mix(first.xy, first.yz, bvec2(odd.y)), b = mix(second.xy, second.yz, bvec2(odd.y));
    uvec4 bits = mix(uvec4(a.x << 16, a.x, a.y << 16, a.y), uvec4(a.x, b.x << 16, a.y, b.y << 16), bvec4(odd.x));
    layers[k] = vec4(tsdfOf(bits.x), tsdfOf(bits.y), tsdfOf(bits.z), tsdfOf(bits.w));
  }
  cell.low = layers[0];
  cell.high = layers[1];
  return cell;
}

// ... wherever it lies: for a single one.
Cell cellAt(vec3 position) {
  ivec3 voxel = ivec3(floor(position - 0.5));
  return cellIn(patchOf(voxel, voxel + 1), position);
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
  float largest;          // size among the 27
  float largest_in_cell;  // among the 8 of the position's cell
};

// Of a position whose 27 voxels lie in the patch.
Neighbourhood neighbourhoodIn(Patch slots, vec3 position) {
  ivec3 centre = ivec3(position);
  vec3 f = position - vec3(centre) - 0.5;
  vec3 linear[3] = vec3[3](max(-f, 0.0), 1.0 - abs(f), max(f, 0.0));
  vec3 a = 0.5 - f, b = 0.5 + f;
  vec3 spline[3] = vec3[3](0.5 * a * a, 0.75 - f * f, 0.5 * b * b);
  vec3 slope[3] = vec3[3](-a, -2.0 * f, b);

  // Which of the three belong to the cell: the middle one, and one beside it.
  bvec3 before = lessThan(f, vec3(0.0));
  bvec3 in_cell[3] = bvec3[3](before, bvec3(true), not(before));

  ivec3 low = centre - 1;
  bvec3 odd = notEqual(low & 1, ivec3(0));
  Window window = windowIn(slots, low >> 1);
  Neighbourhood sum = Neighbourhood(0.0, vec3(0.0), 0.0, 0.0);
  [[unroll]] for (int k = 0; k < 3; ++k) {
    uvec4 firsts = layerOf(window, k, 0, odd.z), seconds = layerOf(window, k, 1, odd.z);
    Neighbourhood within = Neighbourhood(0.0, vec3(0.0), 0.0, 0.0);  // this layer's; z is the value of the splines
    [[unroll]] for (int j = 0; j < 3; ++j) {
      // Three voxels along x lie in two words, the middle one in either.
      uint first = mix(firsts[j], firsts[j + 1], odd.y), second = mix(seconds[j], seconds[j + 1], odd.y);
      uvec3 bits = mix(uvec3(first << 16, first, second << 16), uvec3(first, second << 16, second), bvec3(odd.x));
      vec3 v = vec3(tsdfOf(bits.x), tsdfOf(bits.y), tsdfOf(bits.z));
      vec3 size = abs(v);
      float row_in_cell = max(size.y, mix(size.z, size.x, before.x));
      within.largest = max(within.largest, max(size.y, max(size.x, size.z)));
      within.largest_in_cell = max(within.largest_in_cell, mix(0.0, row_in_cell, in_cell[j].y));
      float along = spline[0].x * v.x + spline[1].x * v.y + spline[2].x * v.z;
      float sloping = slope[0].x * v.x + slope[1].x * v.y + slope[2].x * v.z;
      within.gradient += vec3(sloping * spline[j].y, along * slope[j].y, along * spline[j].y);
      within.value += (linear[0].x * v.x + linear[1].x * v.y + linear[2].x * v.z) * linear[j].y;
    }
    sum.largest = max(sum.largest, within.largest);
    sum.largest_in_cell = max(sum.largest_in_cell, mix(0.0, within.largest_in_cell, in_cell[k].z));
    sum.gradient += within.gradient * vec3(spline[k].z, spline[k].z, slope[k].z);
    sum.value += within.value * linear[k].z;
  }
  return sum;
}

Neighbourhood neighbourhoodOf(vec3 position) {
  ivec3 centre = ivec3(position);
  return neighbourhoodIn(patchOf(centre - 1, centre + 1), position);
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

  ivec3 low = centre - 1;
  Patch slots = patchOf(low, centre + 1);
  ivec3 first = low >> 1, next = first + 1;
  bvec3 odd = notEqual(low & 1, ivec3(0));
  bvec2 l = notEqual(first.xy >> 2, slots.block.xy), h = notEqual(next.xy >> 2, slots.block.xy);
  uvec2 x = uvec2(first.x & 3, next.x & 3) << 1, y = uvec2(first.y & 3, next.y & 3) << 3;
  Luminance sum = Luminance(0.0, vec3(0.0), true);
  [[unroll]] for (int k = 0; k < 3; ++k) {
    int z = low.z + k;
    uvec4 layer = slotsWithin(mix(slots.slots_low, slots.slots_high, bvec4((z >> 3) != slots.block.z)), l, h);
    uint quad = uint((z & 6) << 4 | (z & 1));
    uvec4 quads[4];
    [[unroll]] for (int i = 0; i < 4; ++i) quads[i] = colourQuadInBlock(layer[i], quad + y[i >> 1] + x[i & 1]);
    uvec4 rows[4] = uvec4[4](uvec4(quads[0].xy, quads[1].xy), uvec4(quads[0].zw, quads[1].zw), uvec4(quads[2].xy, quads[3].xy),
                             uvec4(quads[2].zw, quads[3].zw));
    Luminance within = Luminance(0.0, vec3(0.0), true);  // this layer's; z is the value of the splines
    uint fewest = 0xFFu;  // images that gave a voxel its colour
    [[unroll]] for (int j = 0; j < 3; ++j) {
      uvec4 row = mix(rows[j], rows[j + 1], bvec4(odd.y));
      float along = 0.0, sloping = 0.0, value = 0.0;
      [[unroll]] for (int i = 0; i < 3; ++i) {
        uint word = mix(row[i], row[i + 1], odd.x);
        fewest = min(fewest, word >> 24);
        float v = luminanceOf(word);
        along += spline[i].x * v;
        sloping += slope[i].x * v;
        value += linear[i].x * v;
      }
      within.gradient += vec3(sloping * spline[j].y, along * slope[j].y, along * spline[j].y);
      within.value += value * linear[j].y;
    }
    sum.known = sum.known && fewest > 0u;
    sum.gradient += within.gradient * vec3(spline[k].z, spline[k].z, slope[k].z);
    sum.value += within.value * linear[k].z;
  }
  return sum;
}
#endif
