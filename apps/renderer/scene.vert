#version 450
layout(push_constant) uniform Push { mat4 clip_from_world; };
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 colour;
layout(location = 0) out vec3 shade;
void main() {
  gl_Position = clip_from_world * vec4(position, 1.0);
  shade = colour;
}
