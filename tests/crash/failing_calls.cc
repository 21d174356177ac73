// A library preloaded into the program (LD_PRELOAD) that makes one system call or allocation fail. It counts, over all
// processes, either system calls that write below a folder, or large allocations.
#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstdarg>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <new>
#include <string>
#include <string_view>

#include <dlfcn.h>
#include <fcntl.h>
#include <sys/auxv.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

namespace {

/// Returns the C library's function of this name, which this library replaces.
template <class F>
F* real(const char* name) {
  return reinterpret_cast<F*>(::dlsym(RTLD_NEXT, name));
}

/// Parameters set by the test: index of the call to fail, and a counter in a file that all processes map.
class Plan {
 public:
  explicit Plan(const char* turn) {
    const char *counter = std::getenv("CRASH_COUNTER"), *at = std::getenv(turn);
    if (counter == nullptr || at == nullptr) return;
    const int file = real<int(const char*, int, ...)>("open")(counter, O_RDWR | O_CLOEXEC);
    if (file < 0) std::abort();
    void* mapped = real<void*(void*, std::size_t, int, int, int, off_t)>("mmap")(
        nullptr, sizeof *calls_, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
    real<int(int)>("close")(file);
    if (mapped == MAP_FAILED) std::abort();
    failing_ = std::strtoull(at, nullptr, 10);
    calls_ = static_cast<std::atomic<std::uint64_t>*>(mapped);
  }
  bool is_next() const { return calls_ != nullptr && calls_->fetch_add(1) + 1 == failing_; }

 private:
  std::atomic<std::uint64_t>* calls_ = nullptr;
  std::uint64_t failing_ = 0;
};

/// True if this call must fail.
bool fails(std::string_view path, int error) {
  static const char* const below = std::getenv("CRASH_BELOW");
  static const Plan plan("CRASH_AT");
  if (below == nullptr || !path.starts_with(below) || !plan.is_next()) return false;
  errno = error;
  return true;
}

bool fails(int file, int error) {
  char path[4096];
  const int before = errno;
  const ssize_t size = ::readlink(("/proc/self/fd/" + std::to_string(file)).c_str(), path, sizeof path);
  errno = before;
  return size > 0 && fails(std::string_view(path, static_cast<std::size_t>(size)), error);
}

bool is_for_writing(int flags) { return (flags & (O_WRONLY | O_RDWR | O_CREAT)) != 0; }

/// Only allocations of at least this size fail. Smaller ones are too many, and hosts run out of memory at large ones
/// first.
constexpr std::size_t kLargeAllocation = 4096;

/// True if the caller is the program's own code. Libraries handle failed allocations in their own way.
bool is_of_program(const void* code) {
  static const void* const program = [] {
    Dl_info entry{};
    ::dladdr(reinterpret_cast<const void*>(::getauxval(AT_ENTRY)), &entry);
    return static_cast<const void*>(entry.dli_fbase);
  }();
  Dl_info info{};
  return ::dladdr(code, &info) != 0 && info.dli_fbase == program;
}

}  // namespace

void* operator new(std::size_t size) {
  static const Plan plan("CRASH_ALLOCATION");
  if (size >= kLargeAllocation && is_of_program(__builtin_return_address(0)) && plan.is_next()) throw std::bad_alloc();
  void* room = std::malloc(std::max<std::size_t>(size, 1));
  if (room == nullptr) throw std::bad_alloc();
  return room;
}

extern "C" {

int open(const char* path, int flags, ...) {
  va_list rest;
  va_start(rest, flags);
  const mode_t mode = (flags & (O_CREAT | O_TMPFILE)) != 0 ? va_arg(rest, mode_t) : 0;
  va_end(rest);
  if (is_for_writing(flags) && fails(path, ENOSPC)) return -1;
  return real<int(const char*, int, ...)>("open")(path, flags, mode);
}

ssize_t write(int file, const void* bytes, std::size_t size) {
  if (fails(file, ENOSPC)) return -1;
  return real<ssize_t(int, const void*, std::size_t)>("write")(file, bytes, size);
}

ssize_t pwrite(int file, const void* bytes, std::size_t size, off_t at) {
  if (fails(file, ENOSPC)) return -1;
  return real<ssize_t(int, const void*, std::size_t, off_t)>("pwrite")(file, bytes, size, at);
}

std::size_t fwrite(const void* bytes, std::size_t size, std::size_t count, FILE* file) {
  if (fails(::fileno(file), ENOSPC)) return 0;
  return real<std::size_t(const void*, std::size_t, std::size_t, FILE*)>("fwrite")(bytes, size, count, file);
}

FILE* fopen(const char* path, const char* mode) {
  if (mode[0] != 'r' && fails(path, ENOSPC)) return nullptr;
  return real<FILE*(const char*, const char*)>("fopen")(path, mode);
}

FILE* fopen64(const char* path, const char* mode) {
  if (mode[0] != 'r' && fails(path, ENOSPC)) return nullptr;
  return real<FILE*(const char*, const char*)>("fopen64")(path, mode);
}

int close(int file) {
  const bool failed = fails(file, EIO);
  const int result = real<int(int)>("close")(file);
  return failed ? -1 : result;
}

int fsync(int file) { return fails(file, EIO) ? -1 : real<int(int)>("fsync")(file); }

int fdatasync(int file) { return fails(file, EIO) ? -1 : real<int(int)>("fdatasync")(file); }

int ftruncate(int file, off_t size) {
  return fails(file, ENOSPC) ? -1 : real<int(int, off_t)>("ftruncate")(file, size);
}

int rename(const char* from, const char* to) {
  return fails(to, EIO) ? -1 : real<int(const char*, const char*)>("rename")(from, to);
}

int renameat2(int from_folder, const char* from, int to_folder, const char* to, unsigned flags) {
  if (fails(to, EIO)) return -1;
  return real<int(int, const char*, int, const char*, unsigned)>("renameat2")(from_folder, from, to_folder, to, flags);
}

int mkdir(const char* path, mode_t mode) {
  return fails(path, ENOSPC) ? -1 : real<int(const char*, mode_t)>("mkdir")(path, mode);
}

void* mmap(void* address, std::size_t size, int access, int flags, int file, off_t at) {
  if (file >= 0 && fails(file, ENOMEM)) return MAP_FAILED;
  return real<void*(void*, std::size_t, int, int, int, off_t)>("mmap")(address, size, access, flags, file, at);
}

}  // extern "C"
