// Which view each triangle has its texture from.
#pragma once
#include <cstdint>
#include <vector>

#include "host/export/texture/visibility.h"

namespace rosefusion {

inline constexpr int kNoView = -1;

/// Collects what views see of a mesh, and forgets what is far worse than the best.
class ViewQualities {
 public:
  explicit ViewQualities(std::size_t triangles) : best_(triangles, 0) {}
  /// The next view's.
  void add(std::vector<SeenTriangle> seen);

  const std::vector<float>& best() const { return best_; }  ///< by triangle; 0: no view sees it
  /// By view, ascending in the triangle.
  const std::vector<std::vector<SeenTriangle>>& views() const { return views_; }
  void forgetTheWorst();

 private:
  std::vector<float> best_;
  std::vector<std::vector<SeenTriangle>> views_;
};

/// By triangle the view, or kNoView. As few views as see every triangle nearly as well as the best, and then
/// as few seams as are worth what is lost in sharpness.
std::vector<int> chooseLabels(const TriangleMesh& mesh, const ViewQualities& qualities);

/// By triangle those across its three edges, or kNoTriangle.
inline constexpr std::uint32_t kNoTriangle = 0xFFFFFFFFu;
std::vector<std::array<std::uint32_t, 3>> neighboursOf(const TriangleMesh& mesh);

/// Parts of equal label that hang together by edges: the triangles of each.
std::vector<std::vector<std::uint32_t>> partsOf(const std::vector<int>& labels,
                                                const std::vector<std::array<std::uint32_t, 3>>& neighbours);

}  // namespace rosefusion
