#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "tools/run/frame/run_job.h"

namespace tools {

/// Each tile's part of a machine's work: a number per tile and kind of work, by which the energy of that kind is shared
/// out.
class TileWeights {
 public:
  explicit TileWeights(const FrameResult& s);

  /// Returns the number of kinds of work.
  std::size_t count() const { return kinds_; }
  double of(std::size_t tile, std::size_t kind) const { return values_[tile * kinds_ + kind]; }
  double of_rest(std::size_t kind) const { return rest_[kind]; }
  /// Returns the sum over all tiles of a core; without a core, over all tiles and requests without a tile.
  double sum(std::size_t kind, std::optional<std::uint32_t> core) const;

  /// Returns the kind of work for a counter of a unit; none if it depends on time.
  static std::optional<std::size_t> of_counter(const sim::UnitReport& unit, std::string_view counter);

 private:
  void add_account(const hw::TileAccount& account, double* values) const;
  void add_kernels(const FrameResult& s);

  const FrameResult& s_;
  const std::size_t kinds_;
  std::vector<double> values_;  ///< tile by tile
  std::vector<double> rest_;
};

}  // namespace tools
