#pragma once

namespace CLI {
class App;
}

namespace tools {

// One function per benchmark: adds it to `raywatt microbench`, and runs it as its callback. Each prints what it has
// measured beside a closed form.
void add_microbench_dram(CLI::App& verb);

}  // namespace tools
