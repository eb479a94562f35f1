#include "host/evaluation/surface_distance.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <nanoflann.hpp>
#include <stdexcept>

#include "host/core/embree.h"

namespace rosefusion {
namespace {

Eigen::Vector3d closestOnSegment(const Eigen::Vector3d& p, const Eigen::Vector3d& a,
                                 const Eigen::Vector3d& b) {
  const Eigen::Vector3d direction = b - a;
  const double length_squared = direction.squaredNorm();
  if (length_squared == 0) return a;
  return a + std::clamp((p - a).dot(direction) / length_squared, 0.0, 1.0) * direction;
}

}  // namespace

Eigen::Vector3d closestOnTriangle(const Eigen::Vector3d& p, const Eigen::Vector3d& a,
                                  const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
  const Eigen::Vector3d normal = (b - a).cross(c - a);
  const double area_squared = normal.squaredNorm();
  if (area_squared > 0) {
    const bool inside = normal.dot((b - a).cross(p - a)) >= 0 && normal.dot((c - b).cross(p - b)) >= 0 &&
                        normal.dot((a - c).cross(p - c)) >= 0;
    if (inside) return p - normal * (normal.dot(p - a) / area_squared);
  }
  Eigen::Vector3d best = closestOnSegment(p, a, b);
  for (const Eigen::Vector3d& q : {closestOnSegment(p, b, c), closestOnSegment(p, c, a)})
    if ((p - q).squaredNorm() < (p - best).squaredNorm()) best = q;
  return best;
}

struct SurfaceDistance::Search {
  virtual ~Search() = default;
  virtual double distance(const Eigen::Vector3d& point) const = 0;
};

namespace {

class TriangleSearch final : public SurfaceDistance::Search {
 public:
  explicit TriangleSearch(const TriangleMesh& mesh) : mesh_(mesh) {
    device_ = rtcNewDevice(nullptr);
    if (!device_) throw std::runtime_error("Embree cannot be started, so that no distances can be measured.");
    RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    void* vertices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                             sizeof mesh.vertices[0], mesh.vertices.size());
    void* triangles = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                              sizeof mesh.triangles[0], mesh.triangles.size());
    scene_ = rtcNewScene(device_);
    if (vertices && triangles) {
      std::copy(mesh.vertices.begin(), mesh.vertices.end(), static_cast<Eigen::Vector3f*>(vertices));
      std::copy(mesh.triangles.begin(), mesh.triangles.end(),
                static_cast<std::array<std::uint32_t, 3>*>(triangles));
      rtcCommitGeometry(geometry);
      rtcAttachGeometry(scene_, geometry);
      rtcCommitScene(scene_);
    }
    rtcReleaseGeometry(geometry);
    if (rtcGetDeviceError(device_) != RTC_ERROR_NONE) {
      release();
      throw std::runtime_error("Embree cannot build its search tree; there is probably too little memory.");
    }
  }
  ~TriangleSearch() override { release(); }
  TriangleSearch(const TriangleSearch&) = delete;
  TriangleSearch& operator=(const TriangleSearch&) = delete;

  double distance(const Eigen::Vector3d& point) const override {
    Nearest nearest{mesh_, point};
    RTCPointQuery query;
    query.x = static_cast<float>(point.x());
    query.y = static_cast<float>(point.y());
    query.z = static_cast<float>(point.z());
    query.time = 0;
    query.radius = std::numeric_limits<float>::infinity();
    RTCPointQueryContext context;
    rtcInitPointQueryContext(&context);
    rtcPointQuery(scene_, &query, &context, &visit, &nearest);
    return std::sqrt(nearest.squared);
  }

 private:
  struct Nearest {
    const TriangleMesh& mesh;
    Eigen::Vector3d point;
    double squared = std::numeric_limits<double>::infinity();
  };

  static bool visit(RTCPointQueryFunctionArguments* arguments) {
    Nearest& nearest = *static_cast<Nearest*>(arguments->userPtr);
    const auto& corners = nearest.mesh.triangles[arguments->primID];
    const auto corner = [&](int i) -> Eigen::Vector3d {
      return nearest.mesh.vertices[corners[i]].cast<double>();
    };
    const double squared =
        (closestOnTriangle(nearest.point, corner(0), corner(1), corner(2)) - nearest.point).squaredNorm();
    if (squared >= nearest.squared) return false;
    nearest.squared = squared;
    // Embree searches around the point rounded to float: a little further, so that rounding prunes nothing
    // nearer.
    arguments->query->radius =
        static_cast<float>(std::sqrt(squared) * (1 + 1e-6) + 1e-6 * nearest.point.norm());
    return true;
  }

  void release() {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }

  const TriangleMesh& mesh_;
  RTCDevice device_ = nullptr;
  RTCScene scene_ = nullptr;
};

class PointSearch final : public SurfaceDistance::Search {
 public:
  explicit PointSearch(const TriangleMesh& mesh) : mesh_(mesh), tree_(3, *this) { tree_.buildIndex(); }

  double distance(const Eigen::Vector3d& point) const override {
    std::size_t nearest = 0;
    double squared = 0;
    if (tree_.knnSearch(point.data(), 1, &nearest, &squared) == 0)
      return std::numeric_limits<double>::infinity();  // there is no surface
    return std::sqrt(squared);
  }

  // What nanoflann asks of its data.
  std::size_t kdtree_get_point_count() const { return mesh_.vertices.size(); }
  double kdtree_get_pt(std::size_t index, std::size_t axis) const {
    return mesh_.vertices[index][static_cast<Eigen::Index>(axis)];
  }
  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }

 private:
  using Metric = nanoflann::L2_Simple_Adaptor<double, PointSearch, double, std::size_t>;
  const TriangleMesh& mesh_;
  nanoflann::KDTreeSingleIndexAdaptor<Metric, PointSearch, 3, std::size_t> tree_;
};

}  // namespace

SurfaceDistance::SurfaceDistance(const TriangleMesh& mesh) {
  if (mesh.triangles.empty())
    search_ = std::make_unique<PointSearch>(mesh);
  else
    search_ = std::make_unique<TriangleSearch>(mesh);
}
SurfaceDistance::~SurfaceDistance() = default;
SurfaceDistance::SurfaceDistance(SurfaceDistance&&) noexcept = default;
SurfaceDistance& SurfaceDistance::operator=(SurfaceDistance&&) noexcept = default;

std::vector<double> SurfaceDistance::to(const std::vector<Eigen::Vector3d>& points) const {
  std::vector<double> distances;
  distances.reserve(points.size());
  for (const Eigen::Vector3d& p : points) distances.push_back(search_->distance(p));
  return distances;
}

}  // namespace rosefusion
