// Whether an image of this size, in pixels, holds the homogeneous pixel (u z, v z, z), `inside` its border in units of u z.
bool inImage(vec3 h, ivec2 size, float inside) {
  vec2 least = vec2(inside - 0.5 * h.z), limit = (vec2(size) - 0.5) * h.z - inside;
  return h.z > 0.0 && all(greaterThanEqual(h.xy, least)) && all(lessThan(h.xy, limit));
}
