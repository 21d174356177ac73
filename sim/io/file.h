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

/// Returns the bytes of a regular file. Throws InputError if it is missing, not a regular file, cannot be opened or is
/// larger than `max_bytes`; IoError if reading fails.
std::string read_file(const std::filesystem::path& path, std::uint64_t max_bytes);

/// Describes which existing files a command of the program may replace with its own output.
struct Replaceable {
  std::string_view mark = {};  ///< text in the first 512 bytes of every file that the verb writes; empty: no such text
  std::string_view kind = "file";  ///< word for such a file in messages: "trace"
  bool any = false;                ///< --force: any regular file may be replaced
};
/// Checks that an output file can be written: `path` is free or a replaceable file, and its folder accepts new files.
/// Then removes stale temporary files of `path`. Throws InputError otherwise; links, folders, devices and pipes are
/// never replaced.
void check_output(const std::filesystem::path& path, const Replaceable& replaceable);

/// A new file that gets its name only when it is complete, so that a crash or power failure leaves no partial file.
///
/// 1. It is written under a temporary name in the same folder: "x.123-0.raywatt-tmp.json" for "x.json".
/// 2. The temporary file is locked while its writer lives, so other processes can detect a stale one.
/// 3. commit() synchronises it and renames it over the former file.
/// 4. The destructor removes a file that was not committed.
class NewFile {
 public:
  /// Creates the temporary file. Throws IoError if it cannot be written, as all members do.
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
  /// `parent`: where to make the temporary folder; empty: in the parent of `target`.
  explicit NewFolder(std::filesystem::path target, const std::filesystem::path& parent = {});
  ~NewFolder();
  NewFolder(const NewFolder&) = delete;
  NewFolder& operator=(const NewFolder&) = delete;

  /// Makes the temporary folder, and its parents if they are missing. The destructor removes those new parents that
  /// stay empty.
  std::error_code make();
  /// Returns the path of the temporary folder; empty before make().
  const std::filesystem::path& path() const { return temporary_; }
  /// Removes stale temporary folders from the parent folder, whatever their targets.
  void remove_stale() const;

 private:
  const std::filesystem::path target_, parent_;
  std::filesystem::path temporary_;
  std::vector<std::filesystem::path> made_parents_;  ///< innermost first
  int lock_ = -1;
};

/// Replaces the file `path` by one with the content `bytes`. A crash leaves either the old or the new file.
void write_file_atomically(const std::filesystem::path& path, std::string_view bytes);

/// Appends `bytes` to a regular file, which is created if missing. Throws IoError if that fails or if `path` is not a
/// regular file.
void append_to_file(const std::filesystem::path& path, std::string_view bytes);

/// Waits until the disk has stored a file or folder. Throws IoError on failure.
void sync_to_disk(const std::filesystem::path& path);

/// Creates the missing folders of a path and waits until the disk has stored them. Throws IoError on failure.
void make_folders(const std::filesystem::path& path);

/// Removes the stale temporary files of `path`: those that killed processes have left.
void remove_stale_files(const std::filesystem::path& path);

/// True if `name` is a name that a NewFile for `target` gives its temporary file.
bool is_temporary_name(std::string_view name, const std::filesystem::path& target);

/// A lock file, which one process at a time can hold. The kernel frees the lock when the process ends for any reason.
/// Other hosts see the lock if the file system supports that (NFS version 4).
class FileLock {
 public:
  /// Acquires the lock and writes `note` into the lock file. Returns nullopt if another process holds the lock. Throws
  /// IoError if the file system refuses locks; InputError if `path` is a link, a pipe or a file that is no lock file.
  static std::optional<FileLock> try_acquire(const std::filesystem::path& path, const std::string& note = {});
  /// Returns the note of the process that holds the lock; nullopt if the lock is free.
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
