// Whether an image of this size, in pixels, holds the homogeneous pixel (u z, v z, z).
bool inImage(vec3 h, ivec2 size) {
  vec2 limit = (vec2(size) - 0.5) * h.z;
  return h.z > 0.0 && h.x >= -0.5 * h.z && h.y >= -0.5 * h.z && h.x < limit.x && h.y < limit.y;
}
