#include "host/core/number_text.h"

#include <locale.h>
#if __has_include(<xlocale.h>)
#include <xlocale.h>  // uselocale() of Apple's C library
#endif

#include <algorithm>
#include <charconv>
#include <cstdarg>
#include <cstdio>
#include <limits>
#include <system_error>

namespace rosefusion {
namespace {

#ifdef _WIN32
int format(char* out, std::size_t size, const char* pattern, std::va_list values) {
  static const _locale_t classic = _create_locale(LC_ALL, "C");
  return out ? _vsnprintf_l(out, size, pattern, classic, values) : _vscprintf_l(pattern, classic, values);
}
#else
/// This thread's C functions follow the "C" locale while it lives.
class ClassicLocale {
 public:
  ClassicLocale() : before_(uselocale(classic())) {}
  ~ClassicLocale() { uselocale(before_); }
  ClassicLocale(const ClassicLocale&) = delete;
  ClassicLocale& operator=(const ClassicLocale&) = delete;

 private:
  static locale_t classic() {
    static const locale_t locale = newlocale(LC_ALL_MASK, "C", nullptr);  // never freed: used at exit too
    return locale;
  }
  locale_t before_;
};

int format(char* out, std::size_t size, const char* pattern, std::va_list values) {
  const ClassicLocale classic;
  return std::vsnprintf(out, size, pattern, values);
}
#endif

}  // namespace

std::optional<double> takeNumber(std::string_view& text) {
  std::string_view rest = text;
  if (rest.starts_with('+') && !rest.starts_with("+-")) rest.remove_prefix(1);  // which from_chars refuses
  double value = 0;
  const auto [end, error] = std::from_chars(rest.data(), rest.data() + rest.size(), value);
  if (error == std::errc::invalid_argument) return std::nullopt;
  const std::string_view digits = rest.substr(0, static_cast<std::size_t>(end - rest.data()));
  if (error == std::errc::result_out_of_range) {
    const bool is_small = digits.find("e-") != digits.npos || digits.find("E-") != digits.npos;
    value = is_small ? 0 : std::numeric_limits<double>::infinity();
    if (digits.starts_with('-')) value = -value;
  }
  text = rest.substr(digits.size());
  return value;
}

std::optional<double> parseNumber(std::string_view text) {
  const std::optional<double> value = takeNumber(text);
  return text.empty() ? value : std::nullopt;
}

std::string printed(const char* pattern, ...) {
  std::va_list values, again;
  va_start(values, pattern);
  va_copy(again, values);
  std::string text(static_cast<std::size_t>(std::max(0, format(nullptr, 0, pattern, values))), '\0');
  format(text.data(), text.size() + 1, pattern, again);
  va_end(again);
  va_end(values);
  return text;
}

std::string lowered(std::string text) {
  for (char& c : text)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return text;
}

}  // namespace rosefusion
