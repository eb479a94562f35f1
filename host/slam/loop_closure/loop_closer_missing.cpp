// In place of loop_closer.cpp where Ceres or zstd is missing.
#include "host/core/error.h"
#include "host/slam/loop_closure/loop_closer.h"

namespace rosefusion {

std::unique_ptr<LoopCloser> makeLoopCloser(Device&, const Settings&, const Intrinsics&, double,
                                           const TemplateSet&) {
  throw InputError(
      "loops.enabled: this program was built without loop closure; install libceres-dev and libzstd-dev and "
      "build it again with ROSEFUSION_LOOPS, or leave the setting off.");
}

}  // namespace rosefusion
