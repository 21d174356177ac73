#pragma once
#include <nlohmann/json_fwd.hpp>

#include "sim/report/energy.h"

namespace tools {

/// Amount of work that energy is divided by.
struct WorkDone {
  double time_ms = 0, rays = 0, frames = 0;
};

inline constexpr double kPicojoulesPerMillijoule = 1e9;

/// Everything in a report's totals that follows from energy: energy_mj, its parts, power_w, and of perf nj_per_ray,
/// frames_per_joule_gpu and frames_per_joule_tni.
nlohmann::ordered_json energy_totals_json(const sim::EnergyReport& energy, const WorkDone& work);

}  // namespace tools
