#pragma once
#include "tools/studies/microbench/benchmark.h"

namespace tools {

// Each benchmark measures a piece of the machine alone beside its closed form.
Benchmark chase_benchmark();
Benchmark bandwidth_benchmark();
Benchmark mshr_benchmark();
Benchmark dram_benchmark();
Benchmark rays_benchmark();
Benchmark early_exit_benchmark();
Benchmark tile_buffer_benchmark();
Benchmark kernels_benchmark();

}  // namespace tools
