// What the library shows to others and what it hides, by compiler.
#pragma once

// ROSEFUSION_API marks what the library exports; everything else is hidden. On Windows the library's CMake
// target says whether it is linked shared (ROSEFUSION_SHARED), and ROSEFUSION_EXPORTS is defined while a
// shared one is compiled. ROSEFUSION_HIDDEN: an inner class that is not exported with its outer one.
#ifdef _WIN32
#if defined(ROSEFUSION_EXPORTS)
#define ROSEFUSION_API __declspec(dllexport)
#elif defined(ROSEFUSION_SHARED)
#define ROSEFUSION_API __declspec(dllimport)
#else
#define ROSEFUSION_API
#endif
#define ROSEFUSION_HIDDEN
#else
#define ROSEFUSION_API __attribute__((visibility("default")))
#define ROSEFUSION_HIDDEN __attribute__((visibility("hidden")))
#endif
