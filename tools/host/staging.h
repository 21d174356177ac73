#pragma once
#include <filesystem>
#include <string>
#include <system_error>
#include <vector>

namespace tools {

/// A folder's lock, which ends with the process, however that ends.
class FolderLock {
 public:
  FolderLock() = default;
  ~FolderLock() { release(); }
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

  /// False if somebody else has it (errno: EWOULDBLOCK), if the folder is gone (ENOENT), or if the file system has no
  /// locks.
  bool take(const std::filesystem::path& folder);

 private:
  void release();
  int folder_ = -1;
};

/// A folder beside `target` to write into, with what parents are missing. Whatever it holds in the end is removed, and
/// so is what a killed run has left of its own: nobody has the lock of that.
class Staging {
 public:
  explicit Staging(std::filesystem::path target) : target_(std::move(target)) {}
  ~Staging();
  Staging(const Staging&) = delete;
  Staging& operator=(const Staging&) = delete;

  std::error_code make();
  /// Empty before it is made.
  const std::filesystem::path& folder() const { return folder_; }

 private:
  std::string begin() const { return "." + target_.filename().string() + "."; }
  void remove_left() const;

  const std::filesystem::path target_;
  std::filesystem::path folder_;
  FolderLock lock_;
  std::vector<std::filesystem::path> made_;  ///< innermost first
};

}  // namespace tools
