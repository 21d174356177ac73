#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "sim/report/energy_table.h"
#include "tools/run/frame/load_config.h"

namespace tools {

/// A figure of the energy tables, or a curve of figures over size, bound to a configuration.
struct EnergyEntry {
  std::string name;  ///< "energy.events.cache.l1_read", "energy.clock_share", "dram.energy.refresh"
  std::string unit;
  std::string meaning;  ///< meaning of its key
  std::uint64_t hash = 0;
  /// A figure of the configuration, and its band before any draw.
  struct Figure {
    std::string name;  ///< with its size, "energy.events.cache.l1_read@16KiB"
    sim::Spread* value;
    sim::Spread band;
  };
  std::vector<Figure> figures;  ///< points of the curve, or one

  bool has_band() const;
  /// Sets the nominal figure of each point to a quantile of its band.
  void set_quantile(double quantile);
  void restore();
};

/// Returns the entries of all tables, including those without a band, in the order of the configuration. `config` must
/// outlive them.
std::vector<EnergyEntry> energy_entries(RunConfig& config);

/// Returns the figure at a quantile of its band: low at 0, nominal at 1/2, high at 1. Between them it interpolates the
/// logarithm, or the figure itself if low is 0.
double at_quantile(const sim::Spread& band, double quantile);

/// Independent draws of all entries. Entries of one name have the same quantile in all designs and at all points of a
/// curve.
struct EnergyDraw {
  std::uint64_t seed = 1;
  std::uint64_t number = 0;
  double quantile(const EnergyEntry& entry) const;
};

}  // namespace tools
