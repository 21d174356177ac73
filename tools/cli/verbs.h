#pragma once
#include <string>
#include <vector>

#include "tools/host/process.h"

namespace CLI {
class App;
}

namespace tools {

// Each function adds one verb to the command line. The verb's callback runs the verb and sets the exit code `exit`.
void add_run_command(CLI::App& app, const std::vector<std::string>& argv, int& exit);
void add_verify_command(CLI::App& app, const std::vector<std::string>& argv, int& exit);
void add_reproduce_command(CLI::App& app, const std::vector<std::string>& argv);
void add_scenes_command(CLI::App& app);
void add_config_command(CLI::App& app);
void add_kernels_command(CLI::App& app);
void add_bottleneck_command(CLI::App& app);
void add_bench_command(CLI::App& app);
void add_compare_command(CLI::App& app);
void add_report_command(CLI::App& app);
void add_energy_command(CLI::App& app);
void add_dvfs_command(CLI::App& app);
void add_sustain_command(CLI::App& app);
void add_baseline_command(CLI::App& app, int& exit);
void add_trace_command(CLI::App& app, const std::vector<std::string>& argv);
void add_microbench_command(CLI::App& app, int& exit);
void add_sweep_command(CLI::App& app, int& exit);
void add_optimise_command(CLI::App& app, int& exit);
void add_worth_command(CLI::App& app, int& exit);
void add_completion_command(CLI::App& app);
void add_man_command(CLI::App& app);

}  // namespace tools
