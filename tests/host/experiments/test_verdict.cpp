// Tables, fits and verdicts: what stands between the numbers and the words.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>

#include "host/experiments/quoted.h"
#include "host/experiments/runs.h"
#include "host/experiments/verdict.h"

namespace rosefusion::testing {
namespace test_verdict {

using ::testing::HasSubstr;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(Verdict, LeastAndMostAllowTheSlack) {
  EXPECT_EQ(leastOf("", "", {"a", 1}, {{"b", 2}, {"c", 1}}).agreement, Agreement::Agrees);
  EXPECT_EQ(leastOf("", "", {"a", 1}, {{"b", 2}, {"c", 0.99}}).agreement, Agreement::Differs);
  EXPECT_EQ(leastOf("", "", {"a", 1}, {{"b", 0.99}}, 0.02).agreement, Agreement::Agrees);
  EXPECT_EQ(mostOf("", "", {"a", 1}, {{"b", 0.5}, {"c", 1}}).agreement, Agreement::Agrees);
  EXPECT_EQ(mostOf("", "", {"a", 1}, {{"b", 1.01}}).agreement, Agreement::Differs);
  EXPECT_EQ(mostOf("", "", {"a", 1}, {{"b", 1.01}}, 0.02).agreement, Agreement::Agrees);
  EXPECT_EQ(within("", "", {"a", 1}, 1).agreement, Agreement::Agrees);
  EXPECT_EQ(within("", "", {"a", 1.1}, 1).agreement, Agreement::Differs);
}

TEST(Verdict, WithoutANumberItStaysOpen) {
  EXPECT_EQ(leastOf("", "", {"a", kNan}, {{"b", 2}}).agreement, Agreement::Open);
  EXPECT_EQ(leastOf("", "", {"a", 1}, {{"b", kNan}}).agreement, Agreement::Open);
  EXPECT_EQ(leastOf("", "", {"a", 1}, {}).agreement, Agreement::Open);
  EXPECT_EQ(within("", "", {"a", kNan}, 1).agreement, Agreement::Open);
}

TEST(Verdict, SaysTheNumbers) {
  const Verdict v = leastOf("the claim", " cm", {"pst", 1.234}, {{"icp", 56}});
  EXPECT_EQ(v.claim, "the claim");
  EXPECT_EQ(v.found, "pst 1.23 cm, icp 56 cm");
}

TEST(FitLine, FindsSlopeOffsetAndWhatIsLeftOver) {
  const LinearFit exact = fitLine({1, 2, 3, 5}, {5, 7, 9, 13});
  EXPECT_DOUBLE_EQ(exact.slope, 2);
  EXPECT_DOUBLE_EQ(exact.offset, 3);
  EXPECT_DOUBLE_EQ(exact.r_squared, 1);
  // By hand: means 1 and 1, xx 2, xy 1, yy 2: slope 1/2, R^2 = 1 / 4.
  const LinearFit loose = fitLine({0, 1, 2}, {1, 0, 2});
  EXPECT_DOUBLE_EQ(loose.slope, 0.5);
  EXPECT_DOUBLE_EQ(loose.r_squared, 0.25);
  EXPECT_TRUE(std::isnan(fitLine({1, 2}, {1, 2}).r_squared));
  EXPECT_TRUE(std::isnan(fitLine({1, 1, 1}, {1, 2, 3}).slope));
}

TEST(StepsToReach, CountsUpToTheShareOfTheWay) {
  EXPECT_EQ(stepsToReach({0, 0.5, 0.89, 0.9, 1}, 1, 0.9), 3);
  EXPECT_EQ(stepsToReach({0.2, 0.3}, 0.2, 0.9), 0) << "there from the start";
  EXPECT_EQ(stepsToReach({0, 0.1, 0.2}, 1, 0.9), 3) << "never";
}

TEST(Table, WritesCsvAndPlotData) {
  Table table({"name", "value_cm"});
  table.add({"a, \"b\" c", 1.0 / 3});
  table.addGap();
  table.add({"d", kNan});
  EXPECT_EQ(table.csv(), "name,value_cm\n\"a, \"\"b\"\" c\",0.333333\nd,nan\n");
  Table plain({"name", "value"});
  plain.add({"two words", -0.0 / 1});
  plain.addGap();
  plain.add({"one", 1e-9});
  EXPECT_EQ(plain.plotData(), "\"two words\" -0\n\none 1e-09\n");
  EXPECT_THROW(table.add({1}), std::invalid_argument);
}

TEST(RunRecord, ALostFrameFailsAndCountsOneMetre) {
  RunRecord record;
  record.ate_m = {0.01, 0.03, 2.0, kInfinity};
  EXPECT_DOUBLE_EQ(record.cappedError(), (0.01 + 0.03 + 1 + 1) / 4);
  EXPECT_DOUBLE_EQ(shareWithin(record.ate_m, 0.03), 0.5);
  EXPECT_DOUBLE_EQ(shareWithin(record.ate_m, 1000), 0.75);
  EXPECT_TRUE(std::isnan(shareWithin({}, 1)));
}

TEST(QuotedFigures, AreThoseOfThePapersTables) {
  std::set<std::string> labels;
  for (const QuotedFigure& f : quotedFigures()) {
    labels.insert(f.label);
    EXPECT_FALSE(f.sequence.empty() || f.system.empty() || f.unit.empty()) << f.label;
  }
  EXPECT_THAT(labels, ::testing::ElementsAre("tab:ablt-tsdf", "tab:comp-eth", "tab:comp-fcm-real",
                                             "tab:comp-fcm-synth", "tab:comp-icl"));
  EXPECT_EQ(quotedFigures().size(), 14u * 4 + 9 * 4 + 6 * 3 + 10 * 3 + 12 * 3 * 2);
  // The paper's text names these means.
  EXPECT_THAT(quotedMeans("tab:comp-fcm-synth"), HasSubstr("ROSEFusion 2.6 cm"));
  EXPECT_THAT(quotedMeans("tab:comp-fcm-synth"), HasSubstr("ElasticFusion 42.8 cm (1 failed)"));
  EXPECT_THAT(quotedMeans("tab:comp-fcm-real"), HasSubstr("ROSEFusion completeness at 15 cm 77.8 %"));
  EXPECT_THAT(quotedTable("tab:comp-eth").csv(),
              HasSubstr("tab:comp-eth,camera_shake_3,BundleFusion,ATE mean,cm,failed,quoted from the paper"));
}

}  // namespace test_verdict
}  // namespace rosefusion::testing
