#include "tools/analysis/warnings.h"

#include <algorithm>
#include <iterator>

#include <fmt/format.h>

#include "sim/io/printable.h"
#include "sim/report/table_checks.h"
#include "tools/run/frame/power.h"

namespace tools {
namespace {

/// Ratio of simulated to requested tiles that causes a warning. Chosen: blocks are whole tiles.
constexpr double kMuchMore = 1.5;

/// Returns "14nm" for "14 nm, 0.80 V, 75 C".
std::string node_of(std::string process) {
  std::erase(process, ' ');
  return process.substr(0, process.find(','));
}

/// True if area and energy tables are of different processes; leakage and results per mm2 use both.
bool are_of_two_processes(const RunConfig& config) {
  return !config.area.arrays.empty() && config.area.process != sim::AreaConfig().process &&
         config.energy.process != sim::EnergyConfig().process &&
         node_of(config.area.process) != node_of(config.energy.process);
}

}  // namespace

std::vector<std::string> extrapolation_warnings(const RunConfig& config, std::span<const sim::UnitReport> units) {
  std::vector<std::string> lines = sim::sizes_outside_curves(units, config.energy.events, config.area.arrays);
  std::ranges::move(latency_warnings(config), std::back_inserter(lines));
  std::ranges::move(power_warnings(config), std::back_inserter(lines));
  return lines;
}

std::vector<std::string> run_warnings(const RunConfig& config, std::span<const sim::UnitReport> units,
                                      const std::optional<SampledFrame>& sampled) {
  std::vector<std::string> lines = extrapolation_warnings(config, units);
  if (are_of_two_processes(config)) {
    lines.push_back(
        fmt::format("area.process is '{}' and energy.process '{}': frames per joule and mm2 are of a chip in "
                    "two processes",
                    sim::printable(config.area.process), sim::printable(config.energy.process)));
  }
  if (!sampled || sampled->asked == 0) return lines;
  const double timed = static_cast<double>(sampled->timed) / static_cast<double>(sampled->tiles);
  if (timed > kMuchMore * sampled->asked) {
    lines.push_back(
        fmt::format("--tile-sampling {:.3g}% has timed {:.3g} % of the tiles: the frame is too small for "
                    "less, as it begins, ends and is cut into blocks of several tiles",
                    100 * sampled->asked, 100 * timed));
  }
  return lines;
}

}  // namespace tools
