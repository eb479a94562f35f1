// A unit vector in one word, within 0.004 degrees: the octahedron |x| + |y| + |z| = 1 unfolded onto a square, z < 0 in its
// corners, 16 bits a coordinate (Meyer et al. 2010, "On floating-point normal vectors").

// The lower half's corners onto the square's, and back.
vec2 foldedOver(vec2 p) { return (1.0 - abs(p.yx)) * mix(vec2(-1.0), vec2(1.0), greaterThanEqual(p, vec2(0.0))); }

// 0 for the zero vector.
uint packedDirection(vec3 v) {
  vec2 p = v.xy / max(abs(v.x) + abs(v.y) + abs(v.z), 1e-20);
  return packSnorm2x16(v.z < 0.0 ? foldedOver(p) : p);
}

vec3 unpackedDirection(uint word) {
  vec2 p = unpackSnorm2x16(word);
  float z = 1.0 - abs(p.x) - abs(p.y);
  return normalize(vec3(z < 0.0 ? foldedOver(p) : p, z));
}
