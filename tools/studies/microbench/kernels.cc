#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "hw_models/machines/gpu_config.h"
#include "hw_models/srp/schedule.h"
#include "shader_kernels/catalogue.h"
#include "sim/error.h"
#include "sim/io/printable.h"
#include "sim/report/table.h"
#include "tools/studies/microbench/benchmark.h"
#include "traces/scene/did_you_mean.h"

namespace tools {
namespace {

constexpr std::array<std::array<std::uint32_t, 2>, 5> kSizes = {{{2, 2}, {4, 2}, {4, 4}, {8, 4}, {8, 8}}};

/// The array at another size, with as large a part of its units able to multiply and to divide, and the same ports.
hw::SrpConfig resized(hw::SrpConfig srp, std::uint32_t rows, std::uint32_t columns) {
  const std::uint32_t before = srp.array.units(), units = rows * columns;
  srp.array.rows = rows;
  srp.array.columns = columns;
  for (std::uint32_t* able : {&srp.array.mul_units, &srp.array.div_sqrt_units})
    *able = std::max(1U, *able * units / before);
  return srp;
}

std::vector<const kernels::KernelInfo*> wanted(const std::vector<std::string>& names) {
  std::vector<const kernels::KernelInfo*> list;
  if (names.empty()) {
    for (const kernels::KernelInfo& kernel : kernels::kernel_catalogue()) list.push_back(&kernel);
  }
  for (const std::string& name : names) {
    list.push_back(kernels::find_kernel(name));
    if (list.back() != nullptr) continue;
    std::vector<std::string> known;
    for (const kernels::KernelInfo& kernel : kernels::kernel_catalogue()) known.emplace_back(kernel.name);
    throw sim::InputError(fmt::format("no kernel is called '{}'{}; see raywatt kernels list", sim::printable(name),
                                      traces::did_you_mean(name, known)));
  }
  return list;
}

Findings measure(const hw::SrpConfig& srp, const std::vector<std::string>& names) {
  Findings found{"interval from item to item", {}};
  std::vector<std::string> header = {"II (bound, if less)"};
  for (const auto& [rows, columns] : kSizes) header.push_back(fmt::format("{}x{}", rows, columns));
  sim::Table table(header);
  std::size_t above = 0;
  for (const kernels::KernelInfo* kernel : wanted(names)) {
    std::vector<std::string> cells = {std::string(kernel->name)};
    for (const auto& [rows, columns] : kSizes) {
      const hw::KernelSchedule s = hw::schedule(kernel->graph, resized(srp, rows, columns));
      const std::uint32_t bound = std::max({1U, s.res_mii, s.rec_mii});
      const bool recurrence = s.rec_mii > s.res_mii;
      found.figures.push_back({fmt::format("{}, {}x{}", kernel->name, rows, columns), "cycles", double(s.ii),
                               double(bound), Figure::Holds::kAtLeast, recurrence ? "recurrence" : "units and ports"});
      above += s.ii > bound ? 1 : 0;
      cells.push_back(
          fmt::format("{}{}{}", s.ii, recurrence ? "r" : "", s.ii > bound ? fmt::format(" ({})", bound) : ""));
    }
    table.add_row(cells);
  }
  found.table = table.text();
  found.notes.push_back(fmt::format(
      "r: values handed from item to item set the bound, not units and ports.\n{} of {} schedules exceed their bound.",
      above, found.figures.size()));
  return found;
}

}  // namespace

Benchmark kernels_benchmark() {
  return {"kernels",
          "Initiation interval of kernels on arrays of several sizes, beside what units and recurrences allow",
          "Arrays of 2x2 to 8x8 units, of which as large a part multiplies and divides as in the configuration; the "
          "ports\n"
          "to memory stay. More units than the ports can feed bring nothing.\n"
          "\n"
          "Example: raywatt microbench kernels --kernel shade_diffuse --set srp.array.local_ports=8",
          {json_option(), {"--kernel", "this kernel alone (repeatable)", &BenchmarkJob::kernels}},
          [](const BenchmarkJob& job) { return measure(real_machine(job.machine).gpu->srp, job.kernels); }};
}

}  // namespace tools
