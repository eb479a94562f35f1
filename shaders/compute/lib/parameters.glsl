// What is the same for all invocations of a dispatch: push constants as `params`, a uniform buffer with one struct as NAME.
// Both are copied where main() begins: there all lanes are active, and llvmpipe reads a value once for all of them; inside
// a condition or after a return it reads lane by lane.
#ifndef ROSEFUSION_PARAMETERS
#define ROSEFUSION_PARAMETERS
#define PUSHED_PARAMETERS(TYPE)                         \
  layout(push_constant) uniform Push { TYPE pushed; };  \
  TYPE params = pushed;
#define UNIFORM_PARAMETERS(TYPE, NAME, BINDING)                       \
  layout(binding = BINDING) uniform NAME##_block { TYPE NAME##_read; }; \
  TYPE NAME = NAME##_read;
#endif
