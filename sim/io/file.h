#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace sim {

/// The bytes of a regular file. InputError if there is none, if it cannot be opened or if it is larger than
/// `most_bytes`; IoError if reading fails.
std::string read_file(const std::filesystem::path& path, std::uint64_t most_bytes);

/// A file that is written piece by piece under another name in the same folder, which nothing else has, and takes its
/// own when it is whole: readers see the old file or the whole new one, also after a power failure. Whatever is not
/// committed is removed. Only a process that is killed leaves something: "x.123-0.tmp.json" of "x.json".
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

/// Is `left` what a killed writer of a file of this name may have left beside it?
bool is_left_of(std::string_view left, const std::filesystem::path& name);

}  // namespace sim
