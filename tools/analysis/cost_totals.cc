#include "tools/analysis/cost_totals.h"

#include "sim/io/json.h"
#include "sim/report/report_json.h"
#include "sim/report/table.h"

namespace tools {

sim::Json energy_totals_json(const sim::EnergyReport& energy, const WorkDone& work) {
  const double mj = energy.total_pj.nominal / sim::kPicojoulesPerMillijoule;
  const double tni_mj = energy.blocks.at("tni").total().nominal / sim::kPicojoulesPerMillijoule;
  sim::Json out = sim::energy_json(energy);
  out["power_w"] = sim::band_json(energy.total_pj * (1 / (sim::kPicojoulesPerMillijoule * work.time_ms)));
  out["perf"] = {{"nj_per_ray", mj * 1e6 / work.rays},
                 {"frames_per_joule_gpu", 1000 * work.frames / mj},
                 {"frames_per_joule_tni", 1000 * work.frames / tni_mj}};
  return out;
}

namespace {

/// Divides the statistics of replicates by an area.
sim::Json per_mm2(sim::Json statistics, double mm2) {
  for (auto& [name, number] : statistics.items()) {
    if (!number.is_array()) {
      number = number.get<double>() / mm2;
      continue;
    }
    for (auto& value : number) value = value.get<double>() / mm2;
  }
  return statistics;
}

}  // namespace

void add_area(sim::Json& totals, std::span<const sim::UnitReport> units, const RunConfig& config) {
  if (config.area.arrays.empty()) return;
  const sim::AreaReport area = sim::compute_area(units, config.energy, config.area);
  const double mm2 = area.total.nominal;
  totals["area_mm2"] = mm2;
  totals["area_band_mm2"] = sim::band_json(area.total);
  sim::AreaOfBlock all;
  for (const auto& [name, block] : area.blocks) {
    totals["area_by_block_mm2"][name] = sim::band_json(block.total());
    all.logic += block.logic;
    all.arrays += block.arrays;
    all.buffers += block.buffers;
    all.pads += block.pads;
  }
  totals["area_by_part_mm2"] = {{"logic", sim::band_json(all.logic)},
                                {"arrays", sim::band_json(all.arrays)},
                                {"buffers", sim::band_json(all.buffers)},
                                {"pads", sim::band_json(all.pads)}};
  auto& perf = totals["perf"];
  perf["frames_per_joule_per_mm2"] = perf["frames_per_joule_gpu"].get<double>() / mm2;
  perf["mrays_per_s_per_mm2"] = perf["mrays_per_s"].get<double>() / mm2;
  if (!totals.contains("replicates")) return;
  auto& replicated = totals["replicates"]["figures"]["perf"];
  replicated["frames_per_joule_per_mm2"] = per_mm2(replicated["frames_per_joule_gpu"], mm2);
  replicated["mrays_per_s_per_mm2"] = per_mm2(replicated["mrays_per_s"], mm2);
}

}  // namespace tools
