#pragma once
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

#include "sim/io/file.h"

namespace traces {

/// A sim::NewFile that collects what is written into larger pieces.
class OutputFile {
 public:
  /// InputError if it cannot be made.
  explicit OutputFile(const std::filesystem::path& path);

  /// IoError, also for what was written before.
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
