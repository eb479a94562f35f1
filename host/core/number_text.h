// Numbers as text, alike in every locale: the program that this library is part of may have set one with
// decimal commas, grouped digits, or Turkish letters.
#pragma once
#include <locale>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>

namespace rosefusion {

/// The number that `text` starts with, infinities and "nan" included, which is then taken off `text`; nothing
/// where it starts with none. White space before it is not skipped.
std::optional<double> takeNumber(std::string_view& text);

/// The number that the whole of `text` is.
std::optional<double> parseNumber(std::string_view text);

/// std::snprintf without a limit, with a point before the decimals.
[[gnu::format(printf, 1, 2)]] std::string printed(const char* pattern, ...);

/// With ASCII letters made small; others are left alone.
std::string lowered(std::string text);

/// An output stream whose numbers have decimal points and no marks between their digits.
class TextStream : public std::ostringstream {
 public:
  TextStream() { imbue(std::locale::classic()); }
};

}  // namespace rosefusion
