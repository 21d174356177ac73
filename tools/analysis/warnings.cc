#include "tools/analysis/warnings.h"

#include <algorithm>
#include <iterator>

#include <fmt/format.h>

#include "sim/report/curve_range.h"
#include "tools/simulation/power.h"

namespace tools {
namespace {

/// Tiles that are timed over the share that was asked for, from which on it is said: chosen, as blocks are whole tiles.
constexpr double kMuchMore = 1.5;

}  // namespace

std::vector<std::string> run_warnings(const RunConfig& config, std::span<const sim::UnitReport> units,
                                      const std::optional<SampledFrame>& sampled) {
  std::vector<std::string> lines = sim::sizes_outside_curves(units, config.energy.events, config.area.arrays);
  std::ranges::move(latency_warnings(config), std::back_inserter(lines));
  std::ranges::move(power_warnings(config), std::back_inserter(lines));
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
