#pragma once
#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "tools/simulation/load_config.h"
#include "tools/studies/microbench/figure.h"

namespace CLI {
class App;
}

namespace tools {

/// A benchmark of `raywatt microbench` as it stands on the command line.
struct Benchmark {
  std::string name;
  std::string meaning;
  std::string footer;
};

/// Adds it with CONFIG, --set and --json. `measure` runs as its callback; a figure that leaves its closed form makes
/// `exit` kCheckFailed. What it measures may have further options: the result is for them.
CLI::App* add_benchmark(CLI::App& verb, const Benchmark& benchmark, const std::shared_ptr<JobOptions>& job, int& exit,
                        std::function<Findings()> measure);

/// Prints them. Says so, and makes `exit` kCheckFailed, if figures leave their closed forms.
void show(const Findings& findings, const std::string& name, bool json, int& exit);

/// The configured machine without ideal resources: what costs no time has no figure.
RunConfig real_machine(const JobOptions& job);

/// Line after line once a unit is busy: the mean rate, per second, between the first tenth and the last of these
/// moments (in fs, in any order).
double steady_rate(std::vector<std::uint64_t> moments);

}  // namespace tools
