#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace sim {

/// The bytes of a regular file. InputError if there is none, if it cannot be opened or if it is larger than
/// `most_bytes`; IoError if reading fails.
std::string read_file(const std::filesystem::path& path, std::uint64_t most_bytes);

/// Files that a verb may replace by one of its own of the same name.
struct Replaceable {
  std::string_view mark =
      {};  ///< stands in the first 512 bytes of every file that the verb makes; empty: none is known
  std::string_view kind = "file";  ///< what such a file is: "trace"
  bool any = false;                ///< --force: any regular file may be replaced
};
/// InputError if something is there that may not be replaced, never a link, a folder, a device, a pipe, or if the
/// folder takes no new file. Removes what a killed writer of the file has left.
void check_output(const std::filesystem::path& path, const Replaceable& what);

/// A file that is written piece by piece under another name in the same folder, which nothing else has, and takes its
/// own when it is whole: readers see the old file or the whole new one, also after a power failure. Whatever is not
/// committed is removed. Only a process that is killed leaves something: "x.123-0.raywatt-tmp.json" of "x.json", which
/// nobody has locked.
class NewFile {
 public:
  /// IoError, here and below, if that fails.
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

/// Replaces `path` by `bytes`, as NewFile does.
void write_file_atomically(const std::filesystem::path& path, std::string_view bytes);

/// Adds `bytes` to the end of a regular file, which is made if need be. IoError if that fails, or if something else has
/// its name.
void append_to_file(const std::filesystem::path& path, std::string_view bytes);

/// Removes what killed writers of the file have left beside it: nobody has the lock of that.
void remove_left_of(const std::filesystem::path& path);

/// Is `left` what a killed writer of a file of this name may have left beside it?
bool is_left_of(std::string_view left, const std::filesystem::path& name);

}  // namespace sim
