#include <cstdlib>
#include <optional>
#include <sstream>
#include <string>
#include <system_error>

#include "host/core/error.h"
#include "host/core/number_text.h"
#include "host/core/system.h"
#include "host/swarm/template_file.h"
#include "host/swarm/template_sampling.h"

namespace rosefusion {
namespace {

std::optional<TemplateSet> tryRead(const std::filesystem::path& file, const TemplateOptions& options,
                                   const Log& log) {
  if (std::error_code error; !std::filesystem::exists(file, error)) return std::nullopt;
  try {
    TemplateSet set = readTemplates(file);
    if (set.options == options) return set;
    if (log)
      log(Severity::Warning, file.string() + ": holds swarm templates of other options; it is written anew.");
  } catch (const InputError& error) {
    if (log) log(Severity::Warning, std::string(error.what()) + " It is written anew now.");
  }
  return std::nullopt;
}

}  // namespace

std::filesystem::path defaultTemplateCache(const TemplateOptions& options) {
  const auto variable = [](const char* name) {
    const char* value = std::getenv(name);
    return std::filesystem::path(value ? value : "");
  };
  std::filesystem::path folder = variable("XDG_CACHE_HOME");
  if (!folder.is_absolute()) {  // the XDG specification says to ignore relative ones
    folder = variable("HOME");
    if (folder.empty()) return {};
    folder /= ".cache";
  }
  TextStream name;
  name << "templates";
  for (int size : options.sizes) name << '-' << size;
  name << "_x" << options.count << "_seed" << options.seed << "_k" << options.candidates << ".pst";
  return folder / "rosefusion" / name.str();
}

TemplateSet loadOrGenerate(const std::filesystem::path& cache_file, const TemplateOptions& options,
                           const TemplateProgress& progress, const Log& log) {
  if (cache_file.empty()) return generateTemplates(options, progress);
  if (auto set = tryRead(cache_file, options, {})) return *std::move(set);
  std::error_code ignored;  // writing the file says what is wrong with the folder
  std::filesystem::create_directories(cache_file.parent_path(), ignored);
  std::filesystem::path lock_file = cache_file;
  // Another process may be making the same file.
  const FileLock lock(lock_file += ".lock");
  if (auto set = tryRead(cache_file, options, log)) return *std::move(set);
  TemplateSet set = generateTemplates(options, progress);
  try {
    writeTemplates(cache_file, set);
  } catch (const InputError& error) {
    if (log)
      log(Severity::Warning,
          std::string(error.what()) + " The swarm templates will be generated again next time.");
  }
  return set;
}

}  // namespace rosefusion
