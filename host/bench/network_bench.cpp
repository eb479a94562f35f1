#include "host/bench/network_bench.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <stdexcept>
#include <utility>

#include "host/bench/stopwatch.h"
#include "host/core/error.h"
#include "host/core/number_text.h"
#include "host/sources/stream.h"

namespace rosefusion {
namespace {

using namespace std::chrono_literals;

constexpr auto kPatience = 200ms;
constexpr std::size_t kFewest = 4;  // frames, the first of which make the connection

std::vector<Frame> readFrames(Sequence& sequence, std::size_t most) {
  std::vector<Frame> frames;
  std::string problem;
  for (std::size_t i = 0; i < sequence.size() && frames.size() < most; ++i)
    if (Frame frame; sequence.read(i, frame, problem)) frames.push_back(std::move(frame));
  if (frames.size() < kFewest)
    throw InputError(sequence.info().path.string() + ": holds too few frames that can be read (" +
                     std::to_string(frames.size()) + "); give another sequence.");
  return frames;
}

bool same(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() && (a.empty() || cv::norm(a, b, cv::NORM_INF) == 0);
}

void requireSame(const Frame& received, const Frame& sent) {
  if (!same(received.depth, sent.depth) || !same(received.colour, sent.colour))
    throw std::runtime_error("A frame did not arrive as it was sent: a defect of the network stream.");
}

}  // namespace

NetworkReport benchNetwork(Sequence& sequence, std::size_t frames) {
  const std::vector<Frame> sent = readFrames(sequence, frames);
  StreamReceiver receiver("tcp://127.0.0.1:*", {});
  StreamSender sender(receiver.endpoint(), sequence.info(), {});
  std::vector<double> times;
  const double cpu_before = cpuMilliseconds();
  std::vector<SourceFrame> arrived;
  arrived.reserve(sent.size());
  SourceFrame received;
  for (std::size_t i = 0; i < sent.size(); ++i) {
    const auto start = std::chrono::steady_clock::now();
    const auto patience = [&] { return std::chrono::steady_clock::now() - start > kPatience; };
    sender.send(sent[i], {});
    // What was sent before there was a connection arrives with a later frame, and is not timed.
    const bool alone = arrived.size() == i;
    while (arrived.size() <= i && receiver.next(received, patience) == SourceState::Frame)
      arrived.push_back(std::exchange(received, {}));
    if (alone && arrived.size() > i)
      times.push_back(
          std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count());
  }
  if (times.empty()) throw std::runtime_error("No connection over loopback came about.");
  const double cpu = cpuMilliseconds() - cpu_before;
  sender.finish({});
  for (std::size_t i = 0; i < arrived.size(); ++i) requireSame(arrived[i].frame, sent[i]);
  const StreamSender::Counts counts = sender.counts();
  std::sort(times.begin(), times.end());
  NetworkReport report;
  report.sequence = sequence.info().path.string();
  report.frames = sent.size();
  report.frame_bytes = double(counts.sent_bytes) / double(sent.size());
  report.compression = double(counts.raw_bytes) / double(counts.sent_bytes);
  report.added_ms = times[times.size() / 2];
  report.added_p95_ms = times[times.size() * 95 / 100];
  report.added_cpu_ms = cpu / double(sent.size());
  report.compress_ms = 1000 * counts.compress_seconds / double(sent.size());
  return report;
}

nlohmann::ordered_json networkJson(const NetworkReport& r) {
  return {{"sequence", r.sequence},         {"frames", r.frames},          {"frame_bytes", r.frame_bytes},
          {"compression", r.compression},   {"added_ms", r.added_ms},      {"added_p95_ms", r.added_p95_ms},
          {"added_cpu_ms", r.added_cpu_ms}, {"compress_ms", r.compress_ms}};
}

std::string networkTable(const NetworkReport& r) {
  return r.sequence + ": " +
         printed(
             "%zu frames over loopback, one at a time\n"
             "  sent        %9.1f kB a frame, %.1f:1 compressed\n"
             "  added       %9.2f ms a frame (median; 95 %% under %.2f ms)\n"
             "  CPU time    %9.2f ms a frame (mean, both ends)\n"
             "  compress    %9.2f ms a frame (mean, part of added)\n",
             r.frames, r.frame_bytes / 1e3, r.compression, r.added_ms, r.added_p95_ms, r.added_cpu_ms,
             r.compress_ms);
}

}  // namespace rosefusion
