#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace traces {

/// A file that is written piece by piece under another name and takes its own when it is whole. Whatever is not
/// committed is removed.
class OutputFile {
 public:
  /// InputError if it cannot be made.
  explicit OutputFile(std::filesystem::path path);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  /// IoError, also for what was written before.
  void write(std::string_view bytes);
  std::uint64_t size() const { return size_; }
  void commit();

 private:
  void flush();
  [[noreturn]] void give_up() const;

  const std::filesystem::path path_, temporary_;
  int file_ = -1;
  std::string held_;
  std::uint64_t size_ = 0;
};

}  // namespace traces
