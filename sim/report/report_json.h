#pragma once
#include <span>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "sim/report/energy.h"
#include "sim/unit_report.h"

namespace sim {

/// {low, nominal, high}, each times `factor`.
nlohmann::ordered_json spread_json(const Spread& spread, double factor = 1);

/// The units as a tree by the parts of their paths: "core0.tni.trv2" is at ["core0"]["tni"]["trv2"], with
/// {elapsed, why{reason: cycles}, counters{name: value}}. In the order given.
nlohmann::ordered_json units_json(std::span<const UnitReport> units);

/// {energy_mj, energy_by_block_mj{block}, energy_by_kind_mj{dynamic, clock, leakage}}, each a spread in millijoules,
/// and energy_by_event_mj{block{event}}, nominal.
nlohmann::ordered_json energy_json(const EnergyReport& energy);

/// The text of a report file: indented, one line end at the end. Numbers are the shortest that read back exactly, so
/// equal reports are equal bytes.
std::string json_text(const nlohmann::ordered_json& json);

}  // namespace sim
