#include <memory>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "hw_models/machines/gpu_config.h"
#include "hw_models/srp/schedule.h"
#include "shader_kernels/catalogue.h"
#include "shader_kernels/graph.h"
#include "sim/error.h"
#include "sim/io/printable.h"
#include "sim/report/table.h"
#include "tools/cli/job_options.h"
#include "tools/cli/verbs.h"
#include "tools/run/frame/run_job.h"
#include "traces/scene/did_you_mean.h"

namespace tools {
namespace {

void list(const JobOptions& options) {
  const hw::SrpConfig srp = load_run_config(options).gpu->srp;
  sim::Table table({"kernel", "operations", "on units", "II", "depth", "local reads", "writes", "cached loads", ""});
  for (const kernels::KernelInfo& kernel : kernels::kernel_catalogue()) {
    const hw::KernelSchedule s = hw::schedule(kernel.graph, srp);
    table.add_row({std::string(kernel.name), std::to_string(kernels::executed_ops(kernel.graph)),
                   std::to_string(s.fu_ops), std::to_string(s.ii), std::to_string(s.depth),
                   std::to_string(s.local_reads), std::to_string(s.local_writes), std::to_string(s.cached_loads),
                   std::string(kernel.meaning)});
  }
  fmt::print("{}", table.text());
}

void show(const JobOptions& options, const std::string& name) {
  const kernels::KernelInfo* kernel = kernels::find_kernel(name);
  if (kernel == nullptr) {
    std::vector<std::string> names;
    for (const kernels::KernelInfo& k : kernels::kernel_catalogue()) names.emplace_back(k.name);
    throw sim::InputError(fmt::format("no kernel is called '{}'{}; see raywatt kernels list", sim::printable(name),
                                      traces::did_you_mean(name, names)));
  }
  const hw::KernelSchedule s = hw::schedule(kernel->graph, load_run_config(options).gpu->srp);
  fmt::print("{}: {}\n\nII {} (units and ports allow {}), depth {}, {} operations on units\n\n{}\n{}", kernel->name,
             kernel->meaning, s.ii, s.res_mii, s.depth, s.fu_ops, kernels::operation_summary(kernel->graph),
             kernels::node_listing(kernel->graph));
}

}  // namespace

void add_kernels(CLI::App& app) {
  CLI::App* verb = app.add_subcommand("kernels", "What runs on the shader cores");
  verb->require_subcommand(1);
  verb->footer("Example: raywatt kernels show shade_diffuse");
  const auto options = std::make_shared<JobOptions>();
  CLI::App* all = verb->add_subcommand("list", "Kernels with their schedules on a configuration's array");
  add_config_options(*all, options->config, options->sets);
  all->footer("Example: raywatt kernels list --set srp.array.cache_ports=2");
  all->callback([options] { list(*options); });
  CLI::App* one = verb->add_subcommand("show", "A kernel's dataflow graph and schedule");
  const auto name = std::make_shared<std::string>();
  one->add_option("kernel", *name, "name of the kernel")->required();
  add_config_options(*one, options->config, options->sets);
  one->footer("Example: raywatt kernels show shade_diffuse");
  one->callback([options, name] { show(*options, *name); });
}

}  // namespace tools
