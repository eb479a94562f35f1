#include "host/swarm/template_sampling.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <exception>
#include <mutex>
#include <string>
#include <thread>

#include "host/core/error.h"
#include "host/swarm/poisson_ball.h"

namespace rosefusion {
namespace {

constexpr int kFewestParticles = 32;
constexpr int kMostParticles = 200000;
constexpr int kMostShells = 16;
constexpr int kParticlesPerShell = 64;  // fewer would make the surplus grow with their counts' scatter

// Fraction of the ball's volume inside the point's radius: uniform in [0, 1] for an unbiased sample.
double enclosedVolume(const Point6& point) {
  double squared = 0;
  for (double x : point) squared += x * x;
  return squared * squared * squared;
}

// The sample's points by shell of equal volume.
std::vector<std::vector<Point6>> splitIntoShells(const std::vector<Point6>& points, int shell_count) {
  std::vector<std::vector<Point6>> shells(static_cast<size_t>(shell_count));
  for (const Point6& point : points) {
    const int shell = std::min(static_cast<int>(enclosedVolume(point) * shell_count), shell_count - 1);
    shells[static_cast<size_t>(shell)].push_back(point);
  }
  return shells;
}

int shellCount(int size) {
  return std::clamp(size / kParticlesPerShell, 1, kMostShells);
}

// Particles that shell `i` must hold, summing up to `size`.
size_t shellQuota(int size, size_t i) {
  const auto bound = [&](size_t k) {
    return static_cast<size_t>(size) * k / static_cast<size_t>(shellCount(size));
  };
  return bound(i + 1) - bound(i);
}

// Smallest surplus of any shell, as points found over points wanted.
double scarcestShare(const std::vector<std::vector<Point6>>& shells, int size) {
  double share = 1e30;
  for (size_t i = 0; i < shells.size(); ++i)
    share = std::min(share, static_cast<double>(shells[i].size()) / static_cast<double>(shellQuota(size, i)));
  return share;
}

uint64_t streamSeed(uint64_t seed, int size, int index) {
  // splitmix64's finaliser, so that neighbouring seeds, sizes and indices give unrelated streams.
  uint64_t z = seed * 0x9e3779b97f4a7c15u + static_cast<uint64_t>(size) * 0xd1342543de82ef95u +
               static_cast<uint64_t>(index + 1) * 0xaf251af3b0f025b5u;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return z ^ (z >> 31);
}

// By bisection, because std::pow and std::cbrt may differ in the last bit between platforms.
double sixthRoot(double y) {
  double low = 0, high = std::max(1.0, y);
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    const double cube = middle * middle * middle;
    (cube * cube < y ? low : high) = middle;
  }
  return low;
}

// Poisson-disk radius at which every shell just about reaches its quota. Counts grow as radius^-6, so that a
// few rounds of that rule on a sample of its own settle it.
double findRadius(const TemplateOptions& options, int size) {
  PortableRandom random(streamSeed(options.seed, size, -1));
  constexpr double kStart = 1.2;     // radius * size^(1/6), measured at 1024 to 10240
  constexpr double kSurplus = 1.02;  // for the scatter between templates, which would otherwise be resampled
  double radius = kStart / sixthRoot(size);
  for (int round = 0; round < 3; ++round) {
    const auto shells = splitIntoShells(poissonBall(radius, options.candidates, random), shellCount(size));
    radius *= sixthRoot(std::max(scarcestShare(shells, size), 0.1) / kSurplus);
  }
  return radius;
}

SwarmTemplate sampleTemplate(const TemplateOptions& options, int size, int index, double radius) {
  PortableRandom random(streamSeed(options.seed, size, index));
  const auto shuffle = [&](auto begin, auto end) {
    for (auto left = static_cast<uint32_t>(end - begin); left > 1; --left)
      std::iter_swap(begin + (left - 1), begin + random.below(left));
  };
  constexpr double kShrink = 0.997;  // 1.8 % more points
  auto shells = splitIntoShells(poissonBall(radius, options.candidates, random), shellCount(size));
  while (scarcestShare(shells, size) < 1) {
    radius *= kShrink;
    shells = splitIntoShells(poissonBall(radius, options.candidates, random), shellCount(size));
  }
  std::vector<Point6> kept;
  for (size_t i = 0; i < shells.size(); ++i) {
    // The origin is the first point found, so the first of its shell; it stays in front.
    shuffle(shells[i].begin() + (i == 0 ? 1 : 0), shells[i].end());
    kept.insert(kept.end(), shells[i].begin(),
                shells[i].begin() + static_cast<std::ptrdiff_t>(shellQuota(size, i)));
  }
  shuffle(kept.begin() + 1, kept.end());
  SwarmTemplate result;
  result.radius = radius;
  result.particles.reserve(kept.size());
  for (const Point6& point : kept) {
    Particle particle;
    std::transform(point.begin(), point.end(), particle.begin(),
                   [](double x) { return static_cast<float>(x); });
    result.particles.push_back(particle);
  }
  return result;
}

void requireValid(const TemplateOptions& options) {
  const auto fail = [](const std::string& what) { throw InputError("swarm templates: " + what); };
  if (options.sizes.empty()) fail("no size is given; name at least one, such as 1024.");
  for (int size : options.sizes)
    if (size < kFewestParticles || size > kMostParticles)
      fail("a size of " + std::to_string(size) + " particles is out of range; choose " +
           std::to_string(kFewestParticles) + " to " + std::to_string(kMostParticles) + ".");
  if (options.count < 1 || options.count > 1000) fail("the count per size must be 1 to 1000.");
  if (options.candidates < 1 || options.candidates > 10000)
    fail("the candidates per point must be 1 to 10000.");
}

// Runs job(i) for i in [0, count) on all cores; rethrows the first exception.
void parallelFor(int count, const std::function<void(int)>& job) {
  std::atomic<int> next = 0;
  std::exception_ptr failure;
  std::mutex failure_mutex;
  const auto work = [&] {
    try {
      for (int i = next++; i < count; i = next++) job(i);
    } catch (...) {
      next = count;
      const std::lock_guard lock(failure_mutex);
      if (!failure) failure = std::current_exception();
    }
  };
  const int workers =
      std::min<int>(count, static_cast<int>(std::max(1u, std::thread::hardware_concurrency())));
  {
    std::vector<std::jthread> threads;
    for (int i = 1; i < workers; ++i) threads.emplace_back(work);
    work();
  }
  if (failure) std::rethrow_exception(failure);
}

}  // namespace

TemplateSet generateTemplates(const TemplateOptions& options, const TemplateProgress& progress) {
  requireValid(options);
  const int level_count = static_cast<int>(options.sizes.size());
  const auto sizeOf = [&](int level) { return options.sizes[static_cast<size_t>(level)]; };
  std::vector<double> radii(options.sizes.size());
  parallelFor(level_count, [&](int i) { radii[static_cast<size_t>(i)] = findRadius(options, sizeOf(i)); });

  TemplateSet set;
  set.options = options;
  set.levels.assign(options.sizes.size(), std::vector<SwarmTemplate>(static_cast<size_t>(options.count)));
  const int total = level_count * options.count;
  int done = 0;
  std::mutex progress_mutex;
  parallelFor(total, [&](int job) {
    const int level = job / options.count;
    const int index = job % options.count;
    set.levels[static_cast<size_t>(level)][static_cast<size_t>(index)] =
        sampleTemplate(options, sizeOf(level), index, radii[static_cast<size_t>(level)]);
    const std::lock_guard lock(progress_mutex);
    if (progress) progress(++done, total);
  });
  return set;
}

}  // namespace rosefusion
