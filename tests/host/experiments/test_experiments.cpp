// Experiments from end to end, as small as can be: files, repeatability, going on after an interruption, the
// page.
#include <gmock/gmock.h>

#include <fstream>
#include <iterator>
#include <map>

#include "host/core/error.h"
#include "host/experiments/sequences.h"
#include "host/experiments/suite.h"
#include "host/synth/tum_writer.h"
#include "tests/engine/validating_device.h"
#include "tests/host/core/temporary_folder.h"

namespace rosefusion::testing {
namespace test_experiments {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::Not;

std::string contents(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

class Experiments : public ValidatingDevice {
 protected:
  ExperimentContext contextIn(const fs::path& out) {
    ExperimentContext context{device(), {}, {}, {}};
    context.options.quick = true;
    context.options.shrink = 8;
    context.options.out = out;
    return context;
  }
  TemporaryFolder folder_;
};

TEST_F(Experiments, ElevenOfThePapersAreThere) {
  std::vector<std::string> names;
  for (const Experiment& e : experiments()) {
    names.push_back(e.name);
    EXPECT_GT(e.work(contextIn(folder_ / "a")), 0) << e.name;
  }
  EXPECT_THAT(
      names, ::testing::ElementsAre("tsdf-normalisation", "optimisers", "rescaling", "multires", "complexity",
                                    "accuracy", "frames", "surfaces", "inside", "gallery", "speed-limit"));
  EXPECT_EQ(experimentsNamed("all").size(), 11u);
  EXPECT_EQ(experimentsNamed("inside")[0]->name, "inside");
  EXPECT_THAT(inputErrorOf([] { experimentsNamed("outside"); }), HasSubstr("tsdf-normalisation"));
}

TEST_F(Experiments, SecondRunRecallsEqualTables) {
  const Experiment& experiment = *experimentsNamed("optimisers")[0];
  std::vector<ExperimentResult> results;
  for (const char* out : {"a", "b"})
    results.push_back(runOrRecall(contextIn(folder_ / out), experiment, false));
  ASSERT_FALSE(results[0].tables.empty());
  for (const std::string& table : results[0].tables) {
    const std::string csv = contents(folder_ / "a" / "optimisers" / table);
    EXPECT_GT(std::count(csv.begin(), csv.end(), '\n'), 80) << "4 variants of 21 rows each";
    EXPECT_EQ(csv, contents(folder_ / "b" / "optimisers" / table)) << table;
  }
  for (const Figure& figure : results[0].figures)
    EXPECT_GT(fs::file_size(folder_ / "a" / "optimisers" / figure.file), 5000u) << figure.file;
  EXPECT_FALSE(results[0].verdicts.empty());
  for (std::size_t i = 0; i < results[0].verdicts.size(); ++i)
    EXPECT_EQ(results[0].verdicts[i].found, results[1].verdicts[i].found);

  bool recalled = false;
  const ExperimentResult again = runOrRecall(contextIn(folder_ / "a"), experiment, false, &recalled);
  EXPECT_TRUE(recalled);
  EXPECT_EQ(verdictTable({{&experiment, again}}).csv(), verdictTable({{&experiment, results[0]}}).csv());
  ExperimentContext other = contextIn(folder_ / "a");
  other.options.seed = 2;
  runOrRecall(other, experiment, false, &recalled);
  EXPECT_FALSE(recalled) << "another seed is another experiment";
}

TEST_F(Experiments, InterruptedItGoesOnWithTheRunsItHas) {
  const Experiment& experiment = *experimentsNamed("tsdf-normalisation")[0];
  int frames = 0;
  ExperimentContext context = contextIn(folder_ / "a");
  context.progress = [&](int done, const std::string&) { frames += done; };
  context.stop = [&] { return frames >= 20; };
  EXPECT_THROW(runOrRecall(context, experiment, false), Interrupted);
  const auto kept = std::distance(fs::directory_iterator(folder_ / "a" / "runs"), fs::directory_iterator());
  EXPECT_EQ(kept, 2) << "of 8 frames each";
  EXPECT_FALSE(fs::exists(folder_ / "a" / "tsdf-normalisation" / "result.json"));

  context.stop = {};
  std::map<fs::path, fs::file_time_type> written;
  for (const auto& entry : fs::directory_iterator(folder_ / "a" / "runs"))
    written[entry.path()] = entry.last_write_time();
  runOrRecall(context, experiment, false);
  for (const auto& [path, time] : written) EXPECT_EQ(fs::last_write_time(path), time) << path;
  const ExperimentResult whole = runOrRecall(contextIn(folder_ / "b"), experiment, false);
  for (const std::string& table : whole.tables)
    EXPECT_EQ(contents(folder_ / "a" / "tsdf-normalisation" / table),
              contents(folder_ / "b" / "tsdf-normalisation" / table));

  const std::string page = reportHtml(context, {{&experiment, whole}});
  EXPECT_THAT(page, HasSubstr("data:image/png;base64,iVBORw0KGgo"));
  EXPECT_THAT(page, HasSubstr(context.device.info().name));
  EXPECT_THAT(page, HasSubstr(summaryOf(whole)));
  for (const Verdict& v : whole.verdicts) EXPECT_THAT(page, HasSubstr(v.found));
  EXPECT_THAT(page, Not(HasSubstr("http")));
  EXPECT_THAT(page, Not(HasSubstr("<script")));
}

TEST_F(Experiments, AMissingDataFolderIsNamed) {
  ExperimentContext context = contextIn(folder_ / "a");
  context.options.data = "/nowhere/data";
  EXPECT_THAT(inputErrorOf([&] { runOrRecall(context, *experimentsNamed("accuracy")[0], false); }),
              HasSubstr("/nowhere/data"));
}

TEST_F(Experiments, RecordedSequencesAreNamedByTheirFolder) {
  ExperimentContext context = contextIn(folder_ / "a");
  SynthOptions synth;
  synth.frames = 3;
  synth.intrinsics = {64, 48, 32, 32, 31.5, 23.5};
  writeTumSequence(folder_ / "my_seq", SynthPlan(synth), false);
  for (const fs::path& data : {folder_ / "my_seq", folder_ / "my_seq/", folder_ / "my_seq/."}) {
    context.options.data = data;
    const auto sequences = recordedSequences(context);
    ASSERT_EQ(sequences.size(), 1u) << data;
    EXPECT_EQ(sequences[0].name, "my_seq") << data;
  }
}

TEST(Summary, CountsTheVerdicts) {
  ExperimentResult result;
  result.verdicts = {{"", "", Agreement::Agrees}, {"", "", Agreement::Agrees}};
  EXPECT_EQ(summaryOf(result), "agrees (2 of 2 points)");
  result.verdicts[0].agreement = Agreement::Differs;
  EXPECT_EQ(summaryOf(result), "agrees in part (1 of 2 points)");
  result.verdicts[1].agreement = Agreement::Differs;
  EXPECT_EQ(summaryOf(result), "differs (0 of 2 points)");
  result.verdicts[1].agreement = Agreement::Open;
  EXPECT_EQ(summaryOf(result), "agrees in part (0 of 2 points, 1 open)");
}

}  // namespace test_experiments
}  // namespace rosefusion::testing
