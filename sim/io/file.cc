#include "sim/io/file.h"

#include <algorithm>
#include <cerrno>
#include <fstream>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "sim/error.h"
#include "sim/io/printable.h"

namespace sim {
namespace {

std::string reason(int error) { return std::generic_category().message(error); }

/// An open file descriptor.
class Descriptor {
 public:
  explicit Descriptor(int fd) : fd_(fd) {}
  Descriptor(const std::filesystem::path& path, int flags) : Descriptor(::open(path.c_str(), flags | O_CLOEXEC)) {}
  ~Descriptor() {
    if (fd_ >= 0) ::close(fd_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;

  bool valid() const { return fd_ >= 0; }
  int get() const { return fd_; }

 private:
  const int fd_;
};

constexpr std::string_view kTemporary = ".raywatt-tmp";  // nobody else calls a file so

}  // namespace

std::string read_file(const std::filesystem::path& path, std::uint64_t most_bytes) {
  const std::string shown = printable(path.string());
  std::error_code failed;
  const std::filesystem::file_status status = std::filesystem::status(path, failed);
  if (!std::filesystem::exists(status)) {
    const bool absent = status.type() == std::filesystem::file_type::not_found;
    throw InputError(fmt::format("{}: {}", shown, absent ? "no such file" : failed.message()));
  }
  if (std::filesystem::is_directory(status)) throw InputError(shown + ": is a folder, not a file");
  if (!std::filesystem::is_regular_file(status)) throw InputError(shown + ": is not a regular file");
  const Descriptor file(path, O_RDONLY);
  if (!file.valid()) throw InputError(fmt::format("{}: cannot be opened: {}", shown, reason(errno)));
  const auto refuse_size = [&] {
    throw InputError(fmt::format("{}: is too large; allowed: {} bytes", shown, most_bytes));
  };
  struct stat about {};
  if (::fstat(file.get(), &about) == 0 && static_cast<std::uint64_t>(about.st_size) > most_bytes) refuse_size();
  std::string bytes;
  for (;;) {
    constexpr std::size_t kPiece = 1 << 17;
    const std::size_t size = bytes.size();
    bytes.resize(size + kPiece);
    const ssize_t got = ::read(file.get(), bytes.data() + size, kPiece);
    if (got < 0 && errno != EINTR) throw IoError(fmt::format("{}: cannot be read: {}", shown, reason(errno)));
    bytes.resize(size + static_cast<std::size_t>(std::max<ssize_t>(got, 0)));
    if (bytes.size() > most_bytes) refuse_size();
    if (got == 0) return bytes;
  }
}

void remove_left_of(const std::filesystem::path& path) {
  std::error_code failed;
  std::filesystem::directory_iterator entry(path.has_parent_path() ? path.parent_path() : ".", failed);
  for (; !failed && entry != std::filesystem::directory_iterator(); entry.increment(failed)) {
    if (!is_left_of(entry->path().filename().string(), path.filename())) continue;
    const Descriptor left(entry->path(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK);
    if (left.valid() && ::flock(left.get(), LOCK_EX | LOCK_NB) == 0) ::unlink(entry->path().c_str());
  }
}

static void check_replaceable(const std::filesystem::path& path, const Replaceable& what) {
  using Type = std::filesystem::file_type;
  const std::string shown = printable(path.string());
  std::error_code failed;
  const Type type = std::filesystem::symlink_status(path, failed).type();
  if (type == Type::not_found) return;
  if (type == Type::none) throw InputError(fmt::format("{}: cannot be written: {}", shown, failed.message()));
  if (type == Type::directory) throw InputError(shown + ": is a folder, not a file");
  if (type != Type::regular) {  // to open a pipe is to wait for who writes into it
    throw InputError(fmt::format("{}: is there and is {}; allowed: a new file, or a {} to be replaced", shown,
                                 type == Type::symlink ? "a link" : "not a regular file", what.kind));
  }
  if (what.any) return;
  std::string start(512, '\0');
  std::ifstream file(path, std::ios::binary);
  file.read(start.data(), static_cast<std::streamsize>(start.size()));
  start.resize(static_cast<std::size_t>(file.gcount()));
  if (what.mark.empty() || start.find(what.mark) == std::string::npos) {
    throw InputError(fmt::format("{}: is there and is no {}; allowed: a new file, or a {} to be replaced", shown,
                                 what.kind, what.kind));
  }
}

/// A file that is replaced is written beside its place, too.
static void check_folder_of(const std::filesystem::path& path) {
  const std::string shown = printable(path.string());
  const std::filesystem::path folder = path.has_parent_path() ? path.parent_path() : ".";
  std::error_code failed;
  if (!std::filesystem::is_directory(folder, failed)) {
    throw InputError(
        fmt::format("{}: cannot be written: there is no folder {}; make it first", shown, printable(folder.string())));
  }
  if (::faccessat(AT_FDCWD, folder.c_str(), W_OK | X_OK, AT_EACCESS) == 0) return;
  throw InputError(fmt::format("{}: cannot be written into its folder: {}", shown, reason(errno)));
}

void check_output(const std::filesystem::path& path, const Replaceable& what) {
  check_replaceable(path, what);
  check_folder_of(path);
  remove_left_of(path);
}

NewFile::NewFile(std::filesystem::path path) : path_(std::move(path)) {
  const std::string extension = path_.extension().string();
  // Again if the name is taken: by what a killed process has left, by another thread, by a file of the user's.
  for (int n = 0; n < 1000 && (n == 0 || errno == EEXIST); ++n) {
    temporary_ = path_;
    temporary_.replace_extension(fmt::format(".{}-{}{}{}", ::getpid(), n, kTemporary, extension));
    file_ = ::open(temporary_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
    if (file_ < 0) continue;
    struct stat about {};
    if (::flock(file_, LOCK_EX | LOCK_NB) != 0 || ::fstat(file_, &about) != 0 || about.st_nlink != 0) return;
    ::close(std::exchange(file_, -1));  // taken for left in the moment before it was locked
    errno = EEXIST;
  }
  fail();
}

NewFile::~NewFile() {
  if (file_ >= 0) ::close(file_);
  if (!temporary_.empty()) ::unlink(temporary_.c_str());
}

void NewFile::fail() const {
  const int error = errno;
  throw IoError(fmt::format("{}: cannot be written: {}", printable(path_.string()), reason(error)));
}

/// Leaves in errno why it is false.
static bool write_all(int file, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(file, bytes.data(), bytes.size());
    if (written < 0 && errno != EINTR) return false;
    if (written > 0) bytes.remove_prefix(static_cast<std::size_t>(written));
  }
  return true;
}

void NewFile::write(std::string_view bytes) {
  if (!write_all(file_, bytes)) fail();
}

void NewFile::commit() {
  if (::fsync(file_) != 0) fail();
  // Holds the lock until the file has its name: without it another process takes the file for left.
  const Descriptor locked(::fcntl(file_, F_DUPFD_CLOEXEC, 0));
  if (::close(std::exchange(file_, -1)) != 0) fail();  // some file systems report a full disk only here
  if (::rename(temporary_.c_str(), path_.c_str()) != 0) fail();
  temporary_.clear();
  const Descriptor folder(path_.has_parent_path() ? path_.parent_path() : ".", O_RDONLY | O_DIRECTORY);
  if (folder.valid()) ::fsync(folder.get());
}

void write_file_atomically(const std::filesystem::path& path, std::string_view bytes) {
  NewFile file(path);
  file.write(bytes);
  file.commit();
}

void append_to_file(const std::filesystem::path& path, std::string_view bytes) {
  const Descriptor file(
      ::open(path.c_str(), O_WRONLY | O_APPEND | O_CREAT | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC, 0666));
  struct stat about {};
  const bool regular = file.valid() && ::fstat(file.get(), &about) == 0 && S_ISREG(about.st_mode);
  if (regular && write_all(file.get(), bytes)) return;
  throw IoError(fmt::format("{}: cannot be written: {}", printable(path.string()),
                            file.valid() && !regular ? "it is not a regular file" : reason(errno)));
}

bool is_left_of(std::string_view left, const std::filesystem::path& name) {
  const std::string begin = name.stem().string() + ".", end = std::string(kTemporary) + name.extension().string();
  if (!left.starts_with(begin) || !left.ends_with(end) || left.size() <= begin.size() + end.size()) return false;
  const std::string_view number = left.substr(begin.size(), left.size() - begin.size() - end.size());
  const std::size_t dash = number.find('-');
  if (dash == number.npos || dash == 0 || dash + 1 == number.size()) return false;
  return number.find_first_not_of("0123456789", dash + 1) == number.npos &&
         number.find_first_not_of("0123456789") == dash;
}

}  // namespace sim
