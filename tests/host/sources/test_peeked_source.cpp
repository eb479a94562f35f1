// Frames that were looked at beforehand come again, and nothing else is asked of their source.
#include "host/sources/peeked_source.h"

#include <gtest/gtest.h>

namespace rosefusion::testing {
namespace test_peeked_source {

/// Gives so many frames, the first `damaged` of them unusable; being asked again after the end is a failure.
class Counted : public FrameSource {
 public:
  Counted(std::size_t frames, std::size_t damaged) : frames_(frames), damaged_(damaged) {}
  const SequenceInfo& info() const override { return info_; }
  SourceState next(SourceFrame& out, const StopQuestion&) override {
    EXPECT_FALSE(std::exchange(ended_, given_ == frames_)) << "asked after its end";
    if (ended_) return SourceState::End;
    out.index = given_++;
    out.usable = given_ > damaged_;
    if (out.usable) out.frame.depth = cv::Mat::ones(4, 4, CV_16UC1);
    return SourceState::Frame;
  }

 private:
  SequenceInfo info_;
  std::size_t frames_, damaged_, given_ = 0;
  bool ended_ = false;
};

void expectAll(PeekedSource& source, std::size_t frames) {
  SourceFrame frame;
  for (std::size_t i = 0; i < frames; ++i) {
    ASSERT_EQ(source.next(frame, {}), SourceState::Frame);
    EXPECT_EQ(frame.index, i);
  }
  EXPECT_EQ(source.next(frame, {}), SourceState::End);
}

TEST(PeekedSource, FramesThatWereLookedAtComeAgain) {
  PeekedSource source(std::make_unique<Counted>(8, 1));
  EXPECT_EQ(source.firstDepths(3, {}).size(), 3u);
  expectAll(source, 8);
}

TEST(PeekedSource, AShortSourceIsNotAskedAfterItsEnd) {
  PeekedSource source(std::make_unique<Counted>(2, 0));
  EXPECT_EQ(source.firstDepths(5, {}).size(), 2u);
  expectAll(source, 2);
}

TEST(PeekedSource, DamagedFramesAreNotReadForEver) {
  PeekedSource source(std::make_unique<Counted>(1000, 1000));
  EXPECT_TRUE(source.firstDepths(2, {}).empty());
  expectAll(source, 1000);
}

}  // namespace test_peeked_source
}  // namespace rosefusion::testing
