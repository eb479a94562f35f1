// Files that are either whole or absent.
#pragma once
#include <cstddef>
#include <filesystem>
#include <string_view>

namespace rosefusion {

/// Writes to a temporary file beside `file`, flushes it to the disk's view and renames it into place; the
/// parent folder is made when missing. Throws InputError (naming the file and the system's reason, such as a
/// full disk) and removes the temporary file on failure.
void writeFileAtomically(const std::filesystem::path& file, std::string_view bytes);

}  // namespace rosefusion
