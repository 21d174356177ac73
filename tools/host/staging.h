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

/// A folder beside `target` to write into, with what parents are missing. Whatever it holds in the end is removed, and
/// so is what a killed run has left of its own: nobody has the lock of that.
class Staging {
 public:
  enum class Left : std::uint8_t { kOfItsName, kOfAnyName };
  /// `left`: what killed runs have left is removed only if it was to become `target`, or whatever its name.
  explicit Staging(std::filesystem::path target, Left left = Left::kOfItsName)
      : target_(std::move(target)), left_(left) {}
  ~Staging();
  Staging(const Staging&) = delete;
  Staging& operator=(const Staging&) = delete;

  std::error_code make();
  /// Empty before it is made.
  const std::filesystem::path& folder() const { return folder_; }

 private:
  std::string begin() const { return "." + target_.filename().string() + "."; }
  bool is_left(std::string_view name) const;
  void remove_left() const;

  const std::filesystem::path target_;
  const Left left_;
  std::filesystem::path folder_;
  FolderLock lock_;
  std::vector<std::filesystem::path> made_;  ///< innermost first
};

}  // namespace tools
