#include "host/embedding/convert.h"

#include "host/slam/shader_types.h"

namespace rosefusion {
namespace {

Error::Kind kindOf(DeviceErrorCode code) {
  switch (code) {
    case DeviceErrorCode::NoDriver:
    case DeviceErrorCode::NoDevice:
      return Error::Kind::NoDevice;
    case DeviceErrorCode::MissingLimit:
      return Error::Kind::MissingLimit;
    case DeviceErrorCode::OutOfMemory:
      return Error::Kind::OutOfMemory;
    case DeviceErrorCode::DeviceLost:
      return Error::Kind::DeviceLost;
    case DeviceErrorCode::Programming:
      break;
  }
  return Error::Kind::Misuse;
}

}  // namespace

Error::Error(Kind kind, const std::string& sentence) : std::runtime_error(sentence), kind_(kind) {}
Error::~Error() = default;

void throwPublicError() {
  try {
    throw;
  } catch (const Error&) {
    throw;
  } catch (const DeviceError& error) {
    throw Error(kindOf(error.code()), error.what());
  } catch (const InputError& error) {
    throw Error(Error::Kind::BadInput, error.what());
  } catch (const std::bad_alloc&) {
    throw Error(Error::Kind::OutOfMemory, "The host's memory is exhausted; make volume.voxel_size larger.");
  }
}

Intrinsics toIntrinsics(const Camera& camera) {
  const Intrinsics out{camera.width, camera.height, camera.fx, camera.fy, camera.cx, camera.cy};
  requirePlausible(out, "The camera handed over");
  return out;
}

Pose toPose(const Matrix& matrix) {
  Pose pose;
  pose.matrix() = Eigen::Map<const Eigen::Matrix4d>(matrix.data());
  const Eigen::Matrix3d square = pose.linear() * pose.linear().transpose();
  const Eigen::RowVector4d last = pose.matrix().row(3);
  if (!(square - Eigen::Matrix3d::Identity()).isZero(1e-4) || !(pose.linear().determinant() > 0) ||
      !pose.translation().allFinite() || last != Eigen::RowVector4d(0, 0, 0, 1))
    throw Error(Error::Kind::BadInput,
                "A pose handed over is no rigid transform (rotation and translation, column by column); "
                "check its order of elements.");
  return pose;
}

Matrix toMatrix(const Pose& pose) {
  Matrix matrix;
  Eigen::Map<Eigen::Matrix4d>(matrix.data()) = pose.matrix();
  return matrix;
}

glm::mat4 toShader(const Matrix& matrix) {
  return toShader(toPose(matrix));
}

Result toResult(const FrameResult& result) {
  Result out;
  out.timestamp = result.timestamp;
  out.world_from_camera = toMatrix(result.world_from_camera);
  out.status = result.status == TrackingStatus::Tracked       ? Status::Tracked
               : result.status == TrackingStatus::Uncertain   ? Status::Uncertain
               : result.status == TrackingStatus::Relocalised ? Status::Relocalised
                                                              : Status::Lost;
  out.reason = toString(result.reason);
  out.residual = result.score.residual;
  out.overlap = result.score.overlap;
  if (result.fit && result.status != TrackingStatus::Lost)
    Eigen::Map<Eigen::Matrix<double, 6, 6>>(out.covariance.data()) = result.fit->covariance;  // symmetric
  out.milliseconds = result.milliseconds.total;
  out.began_anew = result.began_anew;
  return out;
}

Mesh toMesh(const TriangleMesh& mesh) {
  Mesh out;
  const auto copy = [](const std::vector<Eigen::Vector3f>& from, std::vector<std::array<float, 3>>& to) {
    to.reserve(from.size());
    for (const Eigen::Vector3f& v : from) to.push_back({v.x(), v.y(), v.z()});
  };
  copy(mesh.vertices, out.vertices);
  copy(mesh.normals, out.normals);
  out.colours = mesh.colours;
  out.triangles = mesh.triangles;
  return out;
}

Frame copyOf(const DepthFrame& frame, const Intrinsics& camera) {
  const auto pixels = static_cast<std::size_t>(camera.width) * camera.height;
  if (frame.depth.size() != pixels || (!frame.rgb.empty() && frame.rgb.size() != 3 * pixels))
    throw Error(Error::Kind::BadInput,
                "A frame must have " + std::to_string(camera.width) + " x " + std::to_string(camera.height) +
                    " depths, and three bytes of colour for each or none, as the camera was described.");
  Frame out;
  out.timestamp = frame.timestamp;
  out.depth = cv::Mat(camera.height, camera.width, CV_16UC1);
  std::copy(frame.depth.begin(), frame.depth.end(), out.depth.begin<std::uint16_t>());
  if (frame.motion) {
    out.motion = CameraMotion{toPose(frame.motion->last_camera_from_camera), frame.motion->has_translation};
  }
  if (frame.rgb.empty()) return out;
  out.colour = cv::Mat(camera.height, camera.width, CV_8UC3);
  for (std::size_t i = 0; i < pixels; ++i)
    out.colour.ptr<cv::Vec3b>()[i] = {frame.rgb[3 * i + 2], frame.rgb[3 * i + 1], frame.rgb[3 * i]};
  return out;
}

}  // namespace rosefusion
