#include "tools/host/staging.h"

#include <cerrno>
#include <string_view>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

namespace tools {

namespace fs = std::filesystem;

namespace {

constexpr std::string_view kEnd = ".raywatt-tmp";  // as of files that are being written (sim/io/file.h)

/// True for the name of a temporary folder: ".NAME.PID.NUMBER.raywatt-tmp".
bool is_staging_name(std::string_view name) {
  if (!name.starts_with('.') || !name.ends_with(kEnd)) return false;
  name.remove_suffix(kEnd.size());
  for (int numbers = 0; numbers < 2; ++numbers) {
    const std::size_t digits = name.find_last_not_of("0123456789") + 1;
    if (digits < 2 || digits == name.size() || name[digits - 1] != '.') return false;
    name = name.substr(0, digits - 1);
  }
  return true;
}

}  // namespace

bool FolderLock::take(const fs::path& folder) {
  release();
  folder_ = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
  if (folder_ < 0 || ::flock(folder_, LOCK_EX | LOCK_NB) != 0) return false;
  struct stat locked {
  }, named{};
  if (::fstat(folder_, &locked) == 0 && ::lstat(folder.c_str(), &named) == 0 && locked.st_ino == named.st_ino &&
      locked.st_dev == named.st_dev)
    return true;
  errno = ENOENT;  // it is gone, or another has its name by now
  return false;
}

void FolderLock::release() {
  if (folder_ >= 0) ::close(folder_);
  folder_ = -1;
}

Staging::~Staging() {
  std::error_code ignored;
  if (!folder_.empty()) fs::remove_all(folder_, ignored);
  for (const fs::path& parent : made_) fs::remove(parent, ignored);  // unless something is in it by now
}

std::error_code Staging::make() {
  const fs::path parent = target_.parent_path();
  std::error_code error;
  for (fs::path p = parent; !fs::exists(p, error) && p.has_relative_path(); p = p.parent_path()) made_.push_back(p);
  remove_left();
  // Again if the name is taken by what a killed run has left, if another run has removed the parent it had made, or
  // takes the folder for left, having locked it first. File systems without locks will do.
  for (int n = 0; n < 100; ++n) {
    const fs::path folder = parent / fmt::format("{}{}.{}{}", begin(), ::getpid(), n, kEnd);
    fs::create_directories(parent, error);
    if (error || !fs::create_directory(folder, error)) continue;
    if (!lock_.take(folder) && (errno == EWOULDBLOCK || errno == ENOENT)) continue;
    folder_ = folder;
    return {};
  }
  return error ? error : std::make_error_code(std::errc::file_exists);
}

void Staging::remove_left() const {
  std::error_code failed, ignored;
  fs::directory_iterator entry(target_.parent_path(), failed);
  for (; !failed && entry != fs::directory_iterator(); entry.increment(failed)) {
    if (!is_staging_name(entry->path().filename().string())) continue;
    FolderLock lock;
    if (lock.take(entry->path())) fs::remove_all(entry->path(), ignored);
  }
}

}  // namespace tools
