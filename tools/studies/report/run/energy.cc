#include <algorithm>
#include <array>
#include <map>

#include <fmt/format.h>

#include "hw_models/dram/dram_energy.h"
#include "hw_models/machines/gpu_config.h"
#include "sim/report/table.h"
#include "tools/studies/report/run/run_parts.h"

namespace tools::pages {
namespace {

/// Events below this share of the total, at its low, nominal and high, flow together within their block.
constexpr double kOfItsOwn = 0.008;
constexpr const char* kAll = "GPU with memory";

/// Links of a flow from the whole to blocks to what they spent it on, in mJ.
class Flow {
 public:
  void add(const std::string& from, const std::string& to, const sim::Band& pj) {
    if (pj.high <= 0) return;
    links_[{from, to}] += pj;
  }
  Dataset data() const {
    Dataset out({{"from", "from"},
                 {"to", "to"},
                 {"low", "low", Show::kNumber, "mJ"},
                 {"nominal", "nominal", Show::kNumber, "mJ"},
                 {"high", "high", Show::kNumber, "mJ"}});
    for (const auto& [ends, pj] : links_) {
      out.row({ends.first, ends.second, pj.low / sim::kPicojoulesPerMillijoule,
               pj.nominal / sim::kPicojoulesPerMillijoule, pj.high / sim::kPicojoulesPerMillijoule});
    }
    return out;
  }

 private:
  std::map<std::pair<std::string, std::string>, sim::Band> links_;
};

bool is_small(const sim::Band& pj, const sim::Band& all) {
  return pj.low < kOfItsOwn * all.low && pj.nominal < kOfItsOwn * all.nominal && pj.high < kOfItsOwn * all.high;
}

/// Sums of the flow are those of the report: of each block its dynamic energy by event, its clock and its leakage,
/// from which standby of the memory is taken out as an event.
Flow flow_of(const PricedRun& run) {
  const sim::EnergyReport energy = run.energy();
  const auto device = hw::dram_energy_events(run.config().gpu->dram);
  Flow flow;
  for (const auto& [block, kinds] : energy.blocks) {
    flow.add(kAll, block, kinds.total());
    flow.add(block, "clock", kinds.clock);
    sim::Band leakage = kinds.leakage;
    const auto events = energy.events.find(block);
    if (events != energy.events.end()) {
      for (const auto& [name, pj] : events->second) {
        const auto of_device = device.find(name);
        if (of_device != device.end() && of_device->second.standby) leakage += pj * -1.0;
        const bool is_prefixed = name.starts_with(block + ".");
        const std::string shown = is_prefixed ? name.substr(block.size() + 1) : name;
        flow.add(block, fmt::format("{}: {}", block, is_small(pj, energy.total_pj) ? "other events" : shown), pj);
      }
    }
    flow.add(block, "leakage", leakage);
  }
  return flow;
}

Dataset blocks_of(const Run& run) {
  Dataset data({{"block", "block"},
                {"low", "low", Show::kNumber, "mJ"},
                {"nominal", "nominal", Show::kNumber, "mJ"},
                {"high", "high", Show::kNumber, "mJ"},
                {"share", "share, nominal", Show::kPercent}});
  const double all = run.number("totals.energy_mj.nominal");
  const auto rows = [&](const char* group, const char* prefix) {
    const Json& spreads = at(run.totals(), {group});
    if (!spreads.is_object()) return;
    for (const auto& [name, spread] : spreads.items()) {
      const double nominal = number_at(spread, {"nominal"});
      data.row({prefix + name, number_at(spread, {"low"}), nominal, number_at(spread, {"high"}),
                all > 0 ? nominal / all : 0});
    }
  };
  rows("energy_by_block_mj", "");
  rows("energy_by_kind_mj", "of all: ");
  return data;
}

}  // namespace

void add_energy(const Run& run, View& view) {
  Section section("energy", "Where the energy went",
                  "From the whole to its blocks to what they spent it on: counted events, the clock tree, leakage; the "
                  "memory's standby, which the table below has in leakage, is one of its events. The band is that of "
                  "the energy tables; trust ratios under one side more than the joules of one.");
  if (run.priced) {
    view.data("flow", flow_of(*run.priced).data());
    section.block("sankey", "flow", "Energy by block, event, clock and leakage",
                  {{"data", "flow"},
                   {"about", "Flow of energy from the whole through blocks to events, clock and leakage, in mJ"}});
  } else {
    section.text("Energy by event is not shown under low and high tables: " + run.not_priced);
  }
  view.data("blocks", blocks_of(run));
  section.table("blocks", "Energy by block, and by kind", "blocks");
  view.add(section);
}

}  // namespace tools::pages
