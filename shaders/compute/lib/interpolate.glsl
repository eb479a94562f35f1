// Continuous versions of the stored TSDF and colour; include after lib/volume.glsl with VOLUME_TABLE and VOLUME_TSDF or
// VOLUME_COLOUR or both.
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

#ifdef VOLUME_TSDF
// Values of the 8 voxels around a position.
struct Cell {
  vec4 low;   // z of `voxel`: (x0 y0, x1 y0, x0 y1, x1 y1)
  vec4 high;  // one further
  vec3 fraction;
  ivec3 voxel;
};

// Slots of the voxels (l, l), (h, l), (l, h), (h, h) of a layer; true: in the second block along that axis.
uvec4 slotsWithin(uvec4 layer, bvec3 l, bvec3 h) {
  uvec2 first = l.y ? layer.zw : layer.xy, second = h.y ? layer.zw : layer.xy;
  return uvec4(l.x ? first.y : first.x, h.x ? first.y : first.x, l.x ? second.y : second.x, h.x ? second.y : second.x);
}

// The cell of a position whose voxels lie in the patch.
Cell cellIn(Patch slots, vec3 position) {
  vec3 corner = floor(position - 0.5);
  Cell cell;
  cell.voxel = ivec3(corner);
  cell.fraction = position - 0.5 - corner;
  ivec3 l = cell.voxel & 7, h = (cell.voxel + 1) & 7;
  bvec3 l_next = notEqual(cell.voxel >> 3, slots.block), h_next = notEqual((cell.voxel + 1) >> 3, slots.block);
  uvec4 low = slotsWithin(l_next.z ? slots.slots_high : slots.slots_low, l_next, h_next);
  uvec4 high = slotsWithin(h_next.z ? slots.slots_high : slots.slots_low, l_next, h_next);
  uvec4 rows = uvec4(l.y * 8 + l.x, l.y * 8 + h.x, h.y * 8 + l.x, h.y * 8 + h.x);
  uint zl = uint(l.z * 64), zh = uint(h.z * 64);
  cell.low = vec4(tsdfInBlock(low.x, rows.x + zl), tsdfInBlock(low.y, rows.y + zl), tsdfInBlock(low.z, rows.z + zl),
                  tsdfInBlock(low.w, rows.w + zl));
  cell.high = vec4(tsdfInBlock(high.x, rows.x + zh), tsdfInBlock(high.y, rows.y + zh), tsdfInBlock(high.z, rows.z + zh),
                   tsdfInBlock(high.w, rows.w + zh));
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
  bool odd = (low.x & 1) != 0;
  bool first_next = (low.x >> 3) != slots.block.x, second_next = ((low.x + 2) >> 3) != slots.block.x;
  int word_low = (low.x & 7) >> 1, word_high = ((low.x + 2) & 7) >> 1;
  Neighbourhood sum = Neighbourhood(0.0, vec3(0.0), 0.0, 0.0);
  [[unroll]] for (int k = 0; k < 3; ++k) {
    uvec4 layer = ((low.z + k) >> 3) != slots.block.z ? slots.slots_high : slots.slots_low;
    Neighbourhood within = Neighbourhood(0.0, vec3(0.0), 0.0, 0.0);  // this layer's; z is the value of the splines
    [[unroll]] for (int j = 0; j < 3; ++j) {
      uvec2 pair = ((low.y + j) >> 3) != slots.block.y ? layer.zw : layer.xy;
      int row = ((low.z + k) & 7) * 32 + ((low.y + j) & 7) * 4;
      // Three voxels along x lie in two words, the middle one in either.
      uint first = tsdfWordInBlock(first_next ? pair.y : pair.x, uint(row + word_low));
      uint second = tsdfWordInBlock(second_next ? pair.y : pair.x, uint(row + word_high));
      vec3 v = odd ? vec3(tsdfOf(first), tsdfOf(second << 16), tsdfOf(second))
                   : vec3(tsdfOf(first << 16), tsdfOf(first), tsdfOf(second << 16));
      vec3 size = abs(v);
      float row_in_cell = max(size.y, before.x ? size.x : size.z);
      within.largest = max(within.largest, max(size.y, max(size.x, size.z)));
      within.largest_in_cell = max(within.largest_in_cell, in_cell[j].y ? row_in_cell : 0.0);
      float along = spline[0].x * v.x + spline[1].x * v.y + spline[2].x * v.z;
      float sloping = slope[0].x * v.x + slope[1].x * v.y + slope[2].x * v.z;
      within.gradient += vec3(sloping * spline[j].y, along * slope[j].y, along * spline[j].y);
      within.value += (linear[0].x * v.x + linear[1].x * v.y + linear[2].x * v.z) * linear[j].y;
    }
    sum.largest = max(sum.largest, within.largest);
    sum.largest_in_cell = max(sum.largest_in_cell, in_cell[k].z ? within.largest_in_cell : 0.0);
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
  Luminance sum = Luminance(0.0, vec3(0.0), true);
  [[unroll]] for (int k = 0; k < 3; ++k) {
    uvec4 layer = ((low.z + k) >> 3) != slots.block.z ? slots.slots_high : slots.slots_low;
    Luminance within = Luminance(0.0, vec3(0.0), true);  // this layer's; z is the value of the splines
    [[unroll]] for (int j = 0; j < 3; ++j) {
      uvec2 pair = ((low.y + j) >> 3) != slots.block.y ? layer.zw : layer.xy;
      float along = 0.0, sloping = 0.0, value = 0.0;
      [[unroll]] for (int i = 0; i < 3; ++i) {
        uint slot = ((low.x + i) >> 3) != slots.block.x ? pair.y : pair.x;
        uint word = colourWord(chunkOf(slot), slotInChunk(slot) * kBlockColourWords + localIndex(low + ivec3(i, j, k)));
        within.known = within.known && word >> 24 != 0u;
        float v = luminanceOf(word);
        along += spline[i].x * v;
        sloping += slope[i].x * v;
        value += linear[i].x * v;
      }
      within.gradient += vec3(sloping * spline[j].y, along * slope[j].y, along * spline[j].y);
      within.value += value * linear[j].y;
    }
    sum.known = sum.known && within.known;
    sum.gradient += within.gradient * vec3(spline[k].z, spline[k].z, slope[k].z);
    sum.value += within.value * linear[k].z;
  }
  return sum;
}
#endif
