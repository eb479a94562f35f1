// A pool of the volume that a shader writes too, beside lib/volume.glsl: WRITTEN_POOL declares its buffers and SET(chunk,
// word, value), then READ_WRITTEN_POOL its NAME_0(word) to NAME_3(word) for a CHUNK_FUNCTION.
// Where texels are read, a pool has two bindings: an invocation reads a word through TEXELS, then writes it through FIRST,
// and never reads it again. No other invocation touches it.
#define WRITTEN_POOL(SET, NAME, FIRST)                                                    \
  layout(std430, binding = FIRST) buffer NAME##_0_block { uint NAME##_written0[]; };      \
  layout(std430, binding = FIRST + 1u) buffer NAME##_1_block { uint NAME##_written1[]; }; \
  layout(std430, binding = FIRST + 2u) buffer NAME##_2_block { uint NAME##_written2[]; }; \
  layout(std430, binding = FIRST + 3u) buffer NAME##_3_block { uint NAME##_written3[]; }; \
  void SET(uint chunk, uint word, uint value) {                                           \
    if (kPoolChunks == 1u || chunk == 0u) NAME##_written0[word] = value;                  \
    else if (kPoolChunks == 2u || chunk == 1u) NAME##_written1[word] = value;             \
    else if (kPoolChunks == 3u || chunk == 2u) NAME##_written2[word] = value;             \
    else NAME##_written3[word] = value;                                                   \
  }
#ifdef READ_TEXELS
#define READ_WRITTEN_POOL(NAME, TEXELS) \
  READ_WORDS(NAME##_0, TEXELS)          \
  READ_WORDS(NAME##_1, TEXELS + 1u)     \
  READ_WORDS(NAME##_2, TEXELS + 2u)     \
  READ_WORDS(NAME##_3, TEXELS + 3u)
#else
#define READ_WRITTEN_POOL(NAME, TEXELS)                      \
  uint NAME##_0(uint word) { return NAME##_written0[word]; } \
  uint NAME##_1(uint word) { return NAME##_written1[word]; } \
  uint NAME##_2(uint word) { return NAME##_written2[word]; } \
  uint NAME##_3(uint word) { return NAME##_written3[word]; }
#endif
