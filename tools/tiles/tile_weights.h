#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "tools/run/frame/run_job.h"

namespace tools {

/// Parts that tiles had of a machine's work: a number for each tile and kind of work, by which the energy of that kind
/// is shared out.
class TileWeights {
 public:
  explicit TileWeights(const FrameResult& s);

  /// Kinds of work.
  std::size_t count() const { return kinds_; }
  double of(std::size_t tile, std::size_t kind) const { return values_[tile * kinds_ + kind]; }
  double of_rest(std::size_t kind) const { return rest_[kind]; }
  /// Sum over all tiles of a core; without one, over all tiles and what no tile has asked for.
  double sum(std::size_t kind, std::optional<std::uint32_t> core) const;

  /// The kind by which a counter of a unit is shared out; nothing for one that time moves.
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
