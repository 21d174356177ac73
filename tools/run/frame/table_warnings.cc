#include "tools/run/frame/table_warnings.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "hw_models/machines/gpu_config.h"
#include "sim/io/printable.h"
#include "sim/report/table_checks.h"
#include "tools/run/frame/machine_run.h"
#include "tools/run/frame/power.h"

namespace tools {
namespace {

/// Returns the process node without blanks: "14nm" for "14 nm, 0.80 V, 75 C".
std::string process_node_name(std::string process) {
  std::erase(process, ' ');
  return process.substr(0, process.find(','));
}

}  // namespace

std::vector<std::string> process_warnings(const RunConfig& config) {
  std::vector<std::pair<const char*, std::string>> tables = {{"energy", config.energy.process}};
  if (!config.area.arrays.empty()) tables.emplace_back("area", config.area.process);
  if (!config.power.dvfs.empty()) tables.emplace_back("power", config.power.process);
  if (uses_latency_table(config)) tables.emplace_back("latency", config.latency.process);
  std::erase_if(tables, [](const auto& table) { return table.second == sim::EnergyConfig().process; });
  const auto differs = [&](const auto& table) {
    return process_node_name(table.second) != process_node_name(tables.front().second);
  };
  if (std::ranges::none_of(tables, differs)) return {};
  std::vector<std::string> texts;
  for (const auto& [name, process] : tables) {
    texts.push_back(fmt::format("{}.process is '{}'", name, sim::printable(process)));
  }
  return {fmt::format("process: {}: results mix processes; process={} sets all tables", fmt::join(texts, ", "),
                      sim::printable(process_node_name(tables.front().second)))};
}

std::vector<std::string> technology_table_warnings(const RunConfig& config, std::span<const sim::UnitReport> units) {
  std::vector<std::string> lines = sim::curve_range_warnings(units, config.energy.events, config.area.arrays);
  std::ranges::move(latency_warnings(config), std::back_inserter(lines));
  std::ranges::move(power_warnings(config), std::back_inserter(lines));
  std::ranges::move(process_warnings(config), std::back_inserter(lines));
  return lines;
}

std::vector<std::string> technology_table_warnings(const RunConfig& config) {
  return technology_table_warnings(config, idle_unit_reports(*config.gpu, optional_units_of(config), config.bvh));
}

void add_warnings(std::vector<std::string>& lines, const std::vector<std::string>& more) {
  for (const std::string& line : more) {
    if (std::ranges::find(lines, line) == lines.end()) lines.push_back(line);
  }
}

}  // namespace tools
