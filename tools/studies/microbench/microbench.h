#pragma once

namespace CLI {
class App;
}

namespace tools {

// One function per benchmark: adds it to `raywatt microbench`, and runs it as its callback. Each prints what it has
// measured beside a closed form, and makes `exit` kCheckFailed if the two are further apart than they may be.
void add_microbench_chase(CLI::App& verb, int& exit);
void add_microbench_bandwidth(CLI::App& verb, int& exit);
void add_microbench_mshr(CLI::App& verb, int& exit);
void add_microbench_dram(CLI::App& verb, int& exit);
void add_microbench_rays(CLI::App& verb, int& exit);
void add_microbench_early_exit(CLI::App& verb, int& exit);
void add_microbench_tile_buffer(CLI::App& verb, int& exit);
void add_microbench_kernels(CLI::App& verb, int& exit);

}  // namespace tools
