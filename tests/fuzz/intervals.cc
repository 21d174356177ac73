#include "tools/intervals/intervals.h"

#include <string>

#include "tests/fuzz/common.h"
#include "tests/fuzz/trace_work.h"
#include "traces/trace_file/packing.h"

// Fuzz target: a file of intervals. The input is read as a whole file, and as the content of its blocks, which this
// target compresses.

namespace {

void read(std::string_view bytes) {
  fuzz::ignore_input_errors([&] {
    for (const tools::IntervalFrame& frame : tools::read_intervals(bytes).frames) frame.with_merged_intervals(3);
  });
}

std::string packed(std::string_view parts) {
  traces::Packer packer;
  std::string file;
  for (std::size_t end = 0; end != std::string_view::npos;) {
    end = parts.find(fuzz::kBetween);
    file += packer.pack_block(parts.substr(0, end));
    parts.remove_prefix(end == std::string_view::npos ? parts.size() : end + fuzz::kBetween.size());
  }
  return file;
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  read(fuzz::text_of(data, size));
  read(packed(fuzz::text_of(data, size)));
  return 0;
}
