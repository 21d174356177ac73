#pragma once
#include <string>
#include <vector>

#include "tools/host/process.h"

namespace CLI {
class App;
}

namespace tools {

// Each function adds one verb to the command line. The verb's callback runs the verb and sets the exit code `exit`.
void add_run(CLI::App& app, const std::vector<std::string>& argv, int& exit);
void add_verify(CLI::App& app, const std::vector<std::string>& argv, int& exit);
void add_reproduce(CLI::App& app, const std::vector<std::string>& argv);
void add_scenes(CLI::App& app);
void add_config(CLI::App& app);
void add_kernels(CLI::App& app);
void add_bottleneck(CLI::App& app);
void add_bench(CLI::App& app);
void add_compare(CLI::App& app);
void add_report(CLI::App& app);
void add_energy(CLI::App& app);
void add_dvfs(CLI::App& app);
void add_sustain(CLI::App& app);
void add_baseline(CLI::App& app, int& exit);
void add_trace(CLI::App& app, const std::vector<std::string>& argv);
void add_microbench(CLI::App& app, int& exit);
void add_sweep(CLI::App& app, int& exit);
void add_optimise(CLI::App& app, int& exit);
void add_worth(CLI::App& app, int& exit);
void add_completion(CLI::App& app);
void add_man(CLI::App& app);

}  // namespace tools
