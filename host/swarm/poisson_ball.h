// Poisson-disk sampling of the unit ball in six dimensions.
#pragma once
#include <vector>

#include "host/swarm/random.h"

namespace rosefusion {

/// Points of the closed unit ball of R^6, no two closer than `radius`, the first exactly the origin; as many
/// as Bridson's algorithm finds when it gives up on a point after `candidates` tries ("Fast Poisson Disk
/// Sampling in Arbitrary Dimensions", SIGGRAPH 2007 sketches). In the order in which they were found.
std::vector<Point6> poissonBall(double radius, int candidates, PortableRandom& random);

}  // namespace rosefusion
