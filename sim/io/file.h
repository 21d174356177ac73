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

/// Returns the bytes of a regular file. InputError if it is missing, not a regular file, cannot be opened or is larger
/// than `most_bytes`; IoError if reading fails.
std::string read_file(const std::filesystem::path& path, std::uint64_t most_bytes);

/// Files that a verb may replace with its own output.
struct Replaceable {
  std::string_view mark = {};      ///< text in the first 512 bytes of every file of the verb; empty: no such text
  std::string_view kind = "file";  ///< word for such a file in messages: "trace"
  bool any = false;                ///< --force: any regular file may be replaced
};
/// Checks that `path` can be written: it is free or replaceable, and its folder takes new files. Then removes the stale
/// temporary files of `path`. InputError otherwise; links, folders, devices and pipes are never replaced.
void check_output(const std::filesystem::path& path, const Replaceable& what);

/// A file that appears under its name only when it is complete, also after a power failure.
/// 1. It is written under a temporary name in the same folder: "x.123-0.raywatt-tmp.json" for "x.json".
/// 2. The temporary file is locked while its writer lives, so other processes can detect a stale one.
/// 3. commit() synchronises it and renames it over the former file.
/// 4. The destructor removes a file that was not committed.
class NewFile {
 public:
  /// IoError if the file cannot be written, as in all members.
  explicit NewFile(std::filesystem::path path);
  ~NewFile();
  NewFile(const NewFile&) = delete;
  NewFile& operator=(const NewFile&) = delete;

  void write(std::string_view bytes);
  void commit();

 private:
  [[noreturn]] void fail() const;

  const std::filesystem::path path_;
  std::filesystem::path temporary_;
  int file_ = -1;
};

/// A folder that is filled under a temporary name: ".out.123-0.raywatt-tmp" for "out". The caller renames it when it is
/// complete. It is locked like a NewFile. The destructor removes it if it still has its temporary name.
class NewFolder {
 public:
  /// `parent`: folder of the temporary folder; empty: the parent of `target`.
  explicit NewFolder(std::filesystem::path target, const std::filesystem::path& parent = {});
  ~NewFolder();
  NewFolder(const NewFolder&) = delete;
  NewFolder& operator=(const NewFolder&) = delete;

  /// Makes the folder, and its parents where they are missing. The destructor removes parents that stay empty.
  std::error_code make();
  /// Path of the temporary folder; empty before make().
  const std::filesystem::path& path() const { return temporary_; }
  /// Removes stale temporary folders in the parent, whatever their targets.
  void remove_stale() const;

 private:
  const std::filesystem::path target_, parent_;
  std::filesystem::path temporary_;
  std::vector<std::filesystem::path> made_parents_;  ///< innermost first
  int lock_ = -1;
};

/// Replaces the file `path` with `bytes` through a NewFile.
void write_file_atomically(const std::filesystem::path& path, std::string_view bytes);

/// Appends `bytes` to a regular file, which is created if missing. IoError if that fails or `path` is something else.
void append_to_file(const std::filesystem::path& path, std::string_view bytes);

/// Synchronises a file or folder with the disk. IoError.
void sync_to_disk(const std::filesystem::path& path);

/// Creates the missing folders of a path, synchronised with the disk. IoError.
void make_folders(const std::filesystem::path& path);

/// Removes the stale temporary files of `path`: those whose lock is free because their writer was killed.
void remove_stale_files(const std::filesystem::path& path);

/// True if `name` is a temporary name of a NewFile called `target`.
bool is_temporary_name(std::string_view name, const std::filesystem::path& target);

/// A lock file that one process at a time holds. The kernel frees the lock when the process ends for any reason; other
/// hosts see it where the file system has locks (NFS version 4).
class FileLock {
 public:
  /// Acquires the lock and writes `note` into the file. Nothing if another process holds it. IoError if the file system
  /// refuses locks; InputError if `path` is a link, a pipe or a file that is no lock file.
  static std::optional<FileLock> try_acquire(const std::filesystem::path& path, const std::string& note = {});
  /// Returns the note of the process that holds the lock; nothing if it is free.
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
