#include "tools/studies/baseline/suite.h"

#include "tests/fuzz/common.h"

// Fuzz target: the input is read as a suite file of `raywatt baseline`, and as its file of stored values.

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::filesystem::path file = fuzz::file_of(fuzz::text_of(data, size), "input.yaml");
  fuzz::ignore_input_errors([&] { tools::load_suite(file); });
  fuzz::ignore_input_errors([&] { tools::load_baseline(file); });
  return 0;
}
