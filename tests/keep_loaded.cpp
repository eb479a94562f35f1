// Linked into every executable of the build under the address sanitizer: keeps loaded what was loaded at run
// time. Vulkan's loader unloads drivers and layers with their instance. What they hold for the life of the
// process (Mesa 22.3 a list of the processor's caches, on some AMD processors) no pointer leads to then, and
// it is reported as a leak of an "unknown module".
extern "C" __attribute__((visibility("default"))) int dlclose(void* /*library*/) {
  return 0;
}
