#include "tests/fuzz/common.h"
#include "tools/run/frame/load_config.h"

// Fuzz target: a workload file, as `raywatt run --scene FILE` loads it.

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::filesystem::path file = fuzz::file_of(fuzz::text_of(data, size), "input.yaml");
  tools::JobOptions options;
  options.scene = file.string();
  fuzz::ignore_input_errors([&] { tools::load_run_config(options); });
  return 0;
}
