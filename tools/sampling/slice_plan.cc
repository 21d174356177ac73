#include "tools/sampling/slice_plan.h"

#include <algorithm>
#include <numeric>

#include "hw_models/srp/tile_buffer.h"
#include "tools/sampling/tile_plan.h"

namespace tools {
namespace {

/// Tiles of a lead per three tiles in flight. The first tiles start together, unlike those in the middle of a frame;
/// the lead lasts until this effect has decayed (docs/slices.md).
constexpr std::uint32_t kLeadOfThree = 5;

/// Below these lengths, in leads, frames and slices get leads of twice the length, because border errors are a larger
/// part of their time (docs/slices.md).
constexpr std::uint32_t kLeadsOfASmallFrame = 50, kLeadsOfAShortSlice = 5;

}  // namespace

SliceShape slice_shape(const hw::GpuConfig& gpu, const traces::FrameRequirements& requirements) {
  const std::uint32_t in_flight =
      gpu.cores * hw::tiles_in_flight(gpu.tile_buffer, requirements, gpu.ideal.tile_buffer).most();
  const std::uint32_t lead = (kLeadOfThree * in_flight + 2) / 3;
  return {.lead = lead, .probe = lead - in_flight, .warming = warming_tiles(gpu, requirements.tile_samples)};
}

std::vector<Slice> plan_slices(std::span<const double> costs, std::uint32_t count, const SliceShape& shape) {
  const auto tiles = static_cast<std::uint32_t>(costs.size());
  std::vector<double> up_to(costs.size());
  std::partial_sum(costs.begin(), costs.end(), up_to.begin());
  const bool must_be_long =
      tiles < kLeadsOfASmallFrame * shape.lead || tiles / count < kLeadsOfAShortSlice * shape.lead;
  const std::uint32_t wanted = must_be_long ? 2 * shape.lead : shape.lead;
  std::vector<Slice> slices;
  std::uint32_t first = 0;
  for (std::uint32_t k = 1; k <= count; ++k) {
    const double share = up_to.back() * k / count;
    const auto fair = static_cast<std::uint32_t>(std::ranges::lower_bound(up_to, share) - up_to.begin()) + 1;
    const std::uint32_t last = tiles - (count - k) * shape.lead;  // leaves enough tiles for the others
    const std::uint32_t end = k == count ? tiles : std::clamp(fair, first + shape.lead, last);
    const std::uint32_t lead = std::min(wanted, first);
    slices.push_back(
        {first, end, lead, std::min(std::max(shape.warming, lead), first) - lead});  // leads warm the caches, too
    first = end;
  }
  return slices;
}

}  // namespace tools
