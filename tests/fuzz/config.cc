#include "sim/config/config.h"

#include <cstdlib>

#include "tests/fuzz/common.h"
#include "tools/run/frame/load_config.h"

// Fuzz target: a configuration file, as `raywatt run FILE` loads it. It is then written and read again.

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  tools::JobOptions options;
  options.config = fuzz::file_of(fuzz::text_of(data, size), "input.yaml").string();
  tools::RunConfig config;
  bool taken = false;
  fuzz::ignore_input_errors([&] {
    config = tools::load_run_config(options);
    taken = true;
  });
  if (!taken) return 0;
  tools::RunConfig back;
  sim::ConfigNode tree = sim::config_tree(back);
  sim::ConfigLoader(tree).apply_text(sim::dump_config(config), "what was written");
  if (sim::config_hash(back) != sim::config_hash(config)) std::abort();
  return 0;
}
