#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
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

/// A temporary folder beside `target`, with the parents that are missing. The destructor removes it. Temporary folders
/// of killed runs in the same parent, whose lock is free, are removed when a new one is made.
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
