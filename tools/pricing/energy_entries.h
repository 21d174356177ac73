#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "sim/report/energy_table.h"
#include "tools/run/frame/load_config.h"

namespace tools {

/// A figure of the energy tables, or a curve of them over size, bound to a configuration.
struct EnergyEntry {
  std::string name;  ///< "energy.events.cache.l1_read", "energy.clock_share", "dram.energy.refresh"
  std::string unit;
  std::string meaning;  ///< meaning of the key it stands in
  std::uint64_t hash = 0;
  /// A figure of the configuration, and its band before anybody has drawn from it.
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

/// Entries of all tables, those without a band too, in the order of the configuration. `config` must outlive them.
std::vector<EnergyEntry> energy_entries(RunConfig& config);

/// The figure at a quantile of its band: low at 0, nominal at 1/2, high at 1, and between them evenly in its logarithm,
/// or, where low is 0, in itself.
double at_quantile(const sim::Spread& band, double quantile);

/// Independent draws of all entries. Entries of a name have one quantile in all designs and in all points of a curve.
struct EnergyDraw {
  std::uint64_t seed = 1;
  std::uint64_t number = 0;
  double quantile(const EnergyEntry& entry) const;
};

}  // namespace tools
