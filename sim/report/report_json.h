#pragma once
#include <span>
#include <string>

#include "sim/io/json.h"
#include "sim/report/energy.h"
#include "sim/unit_report.h"

namespace sim {

/// {low, nominal, high}, each times `factor`.
Json spread_json(const Spread& spread, double factor = 1);

/// The units as a tree by the parts of their paths: "core0.tni.trv2" is at ["core0"]["tni"]["trv2"], with
/// {elapsed, why{reason: cycles}, counters{name: value}}. In the order given.
Json units_json(std::span<const UnitReport> units);

/// {energy_mj, energy_by_block_mj{block}, energy_by_kind_mj{dynamic, clock, leakage}}, each a spread in millijoules,
/// and energy_by_event_mj{block{event}}, nominal.
Json energy_json(const EnergyReport& energy);

/// The text of a report file: indented, one line end at the end. Numbers are the shortest that read back exactly, so
/// equal reports are equal bytes.
std::string json_text(const Json& json);

}  // namespace sim
