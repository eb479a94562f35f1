// Pools of the volume that a shader writes, beside lib/volume.glsl: tsdfWord(), settsdfWord() and their like for a NAME.
// Where texels are read, a pool has two bindings: an invocation reads a word through TEXELS, then writes it through FIRST,
// and never reads it again. No other invocation touches it.
#define WRITES_OF_POOL(NAME, FIRST)                                                       \
  layout(std430, binding = FIRST) buffer NAME##_block0 { uint NAME##_written0[]; };       \
  layout(std430, binding = FIRST + 1u) buffer NAME##_block1 { uint NAME##_written1[]; };  \
  layout(std430, binding = FIRST + 2u) buffer NAME##_block2 { uint NAME##_written2[]; };  \
  layout(std430, binding = FIRST + 3u) buffer NAME##_block3 { uint NAME##_written3[]; };  \
  void set##NAME##Word(uint chunk, uint word, uint value) {                               \
    if (kPoolChunks == 1u || chunk == 0u) NAME##_written0[word] = value;                  \
    else if (kPoolChunks == 2u || chunk == 1u) NAME##_written1[word] = value;             \
    else if (kPoolChunks == 3u || chunk == 2u) NAME##_written2[word] = value;             \
    else NAME##_written3[word] = value;                                                   \
  }
#ifdef READ_TEXELS
#define WRITTEN_POOL(NAME, FIRST, TEXELS) \
  WRITES_OF_POOL(NAME, FIRST)             \
  POOL(NAME, TEXELS)
#else
#define WRITTEN_POOL(NAME, FIRST, TEXELS)                    \
  WRITES_OF_POOL(NAME, FIRST)                                \
  uint NAME##_0(uint word) { return NAME##_written0[word]; } \
  uint NAME##_1(uint word) { return NAME##_written1[word]; } \
  uint NAME##_2(uint word) { return NAME##_written2[word]; } \
  uint NAME##_3(uint word) { return NAME##_written3[word]; } \
  POOL_WORD(NAME)
#endif
