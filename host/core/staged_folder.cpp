#include "host/core/staged_folder.h"

#include <system_error>

#include "host/core/error.h"
#include "host/core/file_io.h"

namespace rosefusion {
namespace {

namespace fs = std::filesystem;

/// Marks a folder as ours to delete, as long as anything is in it.
constexpr const char* kPartMark = ".rosefusion-part";

fs::path partOf(fs::path folder) {
  return folder += ".part";
}
/// Where the one that is replaced goes.
fs::path replacedOf(fs::path folder) {
  return folder += ".replaced.part";
}

bool isOurs(const fs::path& folder) {
  std::error_code error;
  if (fs::exists(folder / kPartMark, error)) return true;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error))
    if (!entry.path().filename().string().starts_with(kPartMark))
      return false;  // the mark itself may be unfinished
  return !error;
}

/// The mark goes last: what is left by a process that is killed meanwhile is still ours.
void removeOurs(const fs::path& folder) {
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error))
    if (entry.path().filename() != kPartMark) fs::remove_all(entry.path(), error);
  fs::remove_all(folder, error);
}

}  // namespace

void StagedFolder::requireUsable(const fs::path& folder, const std::string& replaceable,
                                 const std::string& remedy) {
  if (folder.empty()) throw InputError("The sequence's folder has no name; give one.");
  std::error_code error;
  for (const fs::path& part : {partOf(settledPath(folder)), replacedOf(settledPath(folder))})
    if (fs::exists(part, error) && !isOurs(part))
      throw InputError(part.string() +
                       ": is in the way and was not left by an interrupted run; move it, or give "
                       "another folder.");
  if (!fs::exists(folder, error)) return;
  if (!fs::is_directory(folder, error))
    throw InputError(folder.string() + ": is a file; give the name of a folder for the sequence.");
  if (replaceable.empty() && !fs::is_empty(folder, error))
    throw InputError(folder.string() + ": is not empty; " + remedy + ".");
  // A typing error must not cost someone a home folder.
  if (!replaceable.empty() && !fs::is_empty(folder, error) && !fs::exists(folder / replaceable, error))
    throw InputError(folder.string() + ": holds something else than such a sequence (no " + replaceable +
                     ") and is not replaced; give another folder.");
}

StagedFolder::StagedFolder(const fs::path& folder, const std::string& replaceable)
    : folder_(settledPath(folder)), part_(partOf(folder_)) {
  requireUsable(folder_, replaceable);
  removeOurs(part_);
  removeOurs(replacedOf(folder_));
  writeFileAtomically(part_ / kPartMark, "");
}

StagedFolder::~StagedFolder() {
  if (!is_kept_) removeOurs(part_);
}

/// At every moment what has the name is whole.
void StagedFolder::takePlace() {
  const fs::path replaced = replacedOf(folder_);
  keep();
  std::error_code error;
  fs::remove(folder_, error);  // empty, or a link
  const bool replaces = fs::exists(folder_, error);
  if (replaces) {
    writeFileAtomically(replaced / kPartMark, "");
    fs::rename(folder_, replaced / "sequence", error);
  }
  if (!error) fs::rename(part_, folder_, error);
  if (error) {
    const std::string reason = error.message();
    if (replaces && !fs::exists(folder_, error)) fs::rename(replaced / "sequence", folder_, error);
    removeOurs(replaced);
    fs::remove(part_ / kPartMark, error);
    throw InputError(folder_.string() + ": cannot be replaced (" + reason + "); the sequence is in " +
                     part_.string() + ".");
  }
  fs::remove(folder_ / kPartMark, error);
  removeOurs(replaced);
}

}  // namespace rosefusion
