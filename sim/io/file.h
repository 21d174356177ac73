#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

namespace sim {

/// Returns the content of a regular file. Throws InputError if the file is missing, not regular, cannot be opened or
/// has more than `max_bytes` bytes; IoError if reading fails.
std::string read_file(const std::filesystem::path& path, std::uint64_t max_bytes);

/// Describes which existing files a command of the program may overwrite with its output.
struct ReplaceableOutput {
  std::string_view mark = {};      ///< text in the first 512 bytes of all files that the command writes; empty: none
  std::string_view kind = "file";  ///< word for such a file in error messages, such as "trace"
  bool any = false;                ///< any regular file may be replaced (option --force)
};
/// Throws InputError unless an output file can be written: `path` is free or a replaceable file, and its folder accepts
/// new files. Links, folders, devices and pipes are never replaced. Also removes stale temporary files of `path`.
void check_output(const std::filesystem::path& path, const ReplaceableOutput& replaceable);

/// Writes a new file that gets its name only when it is complete, so that a crash or power failure leaves no partial
/// file.
///
/// 1. It is written under a temporary name in the same folder: "x.123-0.raywatt-tmp.json" for "x.json".
/// 2. The temporary file is locked while its writer runs. An unlocked one is stale, and other processes may remove it.
/// 3. commit() waits until the disk has stored the file, then renames it, replacing an existing file.
/// 4. The destructor removes a file that was not committed.
class NewFile {
 public:
  /// Creates the temporary file. All members throw IoError if the file cannot be written.
  explicit NewFile(std::filesystem::path path);
  ~NewFile();
  NewFile(const NewFile&) = delete;
  NewFile& operator=(const NewFile&) = delete;

  void write(std::string_view bytes);
  void commit();

 private:
  [[noreturn]] void throw_error() const;

  const std::filesystem::path path_;
  std::filesystem::path temporary_;
  int file_ = -1;
};

/// A new folder that is filled under a temporary name: ".out.123-0.raywatt-tmp" for "out". The caller renames it when
/// it is complete. It is locked like a NewFile. The destructor removes it if it still has its temporary name.
class NewFolder {
 public:
  /// `target`: path of the complete folder. `parent`: folder in which the temporary folder is created; empty: the
  /// parent of `target`.
  explicit NewFolder(std::filesystem::path target, const std::filesystem::path& parent = {});
  ~NewFolder();
  NewFolder(const NewFolder&) = delete;
  NewFolder& operator=(const NewFolder&) = delete;

  /// Creates the temporary folder, and its parents if they are missing. The destructor removes new parents that are
  /// empty.
  std::error_code make();
  /// Returns the path of the temporary folder; empty before make().
  const std::filesystem::path& path() const { return temporary_; }
  /// Removes all stale temporary folders in the parent folder, including those for other target folders.
  void remove_stale() const;

 private:
  const std::filesystem::path target_, parent_;
  std::filesystem::path temporary_;
  std::vector<std::filesystem::path> made_parents_;  ///< parent folders that make() has created, innermost first
  int lock_ = -1;
};

/// Writes a file with the content `bytes`, replacing an existing one. A crash leaves either the old or the new file.
void write_file_atomically(const std::filesystem::path& path, std::string_view bytes);

/// Appends `bytes` to a regular file, which is created if missing. Throws IoError on failure or if `path` is no regular
/// file.
void append_to_file(const std::filesystem::path& path, std::string_view bytes);

/// Waits until the disk has stored a file or folder (fsync). Throws IoError on failure.
void sync_to_disk(const std::filesystem::path& path);

/// Creates the missing folders of a path and waits until the disk has stored them. Throws IoError on failure.
void make_folders(const std::filesystem::path& path);

/// Removes stale temporary files of the output file `path`, which are left by killed processes.
void remove_stale_files(const std::filesystem::path& path);

/// True if `name` could be the name of a temporary file of a NewFile for `target`.
bool is_temporary_name(std::string_view name, const std::filesystem::path& target);

/// A lock on a lock file, which one process at a time can hold. The kernel frees the lock when the process ends for any
/// reason. The lock also works between hosts if the file system supports that (NFS version 4).
class FileLock {
 public:
  /// Acquires the lock and writes `note` into the lock file. Returns nullopt if another process holds the lock. Throws
  /// IoError if the file system does not support locks; InputError if `path` is a link, a pipe or a file that is no
  /// lock file.
  static std::optional<FileLock> try_acquire(const std::filesystem::path& path, const std::string& note = {});
  /// Returns the note that the process holding the lock has written; nullopt if the lock is free.
  static std::optional<std::string> read_holder(const std::filesystem::path& path);

  ~FileLock();
  FileLock(FileLock&& other) noexcept : path_(std::move(other.path_)), file_(std::exchange(other.file_, -1)) {}
  FileLock(const FileLock&) = delete;
  FileLock& operator=(const FileLock&) = delete;
  FileLock& operator=(FileLock&& other) noexcept {
    std::swap(path_, other.path_);
    std::swap(file_, other.file_);
    return *this;
  }

 private:
  FileLock(std::filesystem::path path, int file) : path_(std::move(path)), file_(file) {}

  std::filesystem::path path_;
  int file_ = -1;
};

}  // namespace sim
