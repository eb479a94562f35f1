// Rays and distances against a scene, through Embree.
#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <optional>

#include "host/core/camera.h"
#include "host/synth/scene.h"

namespace rosefusion {

/// Immutable after construction, so that any number of threads may ask. The scene must outlive it.
class Tracer {
 public:
  struct Hit {
    double distance;         ///< in units of the direction's length
    Eigen::Vector3d normal;  ///< unit, facing the ray's origin
    std::uint32_t triangle;
    float u, v;  ///< barycentric weights of the triangle's second and third vertex
  };

  explicit Tracer(const Scene& scene);
  ~Tracer();
  Tracer(const Tracer&) = delete;
  Tracer& operator=(const Tracer&) = delete;

  const Scene& scene() const { return scene_; }

  /// Nearest surface along the ray, at most `longest` direction lengths away.
  std::optional<Hit> cast(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
                          double longest) const;

  /// Four rays from one origin; directions are (columns of) a 3x4 matrix. Misses have triangle = kNone.
  static constexpr std::uint32_t kNone = 0xFFFFFFFFu;
  void cast4(const Eigen::Vector3d& origin, const Eigen::Matrix<double, 3, 4>& directions, double longest,
             Hit hits[4]) const;

  /// Distance to the nearest surface, metres, at most `cap`.
  double clearance(const Eigen::Vector3d& point, double cap) const;

 private:
  struct Embree;
  const Scene& scene_;
  std::unique_ptr<Embree> embree_;
};

}  // namespace rosefusion
