#ifdef _WIN32
#ifndef NOMINMAX
#define NOMINMAX
#endif
#define WIN32_LEAN_AND_MEAN
#include <io.h>
#include <windows.h>

#include <cerrno>
#include <cstdlib>
#include <random>

#include "host/core/system.h"

namespace rosefusion {
namespace {

/// As CommandLineToArgvW takes it apart: backslashes count only before a quotation mark.
std::wstring quoted(const std::wstring& argument) {
  std::wstring text = L"\"";
  std::size_t backslashes = 0;
  for (const wchar_t c : argument) {
    if (c == L'"') text.append(backslashes + 1, L'\\');
    backslashes = c == L'\\' ? backslashes + 1 : 0;
    text += c;
  }
  return text.append(backslashes, L'\\') + L'"';
}

double seconds(const FILETIME& time) {  // of 100 ns each
  return 1e-7 * (4294967296.0 * time.dwHighDateTime + time.dwLowDateTime);
}

}  // namespace

std::string kernelName() {
  return "Windows";
}

std::string processorName() {
  const char* name = std::getenv("PROCESSOR_IDENTIFIER");
  return name ? name : "not told";
}

std::uint64_t processNumber() {
  return GetCurrentProcessId();
}

bool isTerminal(std::FILE* stream) {
  return _isatty(_fileno(stream)) != 0;
}

double processorSeconds() {
  FILETIME created, ended, kernel, user;
  if (!GetProcessTimes(GetCurrentProcess(), &created, &ended, &kernel, &user)) return 0;
  return seconds(kernel) + seconds(user);
}

std::filesystem::path makeUniqueFolder(const std::filesystem::path& beginning) {
  std::random_device random;
  std::error_code error;
  for (int attempt = 0; attempt < 100; ++attempt) {
    std::filesystem::path folder = beginning;
    folder += std::to_string(random());
    if (std::filesystem::create_directory(folder, error)) return folder;
    if (error) break;
  }
  return {};
}

int writeBytes(const std::filesystem::path& file, std::string_view bytes) {
  std::FILE* out = _wfopen(file.c_str(), L"wb");
  if (!out) return errno;
  int error = 0;
  errno = 0;
  if (std::fwrite(bytes.data(), 1, bytes.size(), out) != bytes.size() || std::fflush(out) != 0)
    error = errno ? errno : EIO;
  if (std::fclose(out) != 0 && !error) error = errno;
  return error;
}

int appendLine(const std::filesystem::path& file, std::string_view line) {
  std::FILE* out = _wfopen(file.c_str(), L"ab+");
  if (!out) return errno;
  int error = 0;
  errno = 0;
  const bool begun = std::fseek(out, -1, SEEK_END) == 0 && std::fgetc(out) != '\n';
  const std::string bytes = (begun ? "\n" : "") + std::string(line) + "\n";
  if (std::fwrite(bytes.data(), 1, bytes.size(), out) != bytes.size() || std::fflush(out) != 0)
    error = errno ? errno : EIO;
  if (std::fclose(out) != 0 && !error) error = errno;
  return error;
}

int readBytes(const std::filesystem::path& file, std::string& bytes) {
  std::FILE* in = _wfopen(file.c_str(), L"rb");
  if (!in) return errno;
  std::vector<char> chunk(1 << 16);
  std::size_t got = 0;
  while ((got = std::fread(chunk.data(), 1, chunk.size(), in)) > 0) bytes.append(chunk.data(), got);
  const int error = std::ferror(in) ? EIO : 0;
  std::fclose(in);
  return error;
}

int runProgram(const std::vector<std::string>& program_and_arguments, const std::filesystem::path& log) {
  std::wstring line;
  for (const std::string& argument : program_and_arguments)
    line += (line.empty() ? L"" : L" ") + quoted(std::filesystem::path(argument).wstring());
  SECURITY_ATTRIBUTES inherited{sizeof inherited, nullptr, TRUE};
  const HANDLE output = CreateFileW(log.c_str(), FILE_APPEND_DATA, FILE_SHARE_READ, &inherited, OPEN_ALWAYS,
                                    FILE_ATTRIBUTE_NORMAL, nullptr);
  STARTUPINFOW start{};
  start.cb = sizeof start;
  start.dwFlags = STARTF_USESTDHANDLES;
  start.hStdOutput = start.hStdError = output;
  PROCESS_INFORMATION process{};
  const bool started = CreateProcessW(nullptr, line.data(), nullptr, nullptr, TRUE, CREATE_NO_WINDOW, nullptr,
                                      nullptr, &start, &process) != 0;
  DWORD status = 127;
  if (started) {
    WaitForSingleObject(process.hProcess, INFINITE);
    GetExitCodeProcess(process.hProcess, &status);
    CloseHandle(process.hThread);
    CloseHandle(process.hProcess);
  }
  if (output != INVALID_HANDLE_VALUE) CloseHandle(output);
  return static_cast<int>(status);
}

// A user's folders are closed to others there already.
PrivateFiles::PrivateFiles() : before_(0) {}
PrivateFiles::~PrivateFiles() = default;

FileLock::FileLock(const std::filesystem::path& file)
    : handle_(reinterpret_cast<std::intptr_t>(CreateFileW(file.c_str(), GENERIC_READ | GENERIC_WRITE,
                                                          FILE_SHARE_READ | FILE_SHARE_WRITE, nullptr,
                                                          OPEN_ALWAYS, FILE_ATTRIBUTE_NORMAL, nullptr))) {
  OVERLAPPED whole{};
  const auto handle = reinterpret_cast<HANDLE>(handle_);
  if (handle != INVALID_HANDLE_VALUE)
    LockFileEx(handle, LOCKFILE_EXCLUSIVE_LOCK, 0, MAXDWORD, MAXDWORD, &whole);
}
FileLock::~FileLock() {
  const auto handle = reinterpret_cast<HANDLE>(handle_);
  if (handle != INVALID_HANDLE_VALUE) CloseHandle(handle);
}

}  // namespace rosefusion
#endif
