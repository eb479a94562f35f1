// Preloaded (LD_PRELOAD), it lets one call of a file function fail for what lies under FAULT_FOLDER: the
// FAULT_CALL-th (from 1 on) of FAULT_COMMAND, one of kNames, with the number FAULT_RESULT as errno; 0: a
// write or a read takes half of what it is given. FAULT_COUNTS names a file that the numbers of calls are
// written to at the end.
#include <dlfcn.h>
#include <fcntl.h>
#include <stdarg.h>
#include <sys/stat.h>
#include <sys/uio.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <climits>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>

namespace {

enum Function { kOpen, kOpenToRead, kWrite, kRead, kClose, kRename, kUnlink, kMkdir, kFsync, kFunctions };
constexpr const char* kNames[] = {"open",   "open_to_read", "write", "read", "close",
                                  "rename", "unlink",       "mkdir", "fsync"};
std::atomic<unsigned long long> calls[kFunctions];
std::atomic<bool> inside[4096];  // file descriptors

const char* variable(const char* name) {
  const char* value = std::getenv(name);
  return value ? value : "";
}

bool isInside(const char* path) {
  const char* folder = variable("FAULT_FOLDER");
  if (!path || !*folder) return false;
  std::string whole = path;
  char here[PATH_MAX];
  if (path[0] != '/' && getcwd(here, sizeof here)) whole = std::string(here) + "/" + path;
  return whole.compare(0, std::strlen(folder), folder) == 0;
}
bool isInside(int descriptor) {
  return descriptor >= 0 && descriptor < 4096 && inside[descriptor];
}
bool isInside(int folder, const char* path) {
  return (path && path[0] != '/' && folder != AT_FDCWD) ? isInside(folder) : isInside(path);
}
int noted(int descriptor, bool is_inside) {
  if (descriptor >= 0 && descriptor < 4096) inside[descriptor] = is_inside;
  return descriptor;
}

/// Whether this is the call that fails; errno is set then.
bool fails(Function function) {
  const unsigned long long call = ++calls[function];
  if (std::strcmp(variable("FAULT_COMMAND"), kNames[function]) != 0 ||
      call != std::strtoull(variable("FAULT_CALL"), nullptr, 10))
    return false;
  errno = std::atoi(variable("FAULT_RESULT"));
  return true;
}
bool failsToOpen(int flags) {
  return !(flags & O_DIRECTORY) && fails(flags & (O_WRONLY | O_RDWR) ? kOpen : kOpenToRead);
}

/// The C library's own.
template <typename F>
F* real(const char* name) {
  return reinterpret_cast<F*>(dlsym(RTLD_NEXT, name));
}

[[gnu::destructor]] void writeCounts() {
  bool any = false;  // of a shell around the program there are none
  for (const auto& of_function : calls) any |= of_function > 0;
  const char* file = any ? variable("FAULT_COUNTS") : "";
  const int out =
      *file ? real<int(const char*, int, ...)>("open")(file, O_WRONLY | O_CREAT | O_TRUNC, 0644) : -1;
  if (out < 0) return;
  for (int f = 0; f < kFunctions; ++f)
    if (calls[f] > 0) dprintf(out, "%s %llu\n", kNames[f], calls[f].load());
  real<int(int)>("close")(out);
}

unsigned modeOf(int flags, va_list list) {
  return flags & O_CREAT || (flags & O_TMPFILE) == O_TMPFILE ? va_arg(list, unsigned) : 0;
}
int openReally(const char* function, const char* path, int flags, va_list list) {
  const unsigned mode = modeOf(flags, list);
  const bool is_inside = isInside(path);
  if (is_inside && failsToOpen(flags)) return -1;
  return noted(real<int(const char*, int, ...)>(function)(path, flags, mode), is_inside);
}
int openReally(const char* function, int folder, const char* path, int flags, va_list list) {
  const unsigned mode = modeOf(flags, list);
  const bool is_inside = isInside(folder, path);
  if (is_inside && failsToOpen(flags)) return -1;
  return noted(real<int(int, const char*, int, ...)>(function)(folder, path, flags, mode), is_inside);
}
std::FILE* openReally(const char* function, const char* path, const char* mode) {
  const bool is_inside = isInside(path);
  if (is_inside && fails(std::strpbrk(mode, "wa+") ? kOpen : kOpenToRead)) return nullptr;
  std::FILE* file = real<std::FILE*(const char*, const char*)>(function)(path, mode);
  if (file) noted(fileno(file), is_inside);
  return file;
}

}  // namespace

extern "C" {

#define OPEN(name)                                           \
  int name(const char* path, int flags, ...) {               \
    va_list list;                                            \
    va_start(list, flags);                                   \
    const int opened = openReally(#name, path, flags, list); \
    va_end(list);                                            \
    return opened;                                           \
  }
OPEN(open)
OPEN(open64)
#define OPENAT(name)                                                 \
  int name(int folder, const char* path, int flags, ...) {           \
    va_list list;                                                    \
    va_start(list, flags);                                           \
    const int opened = openReally(#name, folder, path, flags, list); \
    va_end(list);                                                    \
    return opened;                                                   \
  }
OPENAT(openat)
OPENAT(openat64)
std::FILE* fopen(const char* path, const char* mode) {
  return openReally("fopen", path, mode);
}
std::FILE* fopen64(const char* path, const char* mode) {
  return openReally("fopen64", path, mode);
}

ssize_t write(int descriptor, const void* bytes, size_t count) {
  if (isInside(descriptor) && fails(kWrite)) {
    if (errno != 0) return -1;
    count = (count + 1) / 2;
  }
  return real<ssize_t(int, const void*, size_t)>("write")(descriptor, bytes, count);
}
ssize_t writev(int descriptor, const iovec* parts, int count) {
  if (isInside(descriptor) && fails(kWrite)) {
    if (errno != 0) return -1;
    return real<ssize_t(int, const void*, size_t)>("write")(descriptor, parts[0].iov_base, parts[0].iov_len);
  }
  return real<ssize_t(int, const iovec*, int)>("writev")(descriptor, parts, count);
}
ssize_t read(int descriptor, void* bytes, size_t count) {
  if (isInside(descriptor) && fails(kRead)) {
    if (errno != 0) return -1;
    count = (count + 1) / 2;
  }
  return real<ssize_t(int, void*, size_t)>("read")(descriptor, bytes, count);
}
/// As Linux does, it closes even when it fails.
int close(int descriptor) {
  const bool failed = isInside(descriptor) && fails(kClose);
  const int code = errno;
  noted(descriptor, false);
  const int closed = real<int(int)>("close")(descriptor);
  if (!failed || code == 0) return closed;
  errno = code;
  return -1;
}
int fclose(std::FILE* file) {
  const int descriptor = fileno(file);
  const bool failed = isInside(descriptor) && fails(kClose);
  const int code = errno;
  noted(descriptor, false);
  const int closed = real<int(std::FILE*)>("fclose")(file);
  if (!failed || code == 0) return closed;
  errno = code;
  return EOF;
}
int fsync(int descriptor) {
  return isInside(descriptor) && fails(kFsync) ? -1 : real<int(int)>("fsync")(descriptor);
}

int rename(const char* from, const char* to) {
  return isInside(to) && fails(kRename) ? -1 : real<int(const char*, const char*)>("rename")(from, to);
}
int remove(const char* path) {
  return isInside(path) && fails(kUnlink) ? -1 : real<int(const char*)>("remove")(path);
}
int unlink(const char* path) {
  return isInside(path) && fails(kUnlink) ? -1 : real<int(const char*)>("unlink")(path);
}
int unlinkat(int folder, const char* path, int flags) {
  return isInside(folder, path) && fails(kUnlink)
             ? -1
             : real<int(int, const char*, int)>("unlinkat")(folder, path, flags);
}
int mkdir(const char* path, mode_t mode) {
  return isInside(path) && fails(kMkdir) ? -1 : real<int(const char*, mode_t)>("mkdir")(path, mode);
}

}  // extern "C"
