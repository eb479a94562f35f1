// Text files as people have them: any line ends, with or without a byte order mark, UTF-8 or UTF-16.
#pragma once
#include <filesystem>
#include <string>

namespace rosefusion {

/// The file as UTF-8 with "\n" line ends and without a byte order mark. UTF-16 (as PowerShell's '>' writes)
/// is told by its mark or by its zero bytes. Throws InputError when the file cannot be opened or is a folder.
std::string readTextFile(const std::filesystem::path& file);

}  // namespace rosefusion
