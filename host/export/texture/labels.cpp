#include "host/export/texture/labels.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <queue>

namespace rosefusion {
namespace {

constexpr float kWorst = 0.4f;     // of the best quality, below which a view is not considered
constexpr float kNearBest = 0.7f;  // of the best quality, above which a view is as good
/// Pixels of surface that may be lost to a view at half of the sharpness to save one pixel of a seam.
constexpr double kSeamPixels = 3;

/// For each view the total area of triangles that it sees nearly as well as the best does is taken from the
/// largest on; what one has taken is no longer the others'.
std::vector<int> coveredByFew(const ViewQualities& qualities, const std::vector<double>& pixels) {
  const auto& views = qualities.views();
  std::vector<int> labels(qualities.best().size(), kNoView);
  const auto isOpen = [&](const SeenTriangle& s) {
    return labels[s.triangle] == kNoView && s.quality >= kNearBest * qualities.best()[s.triangle];
  };
  const auto gainOf = [&](std::size_t view) {
    double gain = 0;
    for (const SeenTriangle& s : views[view])
      if (isOpen(s)) gain += pixels[s.triangle];
    return gain;
  };
  std::priority_queue<std::pair<double, std::size_t>> queue;
  for (std::size_t i = 0; i < views.size(); ++i) queue.emplace(gainOf(i), i);
  while (!queue.empty()) {
    const std::size_t view = queue.top().second;
    queue.pop();
    const double gain = gainOf(view);  // which only sinks, so that an old one is a bound
    if (gain <= 0) continue;
    if (!queue.empty() && gain < queue.top().first) {
      queue.emplace(gain, view);
      continue;
    }
    for (const SeenTriangle& s : views[view])
      if (isOpen(s)) labels[s.triangle] = static_cast<int>(view);
  }
  return labels;
}

/// What labels cost: pixels lost, and seams.
class Smoothing {
 public:
  Smoothing(const TriangleMesh& mesh, const ViewQualities& qualities, const std::vector<double>& pixels,
            std::vector<int>& labels)
      : mesh_(mesh),
        best_(qualities.best()),
        pixels_(pixels),
        labels_(labels),
        neighbours_(neighboursOf(mesh)),
        choices_(best_.size()) {
    for (std::size_t view = 0; view < qualities.views().size(); ++view)
      for (const SeenTriangle& s : qualities.views()[view])
        choices_[s.triangle].push_back({static_cast<int>(view), s.quality});
  }

  /// Parts that are not worth their seams go to a neighbour's view, the small ones first.
  bool joinParts() {
    auto parts = partsOf(labels_, neighbours_);
    std::sort(parts.begin(), parts.end(), [](const auto& a, const auto& b) { return a.size() < b.size(); });
    std::vector<std::size_t> part_of(labels_.size());
    for (std::size_t i = 0; i < parts.size(); ++i)
      for (const std::uint32_t t : parts[i]) part_of[t] = i;
    bool changed = false;
    for (const auto& part : parts) {
      const int own = labels_[part.front()];
      if (own == kNoView) continue;
      double stay = 0;
      std::map<int, double> seams;  // pixels that the part shares with each view
      bool whole = true;
      for (const std::uint32_t t : part) {
        stay += loss(t, own);
        for (int e = 0; e < 3; ++e) {
          const std::uint32_t other = neighbours_[t][static_cast<std::size_t>(e)];
          if (other == kNoTriangle || labels_[other] == kNoView) continue;
          if (labels_[other] != own)
            seams[labels_[other]] += seam(t, e);
          else
            whole &= part_of[other] == part_of[t];
        }
      }
      if (!whole) continue;  // another has joined it in this round
      int to = own;
      double most_saved = 0;
      for (const auto& [label, length] : seams) {
        double lost = -stay;
        for (const std::uint32_t t : part) lost += loss(t, label);
        const double saved = kSeamPixels * length - lost;
        if (saved > most_saved) most_saved = saved, to = label;
      }
      if (to == own) continue;
      for (const std::uint32_t t : part) labels_[t] = to;
      changed = true;
    }
    return changed;
  }

  /// Each triangle takes the view that costs least beside its neighbours'.
  bool straightenSeams() {
    bool changed = false;
    for (std::uint32_t t = 0; t < labels_.size(); ++t) {
      if (labels_[t] == kNoView) continue;
      int to = labels_[t];
      double least = cost(t, to);
      for (const std::uint32_t other : neighbours_[t]) {
        if (other == kNoTriangle || labels_[other] == kNoView || labels_[other] == labels_[t]) continue;
        const double c = cost(t, labels_[other]);
        if (c < least) least = c, to = labels_[other];
      }
      changed |= to != labels_[t];
      labels_[t] = to;
    }
    return changed;
  }

 private:
  double loss(std::uint32_t t, int label) const {
    for (const auto& [view, quality] : choices_[t])
      if (view == label) return pixels_[t] * 2 * (1 - static_cast<double>(quality / best_[t]));
    return std::numeric_limits<double>::infinity();
  }
  double seam(std::uint32_t t, int edge) const {
    const auto& v = mesh_.triangles[t];
    const auto e = static_cast<std::size_t>(edge);
    return static_cast<double>((mesh_.vertices[v[e]] - mesh_.vertices[v[(e + 1) % 3]]).norm() * best_[t]);
  }
  double cost(std::uint32_t t, int label) const {
    double sum = loss(t, label);
    for (int e = 0; e < 3; ++e) {
      const std::uint32_t other = neighbours_[t][static_cast<std::size_t>(e)];
      if (other != kNoTriangle && labels_[other] != kNoView && labels_[other] != label)
        sum += kSeamPixels * seam(t, e);
    }
    return sum;
  }

  const TriangleMesh& mesh_;
  const std::vector<float>& best_;
  const std::vector<double>& pixels_;
  std::vector<int>& labels_;
  std::vector<std::array<std::uint32_t, 3>> neighbours_;
  std::vector<std::vector<std::pair<int, float>>> choices_;
};

}  // namespace

void ViewQualities::add(std::vector<SeenTriangle> seen) {
  std::erase_if(seen, [&](const SeenTriangle& s) { return s.quality < kWorst * best_[s.triangle]; });
  for (const SeenTriangle& s : seen) best_[s.triangle] = std::max(best_[s.triangle], s.quality);
  seen.shrink_to_fit();
  views_.push_back(std::move(seen));
}

void ViewQualities::forgetTheWorst() {
  for (auto& view : views_)
    std::erase_if(view, [&](const SeenTriangle& s) { return s.quality < kWorst * best_[s.triangle]; });
}

std::vector<int> chooseLabels(const TriangleMesh& mesh, const ViewQualities& qualities) {
  std::vector<double> pixels;  // that the best view gives each triangle
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const auto& t = mesh.triangles[i];
    const Eigen::Vector3f a = mesh.vertices[t[1]] - mesh.vertices[t[0]],
                          b = mesh.vertices[t[2]] - mesh.vertices[t[0]];
    const double best = qualities.best()[i];
    pixels.push_back(static_cast<double>(a.cross(b).norm()) / 2 * best * best);
  }
  std::vector<int> labels = coveredByFew(qualities, pixels);
  Smoothing smoothing(mesh, qualities, pixels, labels);
  constexpr int kRounds = 10;  // it ends by itself, for each step makes the whole cost less
  for (int round = 0; round < kRounds; ++round) {
    const bool joined = smoothing.joinParts();
    if (!smoothing.straightenSeams() && !joined) break;
  }
  return labels;
}

std::vector<std::array<std::uint32_t, 3>> neighboursOf(const TriangleMesh& mesh) {
  struct Edge {
    std::uint32_t low, high, triangle, side;
  };
  std::vector<Edge> edges;
  edges.reserve(3 * mesh.triangles.size());
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
    for (std::uint32_t side = 0; side < 3; ++side) {
      const auto [low, high] = std::minmax({mesh.triangles[t][side], mesh.triangles[t][(side + 1) % 3]});
      edges.push_back({low, high, t, side});
    }
  std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) {
    return std::tie(a.low, a.high, a.triangle) < std::tie(b.low, b.high, b.triangle);
  });
  std::vector<std::array<std::uint32_t, 3>> neighbours(mesh.triangles.size(),
                                                       {kNoTriangle, kNoTriangle, kNoTriangle});
  for (std::size_t i = 1; i < edges.size(); ++i) {
    const Edge &a = edges[i - 1], &b = edges[i];
    if (a.low != b.low || a.high != b.high) continue;
    neighbours[a.triangle][a.side] = b.triangle;
    neighbours[b.triangle][b.side] = a.triangle;
  }
  return neighbours;
}

std::vector<std::vector<std::uint32_t>> partsOf(const std::vector<int>& labels,
                                                const std::vector<std::array<std::uint32_t, 3>>& neighbours) {
  std::vector<std::vector<std::uint32_t>> parts;
  std::vector<bool> done(labels.size(), false);
  for (std::uint32_t start = 0; start < labels.size(); ++start) {
    if (done[start]) continue;
    std::vector<std::uint32_t> part = {start};
    done[start] = true;
    for (std::size_t i = 0; i < part.size(); ++i)
      for (const std::uint32_t other : neighbours[part[i]]) {
        if (other == kNoTriangle || done[other] || labels[other] != labels[start]) continue;
        done[other] = true;
        part.push_back(other);
      }
    parts.push_back(std::move(part));
  }
  return parts;
}

}  // namespace rosefusion
