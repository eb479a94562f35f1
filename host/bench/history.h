// Figures of the passes that are kept: what they were measured with, one line of a history each, and reading
// them again.
#pragma once
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>

namespace rosefusion {

/// The commit that this program was built from, ", changed" where files were; "not told" where no git knows.
std::string programCommit();

/// `figures` (an object) behind what a reader must know beside them: date (UTC), commit and processor.
nlohmann::ordered_json datedFigures(const nlohmann::ordered_json& figures);

/// Appends one line, whole or not at all; several programs may do so at once. Throws InputError, naming the
/// file.
void appendHistory(const std::filesystem::path& file, const nlohmann::ordered_json& entry);

/// What `place` names: a file with one entry, or the last one of a history; FILE#N is a history's N-th,
/// FILE#-N the N-th from its end. Throws InputError, naming file and line.
nlohmann::ordered_json readFigures(const std::string& place);

}  // namespace rosefusion
