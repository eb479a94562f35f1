// Google Benchmark of what the host does for each frame without the device. The passes have `rosefusion
// bench`, which pairs them with a native loop.
#include <benchmark/benchmark.h>

#include <map>
#include <opencv2/imgcodecs.hpp>
#include <stdexcept>

#include "host/core/file_io.h"
#include "host/datasets/image_file.h"
#include "host/swarm/swarm_update.h"
#include "host/synth/sequence.h"
#ifdef ROSEFUSION_CODEC
#include "host/sources/image_codec.h"
#endif

namespace rosefusion {
namespace {

/// 640x480, of a room, with the sensor's noise.
const Frame& someFrame() {
  static const Frame frame = [] {
    SynthOptions options;
    options.frames = 2;
    return makeSequence(options).frames[1];
  }();
  return frame;
}

void readDepthPng(benchmark::State& state) {
  const ScratchFolder folder("bench");
  const std::filesystem::path file = folder.path() / "depth.png";
  cv::imwrite(file, someFrame().depth);
  cv::Mat depth;
  std::string problem;
  for (auto _ : state)
    if (!datasets::readDepthImage(file, {}, depth, problem)) throw std::runtime_error(problem);
}
BENCHMARK(readDepthPng)->Unit(benchmark::kMillisecond);

/// One iteration's update of a swarm of so many particles, half of which improve.
void updateSwarm(benchmark::State& state) {
  const int particles = static_cast<int>(state.range(0));
  TemplateOptions options;
  options.sizes = {particles};
  options.count = 1;
  static std::map<int, TemplateSet> made;  // this function is called several times for each size
  if (!made.contains(particles)) made[particles] = generateTemplates(options);
  const SwarmTemplate& swarm_template = made[particles].at(0, 0);
  std::vector<float> losses(swarm_template.particles.size(), 0.2f);
  for (std::size_t i = 1; i < losses.size(); i += 2) losses[i] = 0.1f;
  const SwarmSettings settings;
  const SwarmState start = beginFrame(settings, Pose::Identity(), nullptr);
  for (auto _ : state) {
    SwarmState swarm = start;
    benchmark::DoNotOptimize(update(settings, swarm, swarm_template, losses));
  }
  state.SetItemsProcessed(state.iterations() * particles);
}
BENCHMARK(updateSwarm)->Arg(10240)->Arg(3072)->Arg(1024)->Unit(benchmark::kMicrosecond);

#ifdef ROSEFUSION_CODEC
void compressDepth(benchmark::State& state) {
  ImageCodec codec;
  const cv::Mat& frame = someFrame().depth;
  std::size_t bytes = 0;
  for (auto _ : state) bytes = codec.compressDepth(frame).size();
  const double plain = 2.0 * static_cast<double>(frame.total());
  state.counters["ratio"] = plain / static_cast<double>(bytes);
}
BENCHMARK(compressDepth)->Unit(benchmark::kMillisecond);

void decompressDepth(benchmark::State& state) {
  ImageCodec codec;
  const cv::Mat& frame = someFrame().depth;
  const auto packed = codec.compressDepth(frame);
  const std::vector<std::byte> bytes(packed.begin(), packed.end());
  cv::Mat depth;
  for (auto _ : state)
    if (!codec.decompressDepth(bytes, frame.size(), depth)) throw std::runtime_error("not decompressed");
}
BENCHMARK(decompressDepth)->Unit(benchmark::kMillisecond);
#endif

}  // namespace
}  // namespace rosefusion

BENCHMARK_MAIN();
