#pragma once
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

#include "sim/io/file.h"

namespace traces {

/// A sim::NewFile with a buffer for larger writes.
class OutputFile {
 public:
  /// Throws InputError if the file cannot be created.
  explicit OutputFile(const std::filesystem::path& path);

  /// Throws IoError, possibly for earlier writes.
  void write(std::string_view bytes);
  std::uint64_t size() const { return size_; }
  void commit();

 private:
  void flush();

  std::unique_ptr<sim::NewFile> file_;
  std::string held_;
  std::uint64_t size_ = 0;
};

}  // namespace traces
