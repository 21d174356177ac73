#include "tools/studies/sweep/store/lock.h"

#include <array>
#include <cerrno>
#include <system_error>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include "sim/error.h"
#include "sim/io/printable.h"

namespace tools::sweep {
namespace {

constexpr std::size_t kMostNote = 512;

[[noreturn]] void give_up_locking(const std::filesystem::path& path, int error) {
  throw sim::IoError(
      fmt::format("{}: cannot be locked: {}", sim::printable(path.string()), std::generic_category().message(error)));
}

struct flock whole_file(short type) {
  struct flock range {};
  range.l_type = type;
  range.l_whence = SEEK_SET;
  return range;
}

/// Contents of a lock's file, as far as a note may be long.
std::string note_of(int file) {
  std::array<char, kMostNote> text{};
  const ssize_t size = ::pread(file, text.data(), text.size(), 0);
  return {text.data(), static_cast<std::size_t>(size < 0 ? 0 : size)};
}

/// A lock's file is empty or holds a note, "host PID" and the end of a line. Anything else is somebody's.
bool is_ours(int file) {
  struct stat open {};
  if (::fstat(file, &open) != 0 || !S_ISREG(open.st_mode) || open.st_size > static_cast<off_t>(kMostNote)) return false;
  const std::string note = note_of(file);
  const std::size_t space = note.rfind(' ');
  return open.st_size == 0 ||
         (space != std::string::npos && note.find_first_not_of("0123456789", space + 1) == note.size() - 1 &&
          note.ends_with('\n'));
}

/// Is this open file still the one of that name? Whoever lets go of a lock removes its file.
bool is_still_there(int file, const std::filesystem::path& path) {
  struct stat open {
  }, named{};
  return ::fstat(file, &open) == 0 && ::stat(path.c_str(), &named) == 0 && open.st_ino == named.st_ino &&
         open.st_dev == named.st_dev;
}

}  // namespace

std::optional<Lock> Lock::attempt(const std::filesystem::path& path, const std::string& note) {
  for (;;) {
    const int file = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, 0666);
    if (file < 0 && errno != ELOOP) give_up_locking(path, errno);
    if (file < 0 || !is_ours(file)) {
      if (file >= 0) ::close(file);
      throw sim::InputError(sim::printable(path.string()) +
                            ": is somebody's file, not a lock of ours; allowed: another folder");
    }
    struct flock range = whole_file(F_WRLCK);
    if (::fcntl(file, F_OFD_SETLK, &range) != 0) {
      const int error = errno;
      ::close(file);
      if (error == EAGAIN || error == EACCES) return std::nullopt;
      give_up_locking(path, error);
    }
    if (is_still_there(file, path)) {
      if (!note.empty() && (::ftruncate(file, 0) != 0 ||
                            ::pwrite(file, note.data(), note.size(), 0) != static_cast<ssize_t>(note.size()))) {
        const int error = errno;
        ::unlink(path.c_str());
        ::close(file);
        give_up_locking(path, error);
      }
      return Lock(path, file);
    }
    ::close(file);
  }
}

std::optional<std::string> Lock::holder(const std::filesystem::path& path) {
  const int file = ::open(path.c_str(), O_RDWR | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
  if (file < 0) return std::nullopt;
  struct flock range = whole_file(F_WRLCK);
  std::optional<std::string> note;
  if (::fcntl(file, F_OFD_GETLK, &range) == 0 && range.l_type != F_UNLCK) note = note_of(file);
  ::close(file);
  return note;
}

Lock::~Lock() {
  if (file_ < 0) return;
  ::unlink(path_.c_str());
  ::close(file_);
}

}  // namespace tools::sweep
