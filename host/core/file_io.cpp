#include "host/core/file_io.h"

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <string>
#include <system_error>

#include "host/core/error.h"
#include "host/core/system.h"

namespace rosefusion {

namespace fs = std::filesystem;

namespace {

/// What is there and is no regular file: a device or a pipe, possibly behind a link.
bool isSpecial(const fs::path& file) {
  std::error_code error;
  const fs::file_status status = fs::status(file, error);
  return fs::exists(status) && !fs::is_regular_file(status) && !fs::is_directory(status);
}

/// Where the bytes go first.
fs::path temporaryFor(const fs::path& file) {
  fs::path temporary = file;
  return temporary += ".part";
}

void makeParent(const fs::path& file) {
  if (!file.has_parent_path()) return;
  std::error_code error;
  fs::create_directories(file.parent_path(), error);
  if (error)
    throw InputError(file.parent_path().string() + ": the folder cannot be made (" + error.message() +
                     "); choose another output folder.");
}

[[noreturn]] void failToWrite(const fs::path& file, int code) {
  throw InputError(file.string() + ": cannot be written (" + std::strerror(code) +
                   "); free some space or choose another output folder.");
}

}  // namespace

void requireWritable(const fs::path& file) {
  makeParent(file);
  std::error_code error;
  if (fs::is_directory(file, error)) failToWrite(file, EISDIR);
  if (isSpecial(file)) return;
  const fs::path temporary = temporaryFor(file);
  if (const int code = writeBytes(temporary, "")) failToWrite(file, code);
  fs::remove(temporary, error);
}

std::string readFile(const fs::path& file) {
  std::string bytes;
  if (const int code = readBytes(file, bytes))
    throw InputError(file.string() + ": cannot be read (" + std::strerror(code) +
                     "); check its name, its permissions and the disk.");
  return bytes;
}

void writeFileAtomically(const fs::path& named, std::string_view bytes) {
  std::error_code error;
  makeParent(named);
  const bool special = isSpecial(named);
  const fs::path target = fs::is_symlink(named, error) && !special ? fs::canonical(named, error) : fs::path();
  const fs::path& file = target.empty() ? named : target;
  const fs::path temporary = special ? file : temporaryFor(file);
  const auto fail = [&](int code) {
    if (!special) fs::remove(temporary, error);
    failToWrite(named, code);
  };
  if (const int code = writeBytes(temporary, bytes)) fail(code);
  if (special) return;
  fs::rename(temporary, file, error);
  if (error) fail(error.value());
}

std::filesystem::path settledPath(const std::filesystem::path& path) {
  const fs::path whole = fs::absolute(path).lexically_normal();
  return whole.has_filename() ? whole : whole.parent_path();
}

ScratchFolder::ScratchFolder(const std::string& purpose) {
  std::error_code error;
  const fs::path folder = fs::temp_directory_path(error);
  const char* wanted = std::getenv("TMPDIR");
  const fs::path beginning = (error && wanted ? fs::path(wanted) : folder) / ("rosefusion-" + purpose + "-");
  path_ = makeUniqueFolder(beginning);
  if (path_.empty())
    throw InputError(beginning.string() +
                     "...: no temporary folder can be made; point TMPDIR to a folder that can be written.");
}

ScratchFolder::~ScratchFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

}  // namespace rosefusion
