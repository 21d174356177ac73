#include "tests/fuzz/common.h"
#include "tests/fuzz/trace_reading.h"

// Fuzz target: a trace file. For the content of its blocks see trace_work.cc.

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::read_trace(fuzz::file_of(fuzz::text_of(data, size), "input.trace"));
  return 0;
}
