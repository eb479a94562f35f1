// Images whose rows were exposed one after the other, as a camera would have seen them that took all rows
// when the middle one was.
#pragma once
#include "host/core/frame.h"

namespace rosefusion {

/// `frame` with depth and colour where the pixels would have been, each depth changed by the way to there; 0
/// and black where nothing was seen. `readout`: seconds from the first row's exposure to the last's, negative
/// from the bottom up. `motion`: of the camera per second, in its own frame. Images of another size or
/// type stay as they are. Any thread.
Frame withoutRollingShutter(const Frame& frame, const Intrinsics& intrinsics, double depth_units_per_metre,
                            double readout, const Velocity& motion);

}  // namespace rosefusion
