// Particle swarm templates: the pre-sampled candidate moves that every frame's pose search evaluates.
#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <vector>

#include "host/core/log.h"

namespace rosefusion {

/// One candidate move in the unit ball of R^6: (x, y, z) in metres, then (qx, qy, qz), the imaginary part of
/// a unit quaternion; scaled by the axis lengths before use. Particle 0 is the zero move, exactly.
using Particle = std::array<float, 6>;

/// Particles in random order (a prefix is as unbiased as the whole), no two closer than `radius`.
struct SwarmTemplate {
  std::vector<Particle> particles;
  double radius = 0;  ///< Poisson-disk radius, in the units of the unit ball
};

struct TemplateOptions {
  std::vector<int> sizes = {10240, 3072,
                            1024};  ///< particles per template, one level each (paper: Multi-resolution PST)
  int count = 20;                   ///< templates per size
  uint64_t seed = 1;
  int candidates = 30;  ///< Bridson's k: tries around a point before it is given up
  bool operator==(const TemplateOptions&) const = default;
};

/// levels[i] holds options.count templates of options.sizes[i] particles.
struct TemplateSet {
  TemplateOptions options;
  std::vector<std::vector<SwarmTemplate>> levels;

  /// The template for the given level and running number (taken modulo the count).
  const SwarmTemplate& at(size_t level, uint64_t number) const {
    return levels[level][number % levels[level].size()];
  }
};

/// Called after each finished template, from one thread at a time.
using TemplateProgress = std::function<void(int done, int total)>;

/// Uniform by volume and of exactly the wanted size: Poisson-disk samples crowd at the ball's surface (twice
/// the density of the inside in 6-D), so that a surplus is sampled and thinned at random to equal counts in
/// shells of equal volume, which keeps the minimum distance. The same options give the same bits on every
/// platform and for any number of threads. Throws InputError for sizes outside 32 to 200000 or a count or
/// candidates below 1.
TemplateSet generateTemplates(const TemplateOptions& options, const TemplateProgress& progress = {});

/// Where loadOrGenerate keeps templates of these options: $XDG_CACHE_HOME/rosefusion or ~/.cache/rosefusion;
/// empty when neither variable is set.
std::filesystem::path defaultTemplateCache(const TemplateOptions& options);

/// Reads the cache file when it holds these options; otherwise generates and writes it. A corrupt file or one
/// that cannot be written costs a warning to `log`, never a failure. Processes that need the same missing
/// file wait for the first of them to write it. An empty path means no cache.
TemplateSet loadOrGenerate(const std::filesystem::path& cache_file, const TemplateOptions& options,
                           const TemplateProgress& progress = {}, const Log& log = {});

}  // namespace rosefusion
