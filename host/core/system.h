// What is asked of the operating system beyond the standard library: system_posix.cpp, system_windows.cpp.
#pragma once
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace rosefusion {

/// Whether a person watches what is written to `stream`.
bool isTerminal(std::FILE* stream);

/// The kernel in words, such as "Linux 6.1.0, x86_64".
std::string kernelName();

/// The processor's name, or "not told".
std::string processorName();

/// This process's number, which a child of fork() does not share.
std::uint64_t processNumber();

/// Processor time of all threads of this process, seconds.
double processorSeconds();

/// Makes a folder named `beginning` and something random, which only this user may enter. Empty when it
/// cannot.
std::filesystem::path makeUniqueFolder(const std::filesystem::path& beginning);

/// Makes or empties `file` and writes all of `bytes`, however often the system interrupts it or takes less
/// than it is given. The system's error code, 0 when all has gone well.
int writeBytes(const std::filesystem::path& file, std::string_view bytes);

/// Appends `line` and its end to `file`, which is made where it is missing, with one write, so that lines of
/// several programs do not mix; begins a new line where the last one has no end. What could not be written
/// whole is taken back. The system's error code, 0 when all has gone well.
int appendLine(const std::filesystem::path& file, std::string_view line);

/// Appends all of a file to `bytes`, as writeBytes() writes.
int readBytes(const std::filesystem::path& file, std::string& bytes);

/// Runs a program found along PATH, its output appended to `log`, and waits for its end: the exit status, 1
/// when it was killed, 127 when there is no such program.
int runProgram(const std::vector<std::string>& program_and_arguments, const std::filesystem::path& log);

/// While it lives, files that this process makes can be read by this user only. Not for several threads at
/// once.
class PrivateFiles {
 public:
  PrivateFiles();
  ~PrivateFiles();
  PrivateFiles(const PrivateFiles&) = delete;
  PrivateFiles& operator=(const PrivateFiles&) = delete;

 private:
  unsigned before_;
};

/// Held by one process at a time; waits for it. Released by the system when the process dies. Where locks do
/// not work (some network disks) or the file cannot be made it does nothing.
class FileLock {
 public:
  explicit FileLock(const std::filesystem::path& file);
  ~FileLock();
  FileLock(const FileLock&) = delete;
  FileLock& operator=(const FileLock&) = delete;

 private:
  std::intptr_t handle_;
};

}  // namespace rosefusion
