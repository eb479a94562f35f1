// Time per frame of the library on a caller's device against the pipeline on a device of its own, frame by
// frame in turns, so that whatever else the machine does falls on both: bench_embedding [FRAMES]. Prints the
// median of the ratios.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>

#include "host/slam/pipeline.h"
#include "rosefusion/vulkan.h"
#include "tests/engine/caller.h"
#include "tests/host/embedding/frames.h"

using namespace rosefusion;
using namespace rosefusion::testing;

int main(int count, char** texts) {
  const SynthSequence sequence = makeShortSequence(kAnyRoom, count > 1 ? std::atoi(texts[1]) : 60);
  Caller caller(false);
  const CallerDevice h = caller.handles();
  Reconstructor embedded(publicCamera(sequence), {.get_instance_proc_addr = h.get_instance_proc_addr,
                                                  .instance = h.instance,
                                                  .physical_device = h.physical_device,
                                                  .device = h.device,
                                                  .queue = h.queue});
  Device device({.select = "llvmpipe"});
  Pipeline standalone(device, loadSettings("default"), sequence.intrinsics, sequence.depth_units_per_metre);
  const auto milliseconds = [](auto work) {
    const auto start = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  };
  std::vector<double> ratios, ours, theirs;
  for (std::size_t i = 0; i < sequence.frames.size(); ++i) {
    double times[2];
    for (std::size_t turn = 0; turn < 2; ++turn) {
      const bool is_embedded = (i + turn) % 2;
      times[is_embedded] = milliseconds([&] {
        if (is_embedded)
          embedded.process(publicFrame(i, sequence));
        else
          standalone.processFrame(sequence.frames[i]);
      });
    }
    if (i < 2) continue;  // pipelines are built in the first frames
    theirs.push_back(times[0]);
    ours.push_back(times[1]);
    ratios.push_back(times[1] / times[0]);
  }
  const auto median = [](std::vector<double> values) {
    std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
    return values[values.size() / 2];
  };
  std::printf("standalone %.2f ms, embedded %.2f ms per frame (medians of %zu); median ratio %.4f\n",
              median(theirs), median(ours), ratios.size(), median(ratios));
}
