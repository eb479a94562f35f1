// The wire format: what is packed comes back, and every field that is out of range is named.
#include <cmath>
#include <cstring>
#include <limits>

#include "host/sources/wire.h"

namespace rosefusion::testing {
namespace test_wire {

using namespace wire;
using ::testing::HasSubstr;

Header goodHeader() {
  Header h;
  h.type = static_cast<std::uint16_t>(Type::Frame);
  h.session = 0x1122334455667788;
  h.sequence = 7;
  h.width = 64;
  h.height = 48;
  h.timestamp = 12.5;
  h.fx = 60;
  h.fy = -60;
  h.cx = 31.5;
  h.cy = 23.5;
  h.depth_units_per_metre = 5000;
  h.frames = 100;
  return h;
}

const std::vector<std::byte> kDepth(5, std::byte{1}), kColour(3, std::byte{2});

std::string problemWith(const std::function<void(Header&)>& change) {
  Header h = goodHeader();
  change(h);
  std::string problem;
  const auto bytes = pack(h, kDepth, kColour);
  EXPECT_FALSE(parse(bytes, problem));
  return problem;
}

TEST(Wire, GivesBackWhatWasPacked) {
  std::string problem;
  const auto bytes = pack(goodHeader(), kDepth, kColour);
  const auto message = parse(bytes, problem);
  ASSERT_TRUE(message) << problem;
  EXPECT_EQ(message->type(), Type::Frame);
  EXPECT_EQ(message->header.session, goodHeader().session);
  EXPECT_EQ(message->header.sequence, 7u);
  EXPECT_EQ(message->header.timestamp, 12.5);
  EXPECT_EQ(message->intrinsics(), (Intrinsics{64, 48, 60, -60, 31.5, 23.5}));
  EXPECT_TRUE(std::equal(kDepth.begin(), kDepth.end(), message->depth.begin(), message->depth.end()));
  EXPECT_TRUE(std::equal(kColour.begin(), kColour.end(), message->colour.begin(), message->colour.end()));
}

TEST(Wire, LayoutIsTheDocumentedOne) {
  const auto bytes = pack(goodHeader(), kDepth, kColour);
  const auto word = [&](std::size_t offset) {
    std::uint32_t out;
    std::memcpy(&out, bytes.data() + offset, 4);
    return out;
  };
  EXPECT_EQ(std::memcmp(bytes.data(), "ROSF", 4), 0);
  EXPECT_EQ(word(4), 1u | 2u << 16);  // version, type
  EXPECT_EQ(word(8), 0x55667788u);
  EXPECT_EQ(word(16), 7u);
  EXPECT_EQ(word(28), kDepth.size());
  EXPECT_EQ(word(32), kColour.size());
  EXPECT_EQ(word(36), 64u);
  EXPECT_EQ(word(104), 100u);
  EXPECT_EQ(bytes[112], std::byte{1});
  EXPECT_EQ(bytes[117], std::byte{2});
}

TEST(Wire, EveryFieldIsChecked) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(problemWith([](Header& h) { h.magic = 1; }), HasSubstr("none of rosefusion's"));
  EXPECT_THAT(problemWith([](Header& h) { h.version = 9; }), HasSubstr("version is 9"));
  EXPECT_THAT(problemWith([](Header& h) { h.type = 77; }), HasSubstr("type 77"));
  EXPECT_THAT(problemWith([](Header& h) { h.type = static_cast<std::uint16_t>(Type::Ack); }),
              HasSubstr("type"));
  EXPECT_THAT(problemWith([](Header& h) { h.flags = 2; }), HasSubstr("flags"));
  EXPECT_THAT(problemWith([](Header& h) { h.reserved = 1; }), HasSubstr("flags"));
  EXPECT_THAT(problemWith([](Header& h) { h.width = 0xFFFFFFFF; }), HasSubstr("4294967295x48"));
  EXPECT_THAT(problemWith([](Header& h) { h.height = 0; }), HasSubstr("64x0"));
  EXPECT_THAT(problemWith([](Header& h) { h.type = static_cast<std::uint16_t>(Type::End); }),
              HasSubstr("none belong"));
  EXPECT_THAT(problemWith([&](Header& h) { h.timestamp = nan; }), HasSubstr("time stamp"));
  EXPECT_THAT(problemWith([](Header& h) { h.seconds_per_stamp = 0; }), HasSubstr("stamps"));
  EXPECT_THAT(problemWith([&](Header& h) { h.depth_units_per_metre = nan; }), HasSubstr("depth scale"));
  EXPECT_THAT(problemWith([&](Header& h) { h.fx = nan; }), HasSubstr("camera"));
  EXPECT_THAT(problemWith([](Header& h) { h.cx = -1; }), HasSubstr("camera"));
}

TEST(Wire, SizesMustAddUp) {
  const auto good = pack(goodHeader(), kDepth, kColour);
  std::string problem;
  for (std::size_t length = 0; length < good.size(); ++length) {
    EXPECT_FALSE(parse(std::span(good).first(length), problem)) << length;
    EXPECT_FALSE(problem.empty());
  }
  auto longer = good;
  longer.push_back(std::byte{0});
  EXPECT_FALSE(parse(longer, problem));
  auto huge = good;  // both sizes wrap around to a sum that would fit in 32 bits
  const std::uint32_t depth = 0xFFFFFFFF, colour = 9;
  std::memcpy(huge.data() + 28, &depth, 4);
  std::memcpy(huge.data() + 32, &colour, 4);
  EXPECT_FALSE(parse(huge, problem));
  EXPECT_THAT(problem, HasSubstr("do not add up"));
  EXPECT_FALSE(parse(pack(goodHeader()), problem));  // a frame without depth
}

TEST(Wire, AnswersAreTakenForTheOwnSessionOnly) {
  Ack ack;
  ack.session = 5;
  ack.expected = 3;
  ack.window_end = 11;
  const Answer answer = parseAnswer(pack(ack), 5);
  ASSERT_TRUE(answer.ack);
  EXPECT_EQ(answer.ack->expected, 3u);
  EXPECT_EQ(answer.ack->window_end, 11u);
  EXPECT_FALSE(parseAnswer(pack(ack), 6).ack);
  EXPECT_EQ(parseAnswer(packRefusal(5, "no\x1b[31m room"), 5).refusal, "no?[31m room");
  EXPECT_EQ(parseAnswer(packRefusal(5, "no room"), 6).refusal, "");
  EXPECT_LE(parseAnswer(packRefusal(5, std::string(100000, 'x')), 5).refusal.size(), 512u);
  const auto whole = pack(ack);
  EXPECT_FALSE(parseAnswer(std::span(whole).first(31), 5).ack);
}

}  // namespace test_wire
}  // namespace rosefusion::testing
