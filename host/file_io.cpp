#include "host/file_io.h"

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <system_error>

#include "host/error.h"

namespace rosefusion {

void writeFileAtomically(const std::filesystem::path& file, std::string_view bytes) {
  namespace fs = std::filesystem;
  std::error_code error;
  if (file.has_parent_path()) {
    fs::create_directories(file.parent_path(), error);
    if (error)
      throw InputError(file.parent_path().string() + ": the folder cannot be made (" + error.message() +
                       "); choose another output folder.");
  }
  fs::path temporary = file;
  temporary += ".part";
  const auto fail = [&](int code) {
    fs::remove(temporary, error);
    throw InputError(file.string() + ": cannot be written (" + std::strerror(code) +
                     "); free some space or choose another output folder.");
  };
  std::FILE* out = std::fopen(temporary.c_str(), "wb");
  if (!out) fail(errno);
  const bool wrote = std::fwrite(bytes.data(), 1, bytes.size(), out) == bytes.size() && std::fflush(out) == 0;
  const int write_error = errno;
  const bool closed = std::fclose(out) == 0;
  if (!wrote) fail(write_error);
  if (!closed) fail(errno);
  fs::rename(temporary, file, error);
  if (error) fail(error.value());
}

ScratchFolder::ScratchFolder(const std::string& purpose) {
  std::string pattern =
      (std::filesystem::temp_directory_path() / ("rosefusion-" + purpose + "-XXXXXX")).string();
  if (!mkdtemp(pattern.data()))
    throw InputError(pattern +
                     ": no temporary folder can be made; point TMPDIR to a folder that can be written.");
  path_ = pattern;
}

ScratchFolder::~ScratchFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

}  // namespace rosefusion
