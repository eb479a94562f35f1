// What the native loops share: a fixed number of lanes, code for each instruction set, and threads.
#pragma once
#include <atomic>
#include <cstdint>
#include <string>
#include <thread>
#include <vector>

namespace rosefusion {

inline constexpr int kLanes = 16;  // one AVX-512 register, two of AVX2

enum class InstructionSet { Plain, Avx2, Avx512 };
/// The best that this machine has of those that the loops are compiled for.
InstructionSet instructionSet();
/// The same in words.
std::string nativeInstructionSet();

/// Calls work(i) for each i below `pieces`; `threads` threads, this one included, take them in turn.
template <typename Work>
void inParallel(std::uint32_t pieces, int threads, const Work& work) {
  std::atomic<std::uint32_t> next = 0;
  const auto take = [&] {
    for (std::uint32_t i = next++; i < pieces; i = next++) work(i);
  };
  std::vector<std::jthread> others;
  for (int i = 1; i < threads; ++i) others.emplace_back(take);
  take();
}

// What a kernel is made of: only what is inlined into it is compiled for its instruction set.
#define ROSEFUSION_INLINE [[gnu::always_inline]] inline

// Before a loop over lanes or cells, whose turns are independent and have no branch, so that it becomes
// vector code; and before loops of a few turns inside of it.
#ifdef __clang__
#define ROSEFUSION_LANES _Pragma("clang loop vectorize(assume_safety)")
#define ROSEFUSION_UNROLL _Pragma("clang loop unroll(full)")
#else
#define ROSEFUSION_LANES _Pragma("GCC ivdep")
#define ROSEFUSION_UNROLL _Pragma("GCC unroll 16")
#endif

#ifdef __clang__  // knows no preference of a width in an attribute
#define ROSEFUSION_WIDTH
#else
#define ROSEFUSION_WIDTH ",prefer-vector-width=512"
#endif
#define ROSEFUSION_VARIANT(NAME, KERNEL, ATTRIBUTES) \
  template <typename... Arguments>                   \
  ATTRIBUTES void NAME(Arguments&... arguments) {    \
    KERNEL(arguments...);                            \
  }
// NAME(arguments...) calls KERNEL, a ROSEFUSION_INLINE function, compiled for the machine that it runs on.
#ifdef __x86_64__
#define ROSEFUSION_NATIVE(NAME, KERNEL)                                                                  \
  ROSEFUSION_VARIANT(NAME##Plain, KERNEL, )                                                              \
  ROSEFUSION_VARIANT(NAME##Avx2, KERNEL, __attribute__((target("avx2,fma"))))                            \
  ROSEFUSION_VARIANT(NAME##Avx512, KERNEL,                                                               \
                     __attribute__((target("avx512f,avx512dq,avx512vl,avx512bw,fma" ROSEFUSION_WIDTH)))) \
  template <typename... Arguments>                                                                       \
  void NAME(Arguments&&... arguments) {                                                                  \
    switch (instructionSet()) {                                                                          \
      case InstructionSet::Avx512:                                                                       \
        return NAME##Avx512(arguments...);                                                               \
      case InstructionSet::Avx2:                                                                         \
        return NAME##Avx2(arguments...);                                                                 \
      default:                                                                                           \
        return NAME##Plain(arguments...);                                                                \
    }                                                                                                    \
  }
#else
#define ROSEFUSION_NATIVE(NAME, KERNEL) \
  template <typename... Arguments>      \
  void NAME(Arguments&&... arguments) { \
    KERNEL(arguments...);               \
  }
#endif

}  // namespace rosefusion
