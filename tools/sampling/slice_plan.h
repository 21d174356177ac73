#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "traces/stream.h"

namespace hw {
struct GpuConfig;
}

namespace tools {

/// Consecutive tiles [first, end) of a frame that one of several machines simulates.
///
///   warming tiles | lead ........ probe | first .............. probe | end
///   caches only   | fills the machine   | counted                    | dispatched; the machine is stopped
///
/// Time and counters count from the dispatch of `first` to that of `end`. The first slice starts, and the last slice
/// ends, like a whole frame.
struct Slice {
  std::uint32_t first = 0, end = 0;
  std::uint32_t lead = 0, warming = 0;
  std::uint32_t lead_begin() const { return first - lead; }
  std::uint32_t begin() const { return first - lead - warming; }
  bool owns(std::uint32_t tile) const { return tile >= first && tile < end; }
};

struct SliceShape {
  std::uint32_t lead = 0;     ///< length of a short lead, which fills the machine; the minimum length of a slice
  std::uint32_t probe = 0;    ///< tiles at the end of the lead that the previous machine simulates as its last
  std::uint32_t warming = 0;  ///< tiles before a slice that warm the caches, including its lead
};

SliceShape slice_shape(const hw::GpuConfig& gpu, const traces::FrameRequirements& requirements);

/// Splits a frame's tiles into `count` slices of equal cost, as far as each has at least the minimum length. Leads of
/// short slices and small frames are twice as long.
std::vector<Slice> plan_slices(std::span<const double> costs, std::uint32_t count, const SliceShape& shape);

}  // namespace tools
