#include "tools/studies/sweep/store/durable.h"

#include <cerrno>
#include <system_error>

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include "sim/error.h"
#include "sim/io/printable.h"

namespace tools::sweep {
namespace {

[[noreturn]] void give_up(const std::filesystem::path& path, int error) {
  throw sim::IoError(
      fmt::format("{}: cannot be written: {}", sim::printable(path.string()), std::generic_category().message(error)));
}

void close_or_give_up(int file, bool good, const std::filesystem::path& path) {
  int error = good ? 0 : errno;
  if (::close(file) != 0 && error == 0) error = errno;
  if (error != 0) give_up(path, error);
}

}  // namespace

void write_durably(const std::filesystem::path& path, std::string_view bytes) {
  const int file = ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (file < 0) give_up(path, errno);
  bool good = true;
  while (good && !bytes.empty()) {
    const ssize_t written = ::write(file, bytes.data(), bytes.size());
    good = written >= 0 || errno == EINTR;
    if (written > 0) bytes.remove_prefix(static_cast<std::size_t>(written));
  }
  close_or_give_up(file, good && ::fsync(file) == 0, path);
}

void make_durable(const std::filesystem::path& path) {
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) give_up(path, errno);
  close_or_give_up(file, ::fsync(file) == 0, path);
}

void make_folders(const std::filesystem::path& path) {
  namespace fs = std::filesystem;
  std::error_code error;
  if (fs::is_directory(path, error)) return;
  const fs::path parent = fs::absolute(path).lexically_normal().parent_path();
  if (parent != path) make_folders(parent);
  if (fs::create_directory(path, error)) make_durable(parent);
  if (error) give_up(path, error == std::errc::file_exists ? ENOTDIR : error.value());
}

void begin_folder(const std::filesystem::path& path) {
  try {
    make_folders(path);
  } catch (const sim::IoError& error) {
    throw sim::InputError(error.what());
  }
}

}  // namespace tools::sweep
