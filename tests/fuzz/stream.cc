#include "tests/fuzz/common.h"
#include "tools/studies/microbench/benchmark.h"

// Fuzz target: requests to a memory channel, as `raywatt microbench dram --stream FILE` reads them.

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::filesystem::path file = fuzz::file_of(fuzz::text_of(data, size), "input.txt");
  fuzz::ignore_input_errors([&] { tools::load_dram_stream(file.string()); });
  return 0;
}
