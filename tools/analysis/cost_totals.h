#pragma once
#include <span>

#include "sim/io/json.h"
#include "sim/report/area.h"
#include "sim/report/energy.h"
#include "sim/unit_report.h"
#include "tools/run/frame/load_config.h"

namespace tools {

/// Amount of work that energy is divided by.
struct WorkDone {
  double time_ms = 0, rays = 0, frames = 0;
};

/// Returns the totals that follow from energy: energy_mj and its parts, power_w, and perf.nj_per_ray,
/// frames_per_joule_gpu and frames_per_joule_tni.
sim::Json energy_totals_json(const sim::EnergyReport& energy, const WorkDone& work);

/// Adds the machine's area by block and by part to the totals, and perf.frames_per_joule_per_mm2 and
/// perf.mrays_per_s_per_mm2. No effect without an area table.
void add_area(sim::Json& totals, std::span<const sim::UnitReport> units, const RunConfig& config);

}  // namespace tools
