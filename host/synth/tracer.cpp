#include "host/synth/tracer.h"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "host/core/embree.h"

namespace rosefusion {
namespace {

constexpr float kNearest = 1e-4f;  // a ray that starts on a surface does not hit it

/// Closest point of triangle abc to p (Ericson, Real-Time Collision Detection, 5.1.5: Voronoi regions).
Eigen::Vector3f closestPoint(const Eigen::Vector3f& p, const Eigen::Vector3f& a, const Eigen::Vector3f& b,
                             const Eigen::Vector3f& c) {
  const Eigen::Vector3f ab = b - a, ac = c - a, ap = p - a, bp = p - b, cp = p - c;
  const float d1 = ab.dot(ap), d2 = ac.dot(ap), d3 = ab.dot(bp), d4 = ac.dot(bp), d5 = ab.dot(cp),
              d6 = ac.dot(cp);
  if (d1 <= 0 && d2 <= 0) return a;
  if (d3 >= 0 && d4 <= d3) return b;
  if (d6 >= 0 && d5 <= d6) return c;
  const float vc = d1 * d4 - d3 * d2, vb = d5 * d2 - d1 * d6, va = d3 * d6 - d5 * d4;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return a + ab * (d1 / (d1 - d3));
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return a + ac * (d2 / (d2 - d6));
  if (va <= 0 && d4 >= d3 && d5 >= d6) return b + (c - b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6)));
  const float sum = va + vb + vc;
  return sum > 0 ? Eigen::Vector3f(a + ab * (vb / sum) + ac * (vc / sum)) : a;
}

struct DistanceQuery {
  const TriangleMesh* mesh;
  float nearest;
};

bool considerTriangle(RTCPointQueryFunctionArguments* arguments) {
  auto& query = *static_cast<DistanceQuery*>(arguments->userPtr);
  const auto& t = query.mesh->triangles[arguments->primID];
  const auto& v = query.mesh->vertices;
  const Eigen::Vector3f p(arguments->query->x, arguments->query->y, arguments->query->z);
  const float distance = (closestPoint(p, v[t[0]], v[t[1]], v[t[2]]) - p).norm();
  if (distance >= query.nearest) return false;
  query.nearest = distance;
  arguments->query->radius = distance;
  return true;
}

}  // namespace

struct Tracer::Embree {
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
  ~Embree() {
    if (scene) rtcReleaseScene(scene);
    if (device) rtcReleaseDevice(device);
  }
};

Tracer::Tracer(const Scene& scene) : scene_(scene), embree_(std::make_unique<Embree>()) {
  embree_->device = rtcNewDevice(nullptr);
  if (!embree_->device) throw std::runtime_error("Embree found no usable processor features.");
  embree_->scene = rtcNewScene(embree_->device);
  rtcSetSceneFlags(embree_->scene, RTC_SCENE_FLAG_ROBUST);
  rtcSetSceneBuildQuality(embree_->scene, RTC_BUILD_QUALITY_HIGH);
  RTCGeometry geometry = rtcNewGeometry(embree_->device, RTC_GEOMETRY_TYPE_TRIANGLE);
  const TriangleMesh& mesh = scene.mesh;
  void* vertices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12,
                                           mesh.vertices.size());
  void* triangles = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12,
                                            mesh.triangles.size());
  if (!vertices || !triangles) throw std::runtime_error("Embree: out of memory.");
  std::copy_n(mesh.vertices.data()->data(), mesh.vertices.size() * 3, static_cast<float*>(vertices));
  std::copy_n(mesh.triangles.data()->data(), mesh.triangles.size() * 3,
              static_cast<std::uint32_t*>(triangles));
  rtcSetGeometryPointQueryFunction(geometry, considerTriangle);
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(embree_->scene, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(embree_->scene);
  if (const RTCError error = rtcGetDeviceError(embree_->device); error != RTC_ERROR_NONE)
    throw std::runtime_error("Embree could not build the scene (error " + std::to_string(error) + ").");
}

Tracer::~Tracer() = default;

std::optional<Tracer::Hit> Tracer::cast(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
                                        double longest) const {
  RTCRayHit query{};
  const Eigen::Vector3f o = origin.cast<float>(), d = direction.cast<float>();
  query.ray = {o.x(),       o.y(), o.z(), kNearest, d.x(), d.y(), d.z(), 0, static_cast<float>(longest),
               0xFFFFFFFFu, 0,     0};
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  intersect(embree_->scene, query);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
  Eigen::Vector3d normal = Eigen::Vector3d(query.hit.Ng_x, query.hit.Ng_y, query.hit.Ng_z).normalized();
  if (normal.dot(direction) > 0) normal = -normal;
  return Hit{query.ray.tfar, normal, query.hit.primID, query.hit.u, query.hit.v};
}

void Tracer::cast4(const Eigen::Vector3d& origin, const Eigen::Matrix<double, 3, 4>& directions,
                   double longest, Hit hits[4]) const {
  RTCRayHit4 query{};
  alignas(16) const int valid[4] = {-1, -1, -1, -1};
  for (int i = 0; i < 4; ++i) {
    query.ray.org_x[i] = static_cast<float>(origin.x());
    query.ray.org_y[i] = static_cast<float>(origin.y());
    query.ray.org_z[i] = static_cast<float>(origin.z());
    query.ray.dir_x[i] = static_cast<float>(directions(0, i));
    query.ray.dir_y[i] = static_cast<float>(directions(1, i));
    query.ray.dir_z[i] = static_cast<float>(directions(2, i));
    query.ray.tnear[i] = kNearest;
    query.ray.tfar[i] = static_cast<float>(longest);
    query.ray.mask[i] = 0xFFFFFFFFu;
    query.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
  }
  intersectCoherent(embree_->scene, valid, query);
  for (int i = 0; i < 4; ++i) {
    const bool hit = query.hit.geomID[i] != RTC_INVALID_GEOMETRY_ID;
    Eigen::Vector3d normal =
        Eigen::Vector3d(query.hit.Ng_x[i], query.hit.Ng_y[i], query.hit.Ng_z[i]).normalized();
    if (normal.dot(directions.col(i)) > 0) normal = -normal;
    hits[i] = {query.ray.tfar[i], normal, hit ? query.hit.primID[i] : kNone, query.hit.u[i], query.hit.v[i]};
  }
}

double Tracer::clearance(const Eigen::Vector3d& point, double cap) const {
  RTCPointQueryContext context;
  rtcInitPointQueryContext(&context);
  DistanceQuery result{&scene_.mesh, static_cast<float>(cap)};
  RTCPointQuery query{static_cast<float>(point.x()), static_cast<float>(point.y()),
                      static_cast<float>(point.z()), 0, static_cast<float>(cap)};
  rtcPointQuery(embree_->scene, &query, &context, nullptr, &result);
  return result.nearest < static_cast<float>(cap) ? result.nearest : cap;
}

}  // namespace rosefusion
