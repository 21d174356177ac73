#include "tools/studies/baseline/suite.h"

#include "tests/fuzz/common.h"

// A suite of `raywatt baseline`, and the file of its values: the input is read as both.

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::filesystem::path file = fuzz::file_of(fuzz::text_of(data, size), "input.yaml");
  fuzz::refusing([&] { tools::load_suite(file); });
  fuzz::refusing([&] { tools::load_baseline(file); });
  return 0;
}
