#include "tools/analysis/energy_totals.h"

#include <nlohmann/json.hpp>

#include "sim/report/report_json.h"

namespace tools {

nlohmann::ordered_json energy_totals_json(const sim::EnergyReport& energy, const WorkDone& work) {
  const double mj = energy.total_pj.nominal / kPicojoulesPerMillijoule;
  const double tni_mj = energy.blocks.at("tni").total().nominal / kPicojoulesPerMillijoule;
  nlohmann::ordered_json out = sim::energy_json(energy);
  out["power_w"] = sim::spread_json(energy.total_pj * (1 / (kPicojoulesPerMillijoule * work.time_ms)));
  out["perf"] = {{"nj_per_ray", mj * 1e6 / work.rays},
                 {"frames_per_joule_gpu", 1000 * work.frames / mj},
                 {"frames_per_joule_tni", 1000 * work.frames / tni_mj}};
  return out;
}

}  // namespace tools
