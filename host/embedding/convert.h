// Between the public headers' plain values and the types inside.
#pragma once
#include <utility>

#include "engine/error.h"
#include "host/core/error.h"
#include "host/core/frame.h"
#include "host/core/mesh.h"
#include "host/slam/pipeline.h"
#include "rosefusion/types.h"

namespace rosefusion {

Intrinsics toIntrinsics(const Camera& camera);
Pose toPose(const Matrix& matrix);
Matrix toMatrix(const Pose& pose);
glm::mat4 toShader(const Matrix& matrix);
Result toResult(const FrameResult& result);
Mesh toMesh(const TriangleMesh& mesh);

/// The frame on memory of its own. Throws Error (BadInput) for sizes other than the camera's and for a motion
/// that is no rigid transform.
Frame copyOf(const DepthFrame& frame, const Intrinsics& camera);

/// Throws the Error that stands for the exception that is being handled.
[[noreturn]] void throwPublicError();

/// Runs `work`; what it throws becomes an Error.
template <typename Work>
decltype(auto) guarded(Work&& work) {
  try {
    return std::forward<Work>(work)();
  } catch (...) {
    throwPublicError();
  }
}

}  // namespace rosefusion
