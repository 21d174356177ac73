#include "tools/run/frame/cache_latency.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "hw_models/machines/gpu_config.h"
#include "sim/config/quantity.h"
#include "sim/error.h"
#include "sim/io/printable.h"
#include "sim/report/energy_table.h"
#include "tools/run/frame/load_config.h"

namespace tools {
namespace {

constexpr const char* kCurve = "read";
/// Tolerance for rounding: a latency that exceeds a whole number of cycles by less is not rounded up.
constexpr double kCycleRounding = 1e-9;

struct Cache {
  std::string path;
  hw::CacheConfig& cache;
  std::uint64_t hz;
  std::uint32_t around;  ///< cycles of a hit in addition to the array's
};

std::array<Cache, 3> caches_of(RunConfig& config) {
  hw::GpuConfig& gpu = *config.gpu;
  return {{{"tni.trv.l1", gpu.tni.trv.l1, gpu.clocks.tni.hz, config.latency.l1},
           {"tni.ist.l1", gpu.tni.ist.l1, gpu.clocks.tni.hz, config.latency.l1},
           {"l2", gpu.l2.cache, gpu.clocks.l2.hz, config.latency.l2}}};
}

const sim::EnergyCurve& curve_of(const sim::EnergyTable& table, const std::string& path) {
  if (!table.contains(kCurve) || !table.curve(kCurve).depends_on_size()) {
    throw sim::InputError(
        fmt::format("{}.hit_cycles: auto needs latency.arrays; allowed: a number, or points such as "
                    "read@16KiB, as in latency.extends=latency/22nm",
                    path));
  }
  return table.curve(kCurve);
}

/// An entry that no cache reads is a misspelling.
void check_names(const sim::EnergyTable& table) {
  for (const std::string& name : table.names()) {
    if (name == kCurve) continue;
    throw sim::InputError(
        fmt::format("latency.arrays.{}: no latency goes by this name; allowed: {}, with a size such as "
                    "{}@16KiB",
                    sim::printable(name), kCurve, kCurve));
  }
}

}  // namespace

void set_hit_cycles(RunConfig& config) {
  constexpr double kHzPerNanosecond = 1e9;
  const sim::EnergyTable table(config.latency.arrays, "latency.arrays");
  check_names(table);
  for (const Cache& c : caches_of(config)) {
    if (!c.cache.hit_cycles.is_auto) continue;
    const sim::EnergyCurve& curve = curve_of(table, c.path);
    if (c.cache.size.bytes == 0) continue;  // check_tree() refuses it
    const double ns = curve.at(c.cache.size.bytes).at(&sim::Band::nominal);
    const double cycles = std::ceil(ns * static_cast<double>(c.hz) / kHzPerNanosecond - kCycleRounding);
    c.cache.hit_cycles.value = std::max(1U, c.around + static_cast<std::uint32_t>(cycles));
  }
}

std::vector<std::string> latency_warnings(const RunConfig& config) {
  std::vector<std::string> lines;
  RunConfig read = config;
  const sim::EnergyTable table(read.latency.arrays, "latency.arrays");
  for (const Cache& c : caches_of(read)) {
    if (!c.cache.hit_cycles.is_auto) continue;
    const sim::EnergyCurve& curve = curve_of(table, c.path);
    const std::uint64_t bytes = c.cache.size.bytes;
    if (bytes >= curve.least_bytes() && bytes <= curve.most_bytes()) continue;
    const auto size = [](std::uint64_t b) { return sim::quantity_text(b, sim::byte_units()); };
    lines.push_back(fmt::format(
        "latency.arrays: {} has {}, outside {} to {} of {}, and its hit_cycles of {} are extrapolated", c.path,
        size(bytes), size(curve.least_bytes()), size(curve.most_bytes()), kCurve, c.cache.hit_cycles.value));
  }
  return lines;
}

}  // namespace tools
