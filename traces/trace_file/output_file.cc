#include "traces/trace_file/output_file.h"

#include <cerrno>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include "sim/error.h"
#include "sim/io/file.h"
#include "sim/io/printable.h"

namespace traces {
namespace {

constexpr std::size_t kPiece = 1U << 20;

std::string cannot_be_written(const std::filesystem::path& path, int error) {
  if (error == ENOENT) {  // a file that is made needs no more than its folder
    return fmt::format("{}: cannot be written: there is no folder {}; make it first", sim::printable(path.string()),
                       sim::printable(path.parent_path().string()));
  }
  return fmt::format("{}: cannot be written: {}", sim::printable(path.string()),
                     std::generic_category().message(error));
}

}  // namespace

OutputFile::OutputFile(std::filesystem::path path) : path_(std::move(path)), temporary_(sim::temporary_name(path_)) {
  if (std::filesystem::is_directory(path_)) {
    throw sim::InputError(fmt::format("{}: is a folder, not a file", sim::printable(path_.string())));
  }
  file_ = ::open(temporary_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (file_ < 0) throw sim::InputError(cannot_be_written(path_, errno));
}

OutputFile::~OutputFile() {
  if (file_ < 0) return;
  ::close(file_);
  ::unlink(temporary_.c_str());
}

void OutputFile::give_up() const { throw sim::IoError(cannot_be_written(path_, errno)); }

void OutputFile::write(std::string_view bytes) {
  held_.append(bytes);
  size_ += bytes.size();
  if (held_.size() >= kPiece) flush();
}

void OutputFile::flush() {
  std::string_view left = held_;
  while (!left.empty()) {
    const ssize_t written = ::write(file_, left.data(), left.size());
    if (written < 0 && errno != EINTR) give_up();
    if (written > 0) left.remove_prefix(static_cast<std::size_t>(written));
  }
  held_.clear();
}

void OutputFile::commit() {
  flush();
  const int file = std::exchange(file_, -1);
  if (::close(file) != 0) {
    const int error = errno;
    ::unlink(temporary_.c_str());
    errno = error;
    give_up();
  }
  sim::commit_file(temporary_, path_);
}

}  // namespace traces
