#pragma once
#include <span>

#include "sim/io/json.h"
#include "sim/report/energy.h"
#include "sim/unit_report.h"

namespace sim {

/// Returns a Band as JSON {low, nominal, high}, each multiplied by `factor`.
Json band_json(const Band& band, double factor = 1);

/// Returns the reports of units as a JSON tree that follows the parts of their paths: "core0.tni.trv2" is at
/// ["core0"]["tni"]["trv2"]. A unit is {elapsed, why{reason: cycles}, counters{name: value}}. Keeps the order of the
/// units.
Json units_json(std::span<const UnitReport> units);

/// Returns an energy report as JSON, in mJ: {energy_mj, energy_by_block_mj{block}, energy_by_kind_mj{dynamic, clock,
/// leakage}, energy_by_event_mj{block{event}}}. Events have nominal values, all others bands.
Json energy_json(const EnergyReport& energy);

}  // namespace sim
