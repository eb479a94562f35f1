// The sentences that users and their scripts know.
#include "host/slam/status_reason.h"

#include <gtest/gtest.h>

#include <set>

namespace rosefusion::testing {
namespace test_status_reason {

TEST(StatusReason, NumbersAreRoundedToPercent) {
  EXPECT_EQ(toString({Reason::LittleDepth, 0.014}), "only 1 % of the pixels have valid depth");
  EXPECT_EQ(toString({Reason::PoorFit, 0.625}), "the depth misses the model by 62 % of the truncation");
  EXPECT_EQ(toString({Reason::Occluded, 0.4}),
            "something came before the camera (40 % of the image); not integrated until it is gone");
}

TEST(StatusReason, EachHasWordsOfItsOwnWithoutAFullStop) {
  std::set<std::string> all;
  for (int i = 0; i <= static_cast<int>(Reason::ModelBegunAnew); ++i) {
    const std::string words = toString({static_cast<Reason>(i)});
    EXPECT_EQ(words.empty(), i == 0) << i;
    EXPECT_FALSE(words.ends_with('.')) << words;
    EXPECT_TRUE(all.insert(words).second) << words;
  }
}

}  // namespace test_status_reason
}  // namespace rosefusion::testing
