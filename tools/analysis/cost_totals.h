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

/// Everything in a report's totals that follows from energy: energy_mj, its parts, power_w, and of perf nj_per_ray,
/// frames_per_joule_gpu and frames_per_joule_tni.
sim::Json energy_totals_json(const sim::EnergyReport& energy, const WorkDone& work);

/// Adds to a report's totals the area of its machine by block and by what it is, and what the frame gives for it:
/// perf.frames_per_joule_per_mm2, perf.mrays_per_s_per_mm2. Nothing for a configuration without area figures.
void add_area(sim::Json& totals, std::span<const sim::UnitReport> units, const RunConfig& config);

}  // namespace tools
