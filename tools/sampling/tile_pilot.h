#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "hw_models/memory/cache_tags.h"
#include "hw_models/srp/schedule.h"
#include "traces/accel/memory_image.h"
#include "traces/stream.h"

namespace hw {
struct GpuConfig;
}

namespace tools {

/// Traits of a tile that tell its cost without playing it on the machine.
struct TileTraits {
  double tiles = 0;
  double array = 0;        ///< cycles of the shader core's array, without prologues
  double visits = 0;       ///< visits of nodes
  double tests = 0;        ///< tests of triangles
  double l1_misses = 0;    ///< misses of the traversal and intersection units' caches
  double data_misses = 0;  ///< misses of the data cache
  double l2_misses = 0;
  double spills = 0;  ///< ray slots beyond a tile's share of the tile buffer, launch by launch
  double path = 0;    ///< T&I cycles of the longest chain of launches and rays, if the tile were alone

  static constexpr std::size_t kCount = 9;
  static constexpr double TileTraits::*kAll[kCount] = {
      &TileTraits::tiles,       &TileTraits::array,     &TileTraits::visits, &TileTraits::tests, &TileTraits::l1_misses,
      &TileTraits::data_misses, &TileTraits::l2_misses, &TileTraits::spills, &TileTraits::path};
  void add(const TileTraits& other, double factor = 1) {
    for (const auto member : kAll) this->*member += factor * (other.*member);
  }
};

/// Looks at tiles that hold one of every `thinning` samples of a frame's tiles, in order, and says what whole ones
/// would come to. Caches are tags alone, filled at once; tiles go to cores in turn, rays to traversal units in turn.
class TilePilot {
 public:
  /// `slots`: a tile's share of the ray slots of a core's tile buffer.
  TilePilot(const hw::GpuConfig& config, const traces::Layout& layout, std::span<const hw::KernelSchedule> kernels,
            double thinning, double slots);

  TileTraits look(const traces::TileWork& work);
  /// T&I cycles that the whole machine might take for it: for the choice of tiles, not an estimate.
  double cost(const TileTraits& traits) const;

 private:
  struct Core {
    std::vector<hw::CacheTags> trvs;
    hw::CacheTags ist, data;
  };
  double path(const traces::TileWork& work);
  double spills(const traces::TileWork& work);

  const hw::GpuConfig& config_;
  const traces::Layout& layout_;
  const std::span<const hw::KernelSchedule> kernels_;
  const double thinning_;
  const double slots_;      ///< a tile's share of the ray slots
  const double srp_cycle_;  ///< in T&I cycles
  std::vector<Core> cores_;
  hw::CacheTags l2_;
  std::vector<std::uint32_t> steps_;  ///< steps of each ray of the tile
  std::vector<double> done_;          ///< time at which each node of its work is done
  std::vector<double> made_;          ///< likewise, rays that a launch makes
};

}  // namespace tools
