#include "tests/fuzz/common.h"
#include "tests/fuzz/trace_reading.h"

// A trace as stored. trace_work.cc varies the content of its blocks.

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::read_trace(fuzz::file_of(fuzz::text_of(data, size), "input.trace"));
  return 0;
}
