#include "traces/scene/file_io.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <system_error>

#include <fmt/format.h>
#include <unistd.h>

#include "sim/error.h"
#include "traces/scene/names.h"

namespace traces {
namespace {

struct CloseFile {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
using File = std::unique_ptr<std::FILE, CloseFile>;

std::string last_error() { return std::strerror(errno); }

}  // namespace

std::string read_file(const std::filesystem::path& path, std::uint64_t most_bytes) {
  const std::string shown = printable(path.string());
  std::error_code failed;
  const auto status = std::filesystem::status(path, failed);
  if (!std::filesystem::exists(status)) throw sim::InputError(fmt::format("{}: no such file", shown));
  if (!std::filesystem::is_regular_file(status)) throw sim::InputError(fmt::format("{}: not a regular file", shown));
  const std::uint64_t size = std::filesystem::file_size(path, failed);
  if (failed) throw sim::IoError(fmt::format("{}: {}", shown, failed.message()));
  if (size > most_bytes) {
    throw sim::InputError(fmt::format("{}: the file has {} bytes, allowed are {}", shown, size, most_bytes));
  }
  const File file(std::fopen(path.c_str(), "rb"));
  if (!file) throw sim::InputError(fmt::format("{}: cannot be opened: {}", shown, last_error()));
  std::string bytes(size, '\0');
  if (std::fread(bytes.data(), 1, bytes.size(), file.get()) != bytes.size()) {
    throw sim::IoError(fmt::format("{}: reading failed: {}", shown, last_error()));
  }
  return bytes;
}

void write_file_atomically(const std::filesystem::path& path, std::string_view bytes) {
  std::filesystem::path temporary = path;
  temporary.replace_extension(".tmp" + path.extension().string());
  const auto give_up = [&temporary](const std::filesystem::path& where) {
    const std::string reason = last_error();
    std::remove(temporary.c_str());
    throw sim::IoError(fmt::format("{}: writing failed: {}", printable(where.string()), reason));
  };
  File file(std::fopen(temporary.c_str(), "wb"));
  if (!file) give_up(temporary);
  if (std::fwrite(bytes.data(), 1, bytes.size(), file.get()) != bytes.size() || std::fflush(file.get()) != 0 ||
      fsync(fileno(file.get())) != 0) {
    give_up(temporary);
  }
  if (std::fclose(file.release()) != 0) give_up(temporary);
  if (std::rename(temporary.c_str(), path.c_str()) != 0) give_up(path);
}

}  // namespace traces
