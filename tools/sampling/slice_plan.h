#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "traces/stream.h"

namespace hw {
struct GpuConfig;
}

namespace tools {

/// Consecutive tiles [first, end) of a frame that one of several machines plays.
///
///   warming tiles | lead ........ probe | first .............. probe | end
///   caches alone  | fills the machine   | what counts                | dispatched, and the machine is stopped
///
/// Time and counters from the dispatch of `first` to that of `end` count. The frame's first slice begins and its last
/// one ends as the frame does.
struct Slice {
  std::uint32_t first = 0, end = 0;
  std::uint32_t lead = 0, warming = 0;
  std::uint32_t lead_begin() const { return first - lead; }
  std::uint32_t begin() const { return first - lead - warming; }
  bool owns(std::uint32_t tile) const { return tile >= first && tile < end; }
};

struct SliceShape {
  std::uint32_t lead = 0;     ///< a short lead, of tiles that fill a machine; a slice has as many at least
  std::uint32_t probe = 0;    ///< the last of these, which the machine before plays as its own last
  std::uint32_t warming = 0;  ///< tiles before a slice that warm the caches, those of its lead among them
};

SliceShape slice_shape(const hw::GpuConfig& gpu, const traces::FrameRequirements& requirements);

/// A frame's tiles cut into `count` slices of equal cost, as far as each has tiles enough, which must be there. Short
/// slices, and those of small frames, have leads twice as long.
std::vector<Slice> plan_slices(std::span<const double> costs, std::uint32_t count, const SliceShape& shape);

}  // namespace tools
