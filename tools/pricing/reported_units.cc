#include "tools/pricing/reported_units.h"

#include <string_view>

#include <fmt/format.h>

#include "hw_models/build/tree_builder.h"
#include "hw_models/memory/unit_names.h"
#include "hw_models/raster/raster_unit.h"
#include "sim/config/load.h"
#include "sim/error.h"
#include "sim/io/printable.h"

namespace tools {
namespace {

using sim::Json;

std::string name_of(const ReportFile& report) { return sim::printable(report.file.string()); }

/// Returns the JSON node of a unit, such as "core0.tni.trv2", in the tree `units` of a report; null if there is none.
const Json* node_of(const Json& units, std::string_view path) {
  const std::size_t dot = path.find('.');
  const auto found = units.find(std::string(path.substr(0, dot)));
  if (found == units.end() || !found->is_object()) return nullptr;
  return dot == std::string_view::npos ? &*found : node_of(*found, path.substr(dot + 1));
}

std::size_t units_below(const Json& node, int depth = 0) {
  constexpr int kDeepest = 32;
  if (!node.is_object() || depth > kDeepest) return 0;
  std::size_t count = node.contains("counters") ? 1 : 0;
  for (const auto& [name, child] : node.items()) {
    if (name != "counters" && name != "why") count += units_below(child, depth + 1);
  }
  return count;
}

}  // namespace

RunConfig reported_config(const ReportFile& report) {
  const auto json = report.json.find("config");
  if (json == report.json.end() || !json->is_object()) {
    throw sim::InputError(fmt::format("{}: has no config, so its counts cannot be priced", name_of(report)));
  }
  RunConfig config;
  sim::ConfigNode tree = sim::config_tree(config);
  sim::ConfigLoader(tree).apply_text(sim::json_line(*json), name_of(report) + ": config");
  check_run_config(config, name_of(report));
  return config;
}

ReportedCounts::ReportedCounts(const ReportFile& report) : report_(report) {
  const auto units = report.json.find("units");
  if (units == report.json.end()) refuse("it has no units");
  units_ = &*units;
}

void ReportedCounts::fill(std::vector<sim::UnitReport>& units) const {
  if (const std::size_t found = units_below(*units_); found != units.size()) {
    refuse(fmt::format("it has {} units, the machine of its configuration {}", found, units.size()));
  }
  for (sim::UnitReport& unit : units) {
    const Json* node = node_of(*units_, unit.path);
    if (node == nullptr) refuse(fmt::format("unit {} is not there", unit.path));
    for (auto& [reason, cycles] : unit.cycles_by_reason) cycles = number(*node, "why", reason, unit);
    for (sim::CounterReport& counter : unit.counters) counter.value = number(*node, "counters", counter.name, unit);
  }
}

OptionalUnits ReportedCounts::optional_units() const {
  return {.rasterisers = node_of(*units_, hw::unit_name_in_core(hw::RasterUnit::kName, 0)) != nullptr,
          .tree_builder = node_of(*units_, hw::TreeBuilder::kName) != nullptr};
}

void ReportedCounts::refuse(const std::string& why) const {
  throw sim::InputError(
      fmt::format("{}: cannot be priced: {}; allowed: reports of this version's model", name_of(report_), why));
}

std::uint64_t ReportedCounts::number(const Json& node, const char* group, const std::string& name,
                                     const sim::UnitReport& unit) const {
  const auto in = node.find(group);
  if (in != node.end() && in->is_object()) {
    const auto value = in->find(name);
    if (value != in->end() && value->is_number_unsigned()) return value->get<std::uint64_t>();
  }
  refuse(fmt::format("units.{}.{}.{} is no count", unit.path, group, name));
}

}  // namespace tools
