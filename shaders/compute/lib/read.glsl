// Buffers that a shader only reads, each behind a function NAME(i): READ_WORDS, READ_FLOATS and READ_VECTORS (of four
// floats) declare one; READ_QUADS declares words that NAMEQuad(i) reads four at a time. With READ_TEXELS they are texel
// buffers: llvmpipe gathers texels for all lanes at once, where it loads from a storage buffer lane by lane and puts the
// vector together in memory. They have no samplers, which validation from 2025 on warns of.
#ifndef ROSEFUSION_READ
#define ROSEFUSION_READ
#ifdef READ_TEXELS
#extension GL_EXT_samplerless_texture_functions : require
#define READ_WORDS(NAME, BINDING)                                \
  layout(binding = BINDING) uniform utextureBuffer NAME##_read;  \
  uint NAME(uint i) { return texelFetch(NAME##_read, int(i)).x; }
#define READ_FLOATS(NAME, BINDING)                               \
  layout(binding = BINDING) uniform utextureBuffer NAME##_read;  \
  float NAME(uint i) { return uintBitsToFloat(texelFetch(NAME##_read, int(i)).x); }
#define READ_VECTORS(NAME, BINDING)                              \
  layout(binding = BINDING) uniform textureBuffer NAME##_read;   \
  vec4 NAME(uint i) { return texelFetch(NAME##_read, int(i)); }
#define READ_QUADS(NAME, BINDING)                                                            \
  layout(binding = BINDING) uniform textureBuffer NAME##_read;                               \
  uvec4 NAME##Quad(uint i) { return floatBitsToUint(texelFetch(NAME##_read, int(i))); }      \
  uint NAME(uint i) {                                                                        \
    uvec4 quad = NAME##Quad(i >> 2);                                                         \
    uvec2 pair = (i & 2u) != 0u ? quad.zw : quad.xy;                                         \
    return (i & 1u) != 0u ? pair.y : pair.x;                                                 \
  }
#else
#define READ_WORDS(NAME, BINDING)                                                                   \
  layout(std430, binding = BINDING) readonly restrict buffer NAME##_block { uint NAME##_read[]; };  \
  uint NAME(uint i) { return NAME##_read[i]; }
#define READ_FLOATS(NAME, BINDING)                                                                   \
  layout(std430, binding = BINDING) readonly restrict buffer NAME##_block { float NAME##_read[]; };  \
  float NAME(uint i) { return NAME##_read[i]; }
#define READ_VECTORS(NAME, BINDING)                                                                 \
  layout(std430, binding = BINDING) readonly restrict buffer NAME##_block { vec4 NAME##_read[]; };  \
  vec4 NAME(uint i) { return NAME##_read[i]; }
#define READ_QUADS(NAME, BINDING)                                                                   \
  layout(std430, binding = BINDING) readonly restrict buffer NAME##_block { uvec4 NAME##_read[]; };  \
  uvec4 NAME##Quad(uint i) { return NAME##_read[i]; }                                               \
  uint NAME(uint i) { return NAME##_read[i >> 2][i & 3u]; }
#endif
#endif
