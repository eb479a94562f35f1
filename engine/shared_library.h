// Libraries opened while the program runs, on every operating system.
#pragma once
#include <memory>

namespace rosefusion {

/// Null when there is no such library. Closed with the last copy of the pointer.
std::shared_ptr<void> openLibrary(const char* name);

/// Null when the library has no such function.
void* functionOf(const std::shared_ptr<void>& library, const char* name);

}  // namespace rosefusion
