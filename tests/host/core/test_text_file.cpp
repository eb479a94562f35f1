// Text files in the encodings and line ends that people's systems write.
#include "host/core/text_file.h"

#include <gmock/gmock.h>

#include "tests/host/core/temporary_folder.h"

namespace rosefusion::testing {
namespace test_text_file {

std::string utf16(const std::u16string& text, bool big_endian) {
  std::string bytes;
  for (const char16_t unit : text) {
    const char low = static_cast<char>(unit & 0xFF), high = static_cast<char>(unit >> 8);
    bytes += big_endian ? high : low;
    bytes += big_endian ? low : high;
  }
  return bytes;
}

TEST(TextFile, EncodingsAndLineEnds) {
  const TemporaryFolder folder;
  const std::u16string text = u"a b\r\nm\u00fcll \U0001F4F7\n";
  const std::string plain = "a b\nm\xC3\xBCll \xF0\x9F\x93\xB7\n";
  for (const bool big_endian : {false, true}) {
    EXPECT_EQ(readTextFile(folder.write("u", utf16(u"\ufeff" + text, big_endian))), plain) << big_endian;
    EXPECT_EQ(readTextFile(folder.write("u", utf16(text, big_endian))), plain) << "without a mark";
  }
  EXPECT_EQ(readTextFile(folder.write("u", "\xEF\xBB\xBF" + plain)), plain);
  EXPECT_EQ(readTextFile(folder.write("u", "one\rtwo\r\n\r\nthree")), "one\ntwo\n\nthree");
  EXPECT_EQ(readTextFile(folder.write("u", "")), "");
  EXPECT_EQ(readTextFile(folder.write("u", utf16(u"\ufeffx\xD83D", false))), "x\xEF\xBF\xBD")
      << "half a pair";
  EXPECT_THAT(inputErrorOf([&] { readTextFile(folder.path()); }), ::testing::HasSubstr("folder"));
  EXPECT_THAT(inputErrorOf([&] { readTextFile(folder / "absent"); }), ::testing::HasSubstr("absent"));
}

}  // namespace test_text_file
}  // namespace rosefusion::testing
