// Files that are either whole or absent.
#pragma once
#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

namespace rosefusion {

/// Writes to a temporary file beside `file`, flushes it to the disk's view and renames it into place; the
/// parent folder is made when missing. A link's target is replaced, not the link; what is no regular file,
/// such as /dev/stdout or a pipe, is written to. Throws InputError (naming the file and the system's reason,
/// such as a full disk) and removes the temporary file on failure.
void writeFileAtomically(const std::filesystem::path& file, std::string_view bytes);

/// All bytes of a file. Throws InputError, with the system's reason, when not all of them can be read.
std::string readFile(const std::filesystem::path& file);

/// Throws what writeFileAtomically would for want of a folder or of permission, before long work; leaves
/// `file` as it is.
void requireWritable(const std::filesystem::path& file);

/// Absolute, normal and without a slash at the end, so that its last part is its name.
std::filesystem::path settledPath(const std::filesystem::path& path);

/// A new folder where the system keeps temporary files, removed with all that is in it. Throws InputError.
class ScratchFolder {
 public:
  /// `purpose`: one word of the folder's name.
  explicit ScratchFolder(const std::string& purpose);
  ~ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace rosefusion
