#ifndef _WIN32
#include <fcntl.h>
#include <spawn.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/utsname.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <ctime>
#include <fstream>

#include "host/core/system.h"

extern char** environ;  // NOLINT: POSIX names it, and no header of macOS does

namespace rosefusion {

std::string kernelName() {
  utsname system{};
  if (uname(&system) != 0) return "unknown";
  return std::string(system.sysname) + " " + system.release + ", " + system.machine;
}

std::string processorName() {
  std::ifstream in("/proc/cpuinfo");
  for (std::string line; std::getline(in, line);)
    if (const std::size_t colon = line.find(": "); colon != line.npos && line.starts_with("model name"))
      return line.substr(colon + 2);
  return "not told";
}

bool isTerminal(std::FILE* stream) {
  return isatty(fileno(stream)) != 0;
}

double processorSeconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

std::filesystem::path makeUniqueFolder(const std::filesystem::path& beginning) {
  std::string pattern = beginning.string() + "XXXXXX";
  return mkdtemp(pattern.data()) ? std::filesystem::path(pattern) : std::filesystem::path();
}

namespace {

/// `call` again and again while a signal interrupts it.
template <typename Call>
auto uninterrupted(Call call) {
  decltype(call()) result;
  do {
    result = call();
  } while (result < 0 && errno == EINTR);
  return result;
}

}  // namespace

int writeBytes(const std::filesystem::path& file, std::string_view bytes) {
  const int out =
      uninterrupted([&] { return open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666); });
  if (out < 0) return errno;
  int error = 0;
  while (!bytes.empty() && !error) {
    const ssize_t written = uninterrupted([&] { return write(out, bytes.data(), bytes.size()); });
    if (written > 0)
      bytes.remove_prefix(static_cast<std::size_t>(written));
    else
      error = written < 0 ? errno : EIO;
  }
  // Interrupted or not, it is closed; some disks tell only now that they are full.
  if (close(out) < 0 && errno != EINTR && !error) error = errno;
  return error;
}

int appendLine(const std::filesystem::path& file, std::string_view line) {
  const int out =
      uninterrupted([&] { return open(file.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0666); });
  if (out < 0) return errno;
  (void)flock(out, LOCK_EX);  // for the end of the file, and for taking back
  const off_t end = lseek(out, 0, SEEK_END);
  char last = '\n';
  if (end > 0) (void)uninterrupted([&] { return pread(out, &last, 1, end - 1); });
  const std::string bytes = (last == '\n' ? "" : "\n") + std::string(line) + "\n";
  const ssize_t written = uninterrupted([&] { return write(out, bytes.data(), bytes.size()); });
  int error = written < 0 ? errno : written < static_cast<ssize_t>(bytes.size()) ? ENOSPC : 0;
  if (error && written > 0 && end >= 0 && ftruncate(out, end) != 0) error = errno;
  if (close(out) < 0 && errno != EINTR && !error) error = errno;
  return error;
}

int readBytes(const std::filesystem::path& file, std::string& bytes) {
  const int in = uninterrupted([&] { return open(file.c_str(), O_RDONLY | O_CLOEXEC); });
  if (in < 0) return errno;
  std::vector<char> chunk(1 << 16);
  ssize_t got = 0;
  while ((got = uninterrupted([&] { return read(in, chunk.data(), chunk.size()); })) > 0)
    bytes.append(chunk.data(), static_cast<std::size_t>(got));
  const int error = got < 0 ? errno : 0;
  close(in);
  return error;
}

std::uint64_t processNumber() {
  return static_cast<std::uint64_t>(getpid());
}

int runProgram(const std::vector<std::string>& program_and_arguments, const std::filesystem::path& log) {
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, log.c_str(), O_WRONLY | O_CREAT | O_APPEND, 0600);
  posix_spawn_file_actions_adddup2(&actions, STDOUT_FILENO, STDERR_FILENO);
  std::vector<char*> arguments;
  for (const std::string& argument : program_and_arguments)
    arguments.push_back(const_cast<char*>(argument.c_str()));  // posix_spawn promises not to write to them
  arguments.push_back(nullptr);
  pid_t child = 0;
  const int refused = posix_spawnp(&child, arguments[0], &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (refused) return 127;
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  return WIFEXITED(status) ? WEXITSTATUS(status) : 1;
}

PrivateFiles::PrivateFiles() : before_(umask(0077)) {}
PrivateFiles::~PrivateFiles() {
  umask(static_cast<mode_t>(before_));
}

FileLock::FileLock(const std::filesystem::path& file)
    : handle_(open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644)) {
  if (handle_ >= 0) (void)flock(static_cast<int>(handle_), LOCK_EX);
}
FileLock::~FileLock() {
  if (handle_ >= 0) close(static_cast<int>(handle_));
}

}  // namespace rosefusion
#endif
