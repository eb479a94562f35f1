// Large triangles cut into small ones.
#pragma once
#include "host/core/mesh.h"

namespace rosefusion {

/// Bisects every edge longer than `longest` metres; neighbours share the new vertices, so that a closed
/// surface stays closed. Normals and colours are halfway between those of the edge's ends.
void splitLongEdges(TriangleMesh& mesh, float longest);

}  // namespace rosefusion
