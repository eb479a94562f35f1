// A history is appended to line by line, whole or not at all, and any two of its entries are compared.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <nlohmann/json.hpp>
#include <regex>
#include <thread>

#include "host/bench/comparison.h"
#include "host/bench/history.h"
#include "host/core/system.h"
#include "tests/host/core/temporary_folder.h"

namespace rosefusion::testing {
namespace test_history {

using ::testing::HasSubstr;
using Json = nlohmann::ordered_json;

Json figures(double raycast, double integrate) {
  return {{"date", "2026-12-01T10:00:00Z"},
          {"commit", "0123456789ab"},
          {"processor", "EPYC"},
          {"device", {{"name", "llvmpipe"}, {"driver", "Mesa 22.3.6"}, {"type", "cpu"}}},
          {"native", "AVX2, 2 threads"},
          {"volume", {{"voxel_size_m", 0.02}, {"blocks", 3900}}},
          {"fitness", {{"ns_per_lookup", 2.0}, {"kahan_cost_percent", -1.0}}},
          {"integrate", {{"ms", integrate}, {"ratio", 2.0}}},
          {"raycast", {{"ms", raycast}, {"differing_share", 0.001}}},
          {"settings", "default"},
          {"frames", 24},
          {"seed", 1}};
}

TEST(History, AnEntrySaysWhatItWasMeasuredWith) {
  const Json entry = datedFigures({{"device", {{"name", "GPU"}}}});
  EXPECT_TRUE(std::regex_match(entry.at("date").get<std::string>(),
                               std::regex("20\\d\\d-\\d\\d-\\d\\dT\\d\\d:\\d\\d:\\d\\dZ")));
  EXPECT_FALSE(entry.at("commit").get<std::string>().empty());
  EXPECT_EQ(entry.at("processor"), processorName());
  EXPECT_EQ(entry.at("device").at("name"), "GPU");
}

TEST(History, EntriesAreReadByTheirNumber) {
  const TemporaryFolder folder;
  const std::string file = (folder / "h.jsonl").string();
  for (int i = 1; i <= 3; ++i) appendHistory(file, {{"number", i}});
  EXPECT_EQ(readFigures(file).at("number"), 3);
  EXPECT_EQ(readFigures(file + "#1").at("number"), 1);
  EXPECT_EQ(readFigures(file + "#-2").at("number"), 2);
  EXPECT_EQ(readFigures(folder.write("one.json", "{\n  \"number\": 7\n}\n")).at("number"), 7);
  for (const char* wrong : {"#4", "#-4", "#0", "#x", "#"})
    EXPECT_THAT(inputErrorOf([&] { readFigures(file + wrong); }), HasSubstr(file)) << wrong;
  const std::string broken = folder.write("broken.jsonl", "{\"number\": 1}\n{\"numb");
  EXPECT_THAT(inputErrorOf([&] { readFigures(broken + "#1"); }), HasSubstr("line 2"));
}

TEST(History, SeveralMayAppendAtOnce) {
  const TemporaryFolder folder;
  const std::string file = (folder / "h.jsonl").string();
  const std::string filler(5000, 'x');
  std::vector<std::jthread> writers;
  for (int writer = 0; writer < 4; ++writer)
    writers.emplace_back([&, writer] {
      for (int i = 0; i < 15; ++i) appendHistory(file, {{"writer", writer}, {"i", i}, {"filler", filler}});
    });
  writers.clear();
  std::array<int, 4> next{};
  for (int line = 1; line <= 60; ++line) {
    const Json entry = readFigures(file + "#" + std::to_string(line));
    EXPECT_EQ(entry.at("i"), next[entry.at("writer").get<int>()]++);
  }
}

TEST(History, ALineThatDoesNotFitIsTakenBack) {
  const TemporaryFolder folder;
  const std::string file = folder.write("h.jsonl", "{\"number\": 1}");  // whose end somebody took away
  const pid_t child = fork();
  if (child == 0) {
    std::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{100, 100};
    setrlimit(RLIMIT_FSIZE, &limit);
    _exit(appendLine(file, std::string(200, 'x')) == 0 ? 1 : 0);
  }
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  EXPECT_EQ(status, 0);
  EXPECT_EQ(contents(file), "{\"number\": 1}");
  appendHistory(file, {{"number", 2}});
  EXPECT_EQ(contents(file), "{\"number\": 1}\n{\"number\":2}\n");
  EXPECT_THAT(inputErrorOf([] { appendHistory("/dev/full", {{"number", 1}}); }), HasSubstr("/dev/full"));
}

TEST(Comparison, TheLargestChangeComesFirst) {
  const FiguresComparison c = compareFigures(figures(40, 10), figures(50, 5), "a", "b");
  ASSERT_EQ(c.figures.size(), 4u);
  EXPECT_EQ(c.figures[0].name, "integrate ms");
  EXPECT_DOUBLE_EQ(c.figures[0].ratio, 0.5);
  EXPECT_EQ(c.figures[1].name, "raycast ms");
  EXPECT_DOUBLE_EQ(c.figures[1].ratio, 1.25);
  EXPECT_TRUE(c.remarks.empty());
  const std::string table = comparisonTable(c);
  for (const char* named : {"llvmpipe", "Mesa 22.3.6", "EPYC", "0123456789ab", "1.250"})
    EXPECT_THAT(table, HasSubstr(named));
  EXPECT_EQ(comparisonJson(c).at("figures").at(0).at("name"), "integrate ms");
}

TEST(Comparison, WhatDoesNotCompareIsSaid) {
  Json other = figures(50, 5);
  other["settings"] = "paper";
  EXPECT_THAT(inputErrorOf([&] { compareFigures(figures(1, 1), other, "a.json", "b.json"); }),
              ::testing::AllOf(HasSubstr("a.json and b.json are not comparable"), HasSubstr("paper")));
  other = figures(50, 5);
  other["volume"]["voxel_size_m"] = 0.04;
  EXPECT_THAT(inputErrorOf([&] { compareFigures(figures(1, 1), other, "a", "b"); }), HasSubstr("voxel_size"));
  EXPECT_THAT(inputErrorOf([&] {
                compareFigures(figures(1, 1), {{"ate_cm", 2}}, "a", "b.json");
              }),
              HasSubstr("b.json"));
  other = figures(50, 5);
  other["processor"] = "Xeon";
  other["extract"] = {{"ms", 3.0}};
  const FiguresComparison c = compareFigures(figures(1, 1), other, "a", "b");
  ASSERT_EQ(c.remarks.size(), 2u);
  EXPECT_THAT(c.remarks[0], HasSubstr("different machines"));
  EXPECT_EQ(c.remarks[1], "Only b has: extract ms.");
}

}  // namespace test_history
}  // namespace rosefusion::testing
