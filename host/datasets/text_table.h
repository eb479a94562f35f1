// Small text files: whitespace-separated fields, '#' comments, CRLF tolerated.
#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace rosefusion::datasets {

struct TextRow {
  int line = 0;  ///< 1-based, for messages
  std::vector<std::string> fields;
  std::string text;                 ///< the whole line
  std::vector<std::size_t> begins;  ///< of the fields in it

  /// The line's text from the first to the last of these fields, with all blanks and commas between them,
  /// without quotation marks around it: a file's name.
  std::string span(std::size_t first, std::size_t last) const;
};

struct TextTable {
  std::vector<TextRow> rows;
  std::string comments;  ///< all comment lines, joined
};

/// Splits at blanks and commas. Throws InputError when the file cannot be opened. The file may be UTF-8 or
/// UTF-16.
TextTable readTextTable(const std::filesystem::path& file);

/// True when the whole field is one number (finite or not).
bool parseNumber(const std::string& field, double& value);

/// The number in names such as frame-000012.depth.png: the digits (at most nine) between `prefix` and
/// `suffix`, as text with its leading zeros. Nothing when the name has another form.
std::optional<std::string> digitsBetween(const std::string& name, std::string_view prefix,
                                         std::string_view suffix);

/// Every number of the file in reading order. Throws InputError naming the line of a field that is no number.
std::vector<double> readNumbers(const std::filesystem::path& file);

/// One line 'stamp path' of a list such as depth.txt.
struct StampedFile {
  double timestamp = 0;
  std::string file;
};

/// Reads a list. A name may hold spaces where such a file is there. Malformed lines are skipped with one
/// warning for all of them; throws InputError when no line is good.
std::vector<StampedFile> readStampedFiles(const std::filesystem::path& list,
                                          std::vector<std::string>& warnings);

/// Whether it is one of the files that systems lay beside people's own: hidden, as a Mac's ._NAME is.
bool isHidden(const std::filesystem::path& file);

/// "LIST: N lines skipped, the first ..." - the one wording for lines left out.
std::string skippedLines(const std::filesystem::path& list, std::size_t count, const std::string& first);

}  // namespace rosefusion::datasets
