// What the network costs is measured on frames that arrive as they were sent.
#include "host/bench/network_bench.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "host/sources/stream.h"
#include "tests/host/core/temporary_folder.h"
#include "tests/host/sources/memory_sequence.h"

namespace rosefusion::testing {
namespace test_network_bench {

TEST(NetworkBench, CountsTimeAndBytes) {
  MemorySequence sequence(numberedFrames(12, 30), kSmallCamera);
  if (!streamsAvailable()) {
    EXPECT_NE(inputErrorOf([&] { benchNetwork(sequence, 8); }).find("libzmq3-dev"), std::string::npos);
    return;
  }
  const NetworkReport report = benchNetwork(sequence, 8);
  EXPECT_EQ(report.frames, 8u);
  EXPECT_GT(report.compress_ms, 0);
  EXPECT_GT(report.added_ms, 0);
  EXPECT_GE(report.added_p95_ms, report.added_ms);
  EXPECT_NEAR(report.compression * report.frame_bytes, 2 * 64 * 48, 1);
  EXPECT_EQ(networkJson(report).at("added_ms"), report.added_ms);
  EXPECT_NE(networkTable(report).find("memory: 8 frames"), std::string::npos);
  EXPECT_NE(inputErrorOf([&] { benchNetwork(sequence, 2); }).find("too few"), std::string::npos);
}

}  // namespace test_network_bench
}  // namespace rosefusion::testing
