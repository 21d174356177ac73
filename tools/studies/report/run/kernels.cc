#include <algorithm>
#include <functional>

#include <fmt/format.h>

#include "hw_models/machines/gpu_config.h"
#include "hw_models/srp/schedule.h"
#include "shader_kernels/catalogue.h"
#include "sim/io/printable.h"
#include "tools/studies/report/run/run_parts.h"

namespace tools::pages {
namespace {

/// A resource of the array, and the least interval at which a kernel's operations fit it.
struct Demand {
  std::string words;
  double interval = 0;
};

double per(double work, std::uint32_t of) { return of == 0 ? 0 : work / of; }

/// The reason that a kernel's interval is no shorter.
std::string bound_of(const hw::KernelSchedule& s, const hw::ArrayConfig& array) {
  using hw::OpClass;
  if (s.rec_mii >= s.ii) return "values from item to item";
  const auto ops = [&](OpClass op) { return static_cast<double>(s.ops[static_cast<std::size_t>(op)]); };
  const std::vector<Demand> demands = {
      {"functional units", per(s.fu_ops, array.units())},
      {"multipliers", per(ops(OpClass::kFpMul) + ops(OpClass::kFpMulAdd) + ops(OpClass::kIntMul), array.mul_units)},
      {"dividers", per(ops(OpClass::kFpDivSqrt), array.div_sqrt_units)},
      {"local-memory ports", per(s.local_reads + s.local_writes, array.local_ports)},
      {"data-cache ports", per(s.queued_loads, array.cache_ports)}};
  const Demand& most = *std::ranges::max_element(demands, {}, &Demand::interval);
  if (s.ii > s.res_mii) return fmt::format("the schedule: {} alone allow {}", most.words, s.res_mii);
  return most.words;
}

}  // namespace

void add_kernels(const Run& run, View& view) {
  Section section(
      "kernels", "Kernels on the shader cores",
      "A kernel is a loop; its initiation interval (II) is the number of cycles from one item to the next.");
  const Json& kernels = at(run.totals(), {"kernels"});
  if (!kernels.is_object() || kernels.empty()) {
    section.text("No kernel ran.");
    return view.add(section);
  }
  Dataset data({{"kernel", "kernel"},
                {"share", "share of SRP cycles", Show::kPercent},
                {"label", "shown"},
                {"ii", "II", Show::kNumber, "cycles"},
                {"bound", "II is bound by"},
                {"depth", "depth", Show::kNumber, "cycles"},
                {"items", "items", Show::kSi},
                {"launches", "loops", Show::kSi},
                {"cycles", "cycles", Show::kSi},
                {"per_item", "cycles an item", Show::kNumber},
                {"starved", "T&I unit starved", Show::kPercent},
                {"meaning", "what it does"}});
  std::vector<std::pair<double, std::string>> order;
  for (const auto& [name, kernel] : kernels.items()) order.emplace_back(number_at(kernel, {"share"}), name);
  std::ranges::stable_sort(order, std::greater<>(), &std::pair<double, std::string>::first);
  for (const auto& [share, name] : order) {
    const Json& k = at(kernels, {name});
    const kernels::KernelInfo* const info = kernels::find_kernel(name);
    Json bound;
    if (info != nullptr && run.priced) {
      const hw::SrpConfig& srp = run.priced->config().gpu->srp;
      const hw::KernelSchedule schedule = hw::schedule(info->graph, srp);
      if (schedule.ii == number_at(k, {"ii"})) bound = bound_of(schedule, srp.array);
    }
    const double cycles = number_at(k, {"cycles"}), items = number_at(k, {"items"});
    data.row({sim::printable(name), share, percent_text(share), at(k, {"ii"}), bound, at(k, {"depth"}),
              at(k, {"items"}), at(k, {"launches"}), cycles, items > 0 ? Json(cycles / items) : Json(),
              cycles > 0 ? Json(number_at(k, {"starved"}) / cycles) : Json(),
              info != nullptr ? Json(info->meaning) : Json()});
  }
  view.data("kernels", data);
  section.chart("kernel-shares", "Shares of the shader cores' cycles", "Share of the cycles of all kernels, by kernel",
                "kernels",
                {{"kind", "bars"},
                 {"name", "kernel"},
                 {"value", "share"},
                 {"title", "of the cycles of all kernels"},
                 {"format", ".0%"},
                 {"label", "label"}});
  section.table("kernel-table", "Intervals, and what bounds them", "kernels");
  view.add(section);
}

}  // namespace tools::pages
