// How a surface is drawn: a light at the camera, a soft highlight, colours in sRGB.

const vec3 kClay = vec3(0.80, 0.78, 0.74);  // of a surface without colour

vec3 backgroundColour(float down) { return mix(vec3(0.16, 0.18, 0.21), vec3(0.07, 0.08, 0.09), down); }

vec3 shadedColour(vec3 surface, vec3 normal, vec3 view) {
  float facing = max(-dot(normal, view), 0.0);
  float highlight = pow(facing, 24.0);
  return surface * (0.2 + 0.7 * facing) + 0.1 * highlight;
}
