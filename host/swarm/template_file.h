// The binary file that holds a set of swarm templates.
#pragma once
#include <filesystem>

#include "host/swarm/template_sampling.h"

namespace rosefusion {

/// Little-endian, versioned, checksummed; written whole or not at all. Throws InputError when it cannot be
/// written.
void writeTemplates(const std::filesystem::path& file, const TemplateSet& set);

/// Throws InputError naming the file when it is missing, of another version, truncated or corrupt.
TemplateSet readTemplates(const std::filesystem::path& file);

}  // namespace rosefusion
