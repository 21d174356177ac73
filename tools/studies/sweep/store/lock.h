#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <utility>

namespace tools::sweep {

/// A file that one process at a time holds. The kernel lets go of it when the process ends, however it ends; other
/// hosts see it where the file system has locks (NFS version 4 has).
class Lock {
 public:
  /// Nothing if somebody else holds it. `note` is written into the file for whoever asks. IoError if there can be no
  /// lock, InputError if something of somebody else's has the name: a link, a pipe, a file with other contents.
  static std::optional<Lock> attempt(const std::filesystem::path& path, const std::string& note = {});
  /// The note of whoever holds it now; nothing if nobody does.
  static std::optional<std::string> holder(const std::filesystem::path& path);

  ~Lock();
  Lock(Lock&& other) noexcept : path_(std::move(other.path_)), file_(std::exchange(other.file_, -1)) {}
  Lock(const Lock&) = delete;
  Lock& operator=(const Lock&) = delete;
  Lock& operator=(Lock&& other) noexcept {
    std::swap(path_, other.path_);
    std::swap(file_, other.file_);
    return *this;
  }

 private:
  Lock(std::filesystem::path path, int file) : path_(std::move(path)), file_(file) {}

  std::filesystem::path path_;
  int file_ = -1;
};

}  // namespace tools::sweep
