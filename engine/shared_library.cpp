#include "engine/shared_library.h"

#ifdef _WIN32
#ifndef NOMINMAX
#define NOMINMAX
#endif
#define WIN32_LEAN_AND_MEAN
#include <windows.h>
#else
#include <dlfcn.h>
#endif

namespace rosefusion {

#ifdef _WIN32

std::shared_ptr<void> openLibrary(const char* name) {
  const HMODULE library = LoadLibraryA(name);
  if (!library) return nullptr;
  return {library, [](void* opened) { FreeLibrary(static_cast<HMODULE>(opened)); }};
}

void* functionOf(const std::shared_ptr<void>& library, const char* name) {
  return reinterpret_cast<void*>(GetProcAddress(static_cast<HMODULE>(library.get()), name));
}

#else

std::shared_ptr<void> openLibrary(const char* name) {
  void* library = dlopen(name, RTLD_NOW | RTLD_LOCAL);
  if (!library) return nullptr;
  return {library, [](void* opened) { dlclose(opened); }};
}

void* functionOf(const std::shared_ptr<void>& library, const char* name) {
  return dlsym(library.get(), name);
}

#endif

}  // namespace rosefusion
