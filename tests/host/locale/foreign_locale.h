// The program's locale while a test runs, as a desktop program sets it: decimal commas, grouped digits,
// Turkish letters.
#pragma once
#include <clocale>
#include <cstdlib>
#include <locale>
#include <map>
#include <string>

#include "tests/host/core/temporary_folder.h"

namespace rosefusion::testing {

/// Sets the C and the C++ locale and restores both at its end.
class ForeignLocale {
 public:
  /// `name`: such as "de_DE". Made in a folder of its own, since few machines have it.
  explicit ForeignLocale(const std::string& name) {
    const std::string full = name + ".UTF-8";
    if (!isMade(name, folder() / full)) return;
    setenv("LOCPATH", folder().path().c_str(), 1);
    if (!std::setlocale(LC_ALL, full.c_str())) return;
    std::locale::global(std::locale(full));
    available_ = true;
  }
  ~ForeignLocale() {
    unsetenv("LOCPATH");
    std::locale::global(before_);
    std::setlocale(LC_ALL, "C");
  }
  ForeignLocale(const ForeignLocale&) = delete;
  ForeignLocale& operator=(const ForeignLocale&) = delete;

  bool available() const { return available_; }

 private:
  static const TemporaryFolder& folder() {
    static const TemporaryFolder all;
    return all;
  }
  /// Once in a program, since it takes a second or two.
  static bool isMade(const std::string& name, const std::filesystem::path& locale) {
    static std::map<std::string, bool> known;
    const auto [entry, is_new] = known.try_emplace(name, false);
    if (is_new) {
      const std::string line =
          "localedef -i " + name + " -f UTF-8 '" + locale.string() + "' >'" + locale.string() + ".log' 2>&1";
      entry->second = std::system(line.c_str()) == 0;
    }
    return entry->second;
  }

  std::locale before_;
  bool available_ = false;
};

}  // namespace rosefusion::testing
