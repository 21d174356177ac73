#include "sim/io/file.h"

#include <algorithm>
#include <array>
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

std::string error_text(int error) { return std::generic_category().message(error); }

/// An open file descriptor, closed by the destructor.
class Descriptor {
 public:
  explicit Descriptor(int fd) : fd_(fd) {}
  Descriptor(const std::filesystem::path& path, int flags) : Descriptor(::open(path.c_str(), flags | O_CLOEXEC)) {}
  ~Descriptor() {
    if (fd_ >= 0) ::close(fd_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;

  bool is_open() const { return fd_ >= 0; }
  int descriptor_number() const { return fd_; }

 private:
  const int fd_;
};

constexpr std::string_view kTemporary = ".raywatt-tmp";  // part of all temporary names; not used by other programs

/// True if the open file still has the name `path`. False if another process has removed or replaced it.
bool is_file_named(int file, const std::filesystem::path& path) {
  struct stat open {
  }, named{};
  return ::fstat(file, &open) == 0 && ::lstat(path.c_str(), &named) == 0 && open.st_ino == named.st_ino &&
         open.st_dev == named.st_dev;
}

enum class Kind : std::uint8_t { kFile, kFolder };

/// Creates a temporary file or folder that does not exist yet, and locks it. Returns its descriptor, or -1 with the
/// error in errno: EEXIST if the name is taken. File systems without locks are accepted.
int create_locked(const std::filesystem::path& path, Kind kind) {
  int file = -1;
  if (kind == Kind::kFile) {
    file = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
  } else if (::mkdir(path.c_str(), 0777) == 0) {
    file = ::open(path.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
    if (file < 0 && errno != ENOENT) {
      const int error = errno;
      ::rmdir(path.c_str());
      errno = error;
    }
  }
  if (file < 0) return file;
  // Before the file was locked, another process may have considered it stale and removed it.
  const bool is_taken = ::flock(file, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK;
  if (!is_taken && is_file_named(file, path)) return file;
  ::close(file);
  errno = EEXIST;
  return -1;
}

/// Removes the entries of a folder for which matches(name) is true and whose locks are free.
void remove_stale_entries(const std::filesystem::path& folder, const std::function<bool(const std::string&)>& matches) {
  std::error_code failed, ignored;
  std::filesystem::directory_iterator entry(folder, failed);
  for (; !failed && entry != std::filesystem::directory_iterator(); entry.increment(failed)) {
    const std::filesystem::path& path = entry->path();
    if (!matches(path.filename().string())) continue;
    const Descriptor stale(path, O_RDONLY | O_NOFOLLOW | O_NONBLOCK);
    const bool is_free = stale.is_open() && ::flock(stale.descriptor_number(), LOCK_EX | LOCK_NB) == 0 &&
                         is_file_named(stale.descriptor_number(), path);
    if (is_free) std::filesystem::remove_all(path, ignored);
  }
}

/// Removes ".PID-N" (or ".PID.N", as former versions named folders) from the end of a text. Returns false if the text
/// does not end like this.
bool remove_process_and_number(std::string_view& text) {
  constexpr std::string_view kDigits = "0123456789";
  for (const std::string_view separators : {"-.", "."}) {
    const std::size_t digits = text.find_last_not_of(kDigits);
    const bool is_number = digits != text.npos && digits + 1 != text.size();
    if (!is_number || separators.find(text[digits]) == separators.npos) return false;
    text = text.substr(0, digits);
  }
  return true;
}

bool is_temporary_folder_name(std::string_view name) {
  if (!name.starts_with('.') || !name.ends_with(kTemporary)) return false;
  name.remove_suffix(kTemporary.size());
  return remove_process_and_number(name) && name.size() > 1;
}

std::filesystem::path parent_of(const std::filesystem::path& path) {
  return path.has_parent_path() ? path.parent_path() : ".";
}

[[noreturn]] void throw_write_error(const std::filesystem::path& path, int error) {
  throw IoError(fmt::format("{}: cannot be written: {}", printable(path.string()), error_text(error)));
}

}  // namespace

std::string read_file(const std::filesystem::path& path, std::uint64_t max_bytes) {
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
  if (!file.is_open()) throw InputError(fmt::format("{}: cannot be opened: {}", shown, error_text(errno)));
  const auto refuse_size = [&] {
    throw InputError(fmt::format("{}: is too large; allowed: {} bytes", shown, max_bytes));
  };
  struct stat about {};
  if (::fstat(file.descriptor_number(), &about) == 0 && static_cast<std::uint64_t>(about.st_size) > max_bytes)
    refuse_size();
  std::string bytes;
  for (;;) {
    constexpr std::size_t kPiece = 1 << 17;
    const std::size_t size = bytes.size();
    bytes.resize(size + kPiece);
    const ssize_t got = ::read(file.descriptor_number(), bytes.data() + size, kPiece);
    if (got < 0 && errno != EINTR) throw IoError(fmt::format("{}: cannot be read: {}", shown, error_text(errno)));
    bytes.resize(size + static_cast<std::size_t>(std::max<ssize_t>(got, 0)));
    if (bytes.size() > max_bytes) refuse_size();
    if (got == 0) return bytes;
  }
}

void remove_stale_files(const std::filesystem::path& path) {
  remove_stale_entries(parent_of(path),
                       [&](const std::string& name) { return is_temporary_name(name, path.filename()); });
}

static void check_replaceable(const std::filesystem::path& path, const ReplaceableOutput& replaceable) {
  using Type = std::filesystem::file_type;
  const std::string shown = printable(path.string());
  std::error_code failed;
  const Type type = std::filesystem::symlink_status(path, failed).type();
  if (type == Type::not_found) return;
  if (type == Type::none) throw InputError(fmt::format("{}: cannot be written: {}", shown, failed.message()));
  if (type == Type::directory) throw InputError(shown + ": is a folder, not a file");
  if (type != Type::regular) {  // opening a pipe would block until it has a writer
    throw InputError(fmt::format("{}: is there and is {}; allowed: a new file, or a {} to be replaced", shown,
                                 type == Type::symlink ? "a link" : "not a regular file", replaceable.kind));
  }
  if (replaceable.any) return;
  std::string start(512, '\0');
  std::ifstream file(path, std::ios::binary);
  file.read(start.data(), static_cast<std::streamsize>(start.size()));
  start.resize(static_cast<std::size_t>(file.gcount()));
  if (replaceable.mark.empty() || start.find(replaceable.mark) == std::string::npos) {
    throw InputError(fmt::format("{}: is there and is no {}; allowed: a new file, or a {} to be replaced", shown,
                                 replaceable.kind, replaceable.kind));
  }
}

/// Checks that the folder of `path` exists and accepts new files, because a temporary file is written there first.
static void check_folder_of(const std::filesystem::path& path) {
  const std::string shown = printable(path.string());
  const std::filesystem::path folder = parent_of(path);
  std::error_code failed;
  if (!std::filesystem::is_directory(folder, failed)) {
    throw InputError(
        fmt::format("{}: cannot be written: there is no folder {}; make it first", shown, printable(folder.string())));
  }
  if (::faccessat(AT_FDCWD, folder.c_str(), W_OK | X_OK, AT_EACCESS) == 0) return;
  throw InputError(fmt::format("{}: cannot be written into its folder: {}", shown, error_text(errno)));
}

void check_output(const std::filesystem::path& path, const ReplaceableOutput& replaceable) {
  check_replaceable(path, replaceable);
  check_folder_of(path);
  remove_stale_files(path);
}

NewFile::NewFile(std::filesystem::path path) : path_(std::move(path)) {
  const std::string extension = path_.extension().string();
  for (int n = 0; n < 1000 && (n == 0 || errno == EEXIST); ++n) {
    temporary_ = path_;
    temporary_.replace_extension(fmt::format(".{}-{}{}{}", ::getpid(), n, kTemporary, extension));
    file_ = create_locked(temporary_, Kind::kFile);
    if (file_ >= 0) return;
  }
  throw_error();
}

NewFile::~NewFile() {
  if (file_ >= 0) ::close(file_);
  if (!temporary_.empty()) ::unlink(temporary_.c_str());
}

void NewFile::throw_error() const { throw_write_error(path_, errno); }

/// Writes all bytes to an open file. On failure, returns false with the error in errno.
static bool write_all(int file, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(file, bytes.data(), bytes.size());
    if (written < 0 && errno != EINTR) return false;
    if (written > 0) bytes.remove_prefix(static_cast<std::size_t>(written));
  }
  return true;
}

void NewFile::write(std::string_view bytes) {
  if (!write_all(file_, bytes)) throw_error();
}

void NewFile::commit() {
  if (::fsync(file_) != 0) throw_error();
  // Keeps the lock until the rename. Without the lock, another process might remove the file as stale.
  const Descriptor locked(::fcntl(file_, F_DUPFD_CLOEXEC, 0));
  if (::close(std::exchange(file_, -1)) != 0) throw_error();  // some file systems report a full disk only at close
  if (::rename(temporary_.c_str(), path_.c_str()) != 0) throw_error();
  temporary_.clear();
  const Descriptor folder(parent_of(path_), O_RDONLY | O_DIRECTORY);
  if (folder.is_open()) ::fsync(folder.descriptor_number());
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
  const bool regular = file.is_open() && ::fstat(file.descriptor_number(), &about) == 0 && S_ISREG(about.st_mode);
  if (regular && write_all(file.descriptor_number(), bytes)) return;
  throw IoError(fmt::format("{}: cannot be written: {}", printable(path.string()),
                            file.is_open() && !regular ? "it is not a regular file" : error_text(errno)));
}

void sync_to_disk(const std::filesystem::path& path) {
  const Descriptor file(path, O_RDONLY);
  if (!file.is_open() || ::fsync(file.descriptor_number()) != 0) throw_write_error(path, errno);
}

void make_folders(const std::filesystem::path& path) {
  std::error_code error;
  if (std::filesystem::is_directory(path, error)) return;
  const std::filesystem::path parent = std::filesystem::absolute(path).lexically_normal().parent_path();
  if (parent != path) make_folders(parent);
  if (std::filesystem::create_directory(path, error)) sync_to_disk(parent);
  if (error) throw_write_error(path, error == std::errc::file_exists ? ENOTDIR : error.value());
}

bool is_temporary_name(std::string_view name, const std::filesystem::path& target) {
  const std::string begin = target.stem().string(), end = std::string(kTemporary) + target.extension().string();
  if (!name.ends_with(end)) return false;
  name.remove_suffix(end.size());
  return remove_process_and_number(name) && name == begin;
}

NewFolder::NewFolder(std::filesystem::path target, const std::filesystem::path& parent)
    : target_(std::move(target)), parent_(parent.empty() ? target_.parent_path() : parent) {}

NewFolder::~NewFolder() {
  std::error_code ignored;
  if (!temporary_.empty()) std::filesystem::remove_all(temporary_, ignored);
  for (const std::filesystem::path& parent : made_parents_) std::filesystem::remove(parent, ignored);
  if (lock_ >= 0) ::close(lock_);
}

std::error_code NewFolder::make() {
  std::error_code error;
  for (std::filesystem::path p = parent_; !std::filesystem::exists(p, error) && p.has_relative_path();
       p = p.parent_path()) {
    made_parents_.push_back(p);
  }
  for (int n = 0; n < 100; ++n) {
    std::filesystem::create_directories(parent_, error);
    if (error) continue;  // another process may have just removed a parent that it had created
    temporary_ = parent_ / fmt::format(".{}.{}-{}{}", target_.filename().string(), ::getpid(), n, kTemporary);
    lock_ = create_locked(temporary_, Kind::kFolder);
    if (lock_ >= 0) return {};
    error = {errno, std::generic_category()};
    temporary_.clear();
    if (error != std::errc::file_exists && error != std::errc::no_such_file_or_directory) break;
  }
  return error;
}

void NewFolder::remove_stale() const { remove_stale_entries(parent_, is_temporary_folder_name); }

namespace {

constexpr std::size_t kMostNote = 512;

[[noreturn]] void throw_lock_error(const std::filesystem::path& path, int error) {
  throw IoError(fmt::format("{}: cannot be locked: {}", printable(path.string()), error_text(error)));
}

// Returns a description of a lock on the whole file, for fcntl(). Other hosts see such a lock, but no lock of flock().
struct flock whole_file_lock() {
  struct flock range {};
  range.l_type = F_WRLCK;
  range.l_whence = SEEK_SET;
  return range;
}

std::string read_note(int file) {
  std::array<char, kMostNote> text{};
  const ssize_t size = ::pread(file, text.data(), text.size(), 0);
  return {text.data(), static_cast<std::size_t>(size < 0 ? 0 : size)};
}

/// True if an open file is a lock file of this program: it is empty or contains one line "HOST PID".
bool is_lock_file(int file) {
  struct stat open {};
  if (::fstat(file, &open) != 0 || !S_ISREG(open.st_mode) || open.st_size > static_cast<off_t>(kMostNote)) return false;
  const std::string note = read_note(file);
  const std::size_t space = note.rfind(' ');
  return open.st_size == 0 ||
         (space != std::string::npos && note.find_first_not_of("0123456789", space + 1) == note.size() - 1 &&
          note.ends_with('\n'));
}

}  // namespace

std::optional<FileLock> FileLock::try_acquire(const std::filesystem::path& path, const std::string& note) {
  for (;;) {
    const int file = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, 0666);
    if (file < 0 && errno != ELOOP) throw_lock_error(path, errno);
    if (file < 0 || !is_lock_file(file)) {
      if (file >= 0) ::close(file);
      throw InputError(printable(path.string()) + ": is not a lock file of Raywatt; allowed: another folder");
    }
    struct flock range = whole_file_lock();
    if (::fcntl(file, F_OFD_SETLK, &range) != 0) {
      const int error = errno;
      ::close(file);
      if (error == EAGAIN || error == EACCES) return std::nullopt;
      throw_lock_error(path, error);
    }
    if (is_file_named(file, path)) {  // false if the former holder has just removed the file
      if (!note.empty() && (::ftruncate(file, 0) != 0 ||
                            ::pwrite(file, note.data(), note.size(), 0) != static_cast<ssize_t>(note.size()))) {
        const int error = errno;
        ::unlink(path.c_str());
        ::close(file);
        throw_lock_error(path, error);
      }
      return FileLock(path, file);
    }
    ::close(file);
  }
}

std::optional<std::string> FileLock::read_holder(const std::filesystem::path& path) {
  const Descriptor file(path, O_RDWR | O_NOFOLLOW | O_NONBLOCK);
  struct flock range = whole_file_lock();
  const bool is_held =
      file.is_open() && ::fcntl(file.descriptor_number(), F_OFD_GETLK, &range) == 0 && range.l_type != F_UNLCK;
  return is_held ? std::optional(read_note(file.descriptor_number())) : std::nullopt;
}

FileLock::~FileLock() {
  if (file_ < 0) return;
  ::unlink(path_.c_str());
  ::close(file_);
}

}  // namespace sim
