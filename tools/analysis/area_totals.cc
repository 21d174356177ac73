#include "tools/analysis/area_totals.h"

#include <nlohmann/json.hpp>

#include "sim/report/report_json.h"

namespace tools {

void add_area(nlohmann::ordered_json& totals, std::span<const sim::UnitReport> units, const RunConfig& config) {
  if (config.area.arrays.empty()) return;
  const sim::AreaReport area = sim::compute_area(units, config.energy.logic, config.area);
  const double mm2 = area.total.nominal;
  totals["area_mm2"] = mm2;
  totals["area_band_mm2"] = sim::spread_json(area.total);
  sim::AreaOfBlock all;
  for (const auto& [name, block] : area.blocks) {
    totals["area_by_block_mm2"][name] = sim::spread_json(block.total());
    all.logic += block.logic;
    all.arrays += block.arrays;
    all.buffers += block.buffers;
    all.pads += block.pads;
  }
  totals["area_by_part_mm2"] = {{"logic", sim::spread_json(all.logic)},
                                {"arrays", sim::spread_json(all.arrays)},
                                {"buffers", sim::spread_json(all.buffers)},
                                {"pads", sim::spread_json(all.pads)}};
  auto& perf = totals["perf"];
  perf["frames_per_joule_per_mm2"] = perf["frames_per_joule_gpu"].get<double>() / mm2;
  perf["mrays_per_s_per_mm2"] = perf["mrays_per_s"].get<double>() / mm2;
}

}  // namespace tools
