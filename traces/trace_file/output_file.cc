#include "traces/trace_file/output_file.h"

#include "sim/error.h"

namespace traces {
namespace {

constexpr std::size_t kPiece = 1U << 20;

/// Opens the file. A path that cannot be written is an input error; a disk that fills up later is not.
std::unique_ptr<sim::NewFile> begin(const std::filesystem::path& path) {
  try {
    return std::make_unique<sim::NewFile>(path);
  } catch (const sim::IoError& error) {
    throw sim::InputError(error.what());
  }
}

}  // namespace

OutputFile::OutputFile(const std::filesystem::path& path) : file_(begin(path)) {}

void OutputFile::write(std::string_view bytes) {
  held_.append(bytes);
  size_ += bytes.size();
  if (held_.size() >= kPiece) flush();
}

void OutputFile::flush() {
  file_->write(held_);
  held_.clear();
}

void OutputFile::commit() {
  flush();
  file_->commit();
}

}  // namespace traces
