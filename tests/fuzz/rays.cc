#include "tests/fuzz/common.h"
#include "tools/run/jobs.h"

// Fuzz target: a list of rays, as `raywatt run --rays FILE` reads it.

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::filesystem::path file = fuzz::file_of(fuzz::text_of(data, size), "input.rays");
  fuzz::ignore_input_errors([&] { tools::read_ray_list(file); });
  return 0;
}
