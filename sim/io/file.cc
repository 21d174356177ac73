#include "sim/io/file.h"

#include <algorithm>
#include <cerrno>
#include <system_error>

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include "sim/error.h"
#include "sim/io/printable.h"

namespace sim {
namespace {

std::string reason(int error) { return std::generic_category().message(error); }

/// An open file descriptor.
class Descriptor {
 public:
  Descriptor(const std::filesystem::path& path, int flags) : fd_(::open(path.c_str(), flags | O_CLOEXEC, 0666)) {}
  ~Descriptor() {
    if (fd_ >= 0) ::close(fd_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;

  bool valid() const { return fd_ >= 0; }
  int get() const { return fd_; }
  /// Closes now and says whether that worked: some file systems report a full disk only here.
  bool close() {
    const int fd = fd_;
    fd_ = -1;
    return ::close(fd) == 0;
  }

 private:
  int fd_;
};

bool write_all(int fd, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(fd, bytes.data(), bytes.size());
    if (written < 0 && errno != EINTR) return false;
    if (written > 0) bytes.remove_prefix(static_cast<std::size_t>(written));
  }
  return true;
}

[[noreturn]] void give_up(const std::filesystem::path& temporary, const std::filesystem::path& path) {
  const int error = errno;
  ::unlink(temporary.c_str());
  throw IoError(fmt::format("{}: cannot be written: {}", printable(path.string()), reason(error)));
}

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
  std::string bytes;
  for (;;) {
    constexpr std::size_t kPiece = 1 << 17;
    const std::size_t size = bytes.size();
    bytes.resize(size + kPiece);
    const ssize_t got = ::read(file.get(), bytes.data() + size, kPiece);
    if (got < 0 && errno != EINTR) throw IoError(fmt::format("{}: cannot be read: {}", shown, reason(errno)));
    bytes.resize(size + static_cast<std::size_t>(std::max<ssize_t>(got, 0)));
    if (bytes.size() > most_bytes) {
      throw InputError(fmt::format("{}: is too large; allowed: {} bytes", shown, most_bytes));
    }
    if (got == 0) return bytes;
  }
}

std::filesystem::path temporary_name(const std::filesystem::path& path) {
  std::filesystem::path temporary = path;
  return temporary.replace_extension(".tmp" + path.extension().string());
}

void write_file_atomically(const std::filesystem::path& path, std::string_view bytes) {
  const std::filesystem::path temporary = temporary_name(path);
  Descriptor file(temporary, O_WRONLY | O_CREAT | O_TRUNC);
  if (!file.valid()) throw IoError(fmt::format("{}: cannot be written: {}", printable(path.string()), reason(errno)));
  if (!write_all(file.get(), bytes) || !file.close()) give_up(temporary, path);
  commit_file(temporary, path);
}

void commit_file(const std::filesystem::path& temporary, const std::filesystem::path& path) {
  {
    const Descriptor file(temporary, O_RDONLY);
    if (!file.valid() || ::fsync(file.get()) != 0) give_up(temporary, path);
  }
  if (::rename(temporary.c_str(), path.c_str()) != 0) give_up(temporary, path);
  const Descriptor folder(path.has_parent_path() ? path.parent_path() : ".", O_RDONLY | O_DIRECTORY);
  if (folder.valid()) ::fsync(folder.get());
}

}  // namespace sim
