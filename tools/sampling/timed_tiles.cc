#include "tools/sampling/timed_tiles.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "hw_models/srp/tile_buffer.h"
#include "sim/hash.h"
#include "sim/host_clock.h"

namespace tools {

TimedTiles::TimedTiles(hw::TileSource& source, std::vector<TimedBlock> blocks, std::vector<std::uint32_t> marked,
                       std::optional<std::uint32_t> stop_at)
    : source_(source), blocks_(std::move(blocks)), marked_(std::move(marked)), stop_at_(stop_at) {}

const traces::TileWork* TimedTiles::next() {
  while (block_ < blocks_.size()) {
    const TimedBlock& block = blocks_[block_];
    const traces::TileWork* work = source_.next();
    if (work == nullptr) return nullptr;
    if (work->tile >= block.first) {
      if (work->tile + 1 == block.end) block_ += 1;
      waiting_.push_back(work->tile);
      return work;
    }
    if (work->tile + block.warming >= block.first) {
      for_warming_.push_back(work);
    } else {
      source_.release_work(work);
    }
  }
  while (const traces::TileWork* work = source_.next()) source_.release_work(work);
  return nullptr;
}

void TimedTiles::release_work(const traces::TileWork* work) {
  back_.push_back(work->tile);
  source_.release_work(work);
}

void TimedTiles::note_dispatched(sim::Time now) {
  const std::uint32_t tile = waiting_.back();
  waiting_.pop_back();
  for (const std::uint32_t ended : back_) {
    std::ranges::find(simulated_.rbegin(), simulated_.rend(), ended, &TimedTile::tile)->end = now;
  }
  back_.clear();
  if (tile >= blocks_[dispatched_block_].end) dispatched_block_ += 1;
  if (std::ranges::binary_search(marked_, tile)) {
    gpu_->account_until(now);
    marks_.push_back({tile, now, gpu_->unit_reports(), gpu_->kernel_use()});
  }
  if (tile == blocks_[dispatched_block_].first) warm_caches();
  simulated_.push_back({tile, now, now});
  if (stop_at_ == tile) gpu_->stop_early();
}

void TimedTiles::warm_caches() {
  const sim::HostClock::time_point begin = sim::HostClock::now();
  std::uint32_t core = 0;
  for (const traces::TileWork* work : for_warming_) {
    gpu_->warm_caches(*work, core);
    core = core + 1 == gpu_->core_count() ? 0 : core + 1;
    source_.release_work(work);
  }
  warmed_ += for_warming_.size();
  for_warming_.clear();
  warming_seconds_ += sim::seconds_since(begin);
}

void TimedTiles::finish_tile_times() {
  for (TimedTile& tile : simulated_) {
    if (tile.end == tile.begin) tile.end = gpu_->elapsed_time();
  }
}

const Mark& TimedTiles::snapshot_at(std::uint32_t tile) const { return *std::ranges::find(marks_, tile, &Mark::tile); }

namespace {

/// Bytes of cache that one sample of a warming tile is assumed to fill: in the L2, and in all first-level caches
/// together. Both give eight warming tiles of 16 x 16 samples for the default machine.
constexpr std::uint64_t kSecondLevelBytes = 128, kFirstLevelBytes = 224;

}  // namespace

std::uint32_t warming_tiles(const hw::GpuConfig& gpu, std::uint32_t tile_samples) {
  const std::uint64_t first_level = gpu.cores * (gpu.tni.trvs * gpu.tni.trv.l1.size.bytes + gpu.tni.ist.l1.size.bytes +
                                                 gpu.srp.data_cache.size.bytes);
  const std::uint64_t samples = std::max(gpu.l2.cache.size.bytes / kSecondLevelBytes, first_level / kFirstLevelBytes);
  return std::max(PlanShape{}.warming, static_cast<std::uint32_t>(samples / tile_samples));
}

TilePlan plan_tiles(std::span<const double> costs, double share, const PlanShape& shape, std::uint64_t seed) {
  const auto tiles = static_cast<std::uint32_t>(costs.size());
  const std::uint32_t length = shape.lead + shape.measured;
  const double all = std::accumulate(costs.begin(), costs.end(), 0.0);
  double squares = 0;
  for (const double cost : costs) squares += cost * cost;
  // A tile is drawn with probability proportional to its cost, so this is the mean cost of a drawn tile.
  const double drawn = squares / all;
  const auto count = std::max<std::uint32_t>(
      shape.least, static_cast<std::uint32_t>(std::lround(share * all / (drawn * shape.measured))));
  const std::uint64_t sampled = std::uint64_t{count} * length;
  const std::uint64_t edges = 2 * std::uint64_t{shape.edge} + shape.lead;
  if (edges + sampled + sampled / 2 >= tiles) return {{{0, 0, tiles, 0}}, true, 0, tiles};

  TilePlan plan{{{0, 0, shape.edge, 0}}, false, shape.edge, tiles - shape.edge};
  const std::uint32_t last = plan.end - shape.lead - length;  // latest start of a block
  // Prefix sums of the cost of measured parts, by the start of their block.
  std::vector<double> before(1);
  for (std::uint32_t first = plan.begin; first <= last; ++first) {
    const auto measured = costs.subspan(first + shape.lead, shape.measured);
    before.push_back(std::accumulate(measured.begin(), measured.end(), before.back()));
  }
  for (std::uint32_t k = 0; k < count; ++k) {
    const double at = before.back() * (k + static_cast<double>(sim::hash_to_unit_float(sim::hash(seed, k)))) / count;
    const auto found = std::ranges::upper_bound(before, at) - before.begin() - 1 + plan.begin;
    const std::uint32_t free = plan.blocks.back().end;
    const std::uint32_t first = std::max(free, static_cast<std::uint32_t>(found));
    if (first > last) break;
    plan.blocks.push_back({first, first + shape.lead, first + length, std::min(shape.warming, first - free)});
  }
  const std::uint32_t free = plan.blocks.back().end;
  const std::uint32_t ending = plan.end - shape.lead;
  plan.blocks.push_back({ending, plan.end, tiles, std::min(shape.warming, ending - free)});
  return plan;
}

namespace {

/// Length of the lead of a slice (tiles that only fill the machine), in thirds of the number of tiles in flight. The
/// first tiles of a machine start together, unlike tiles in the middle of a frame. The lead lasts until this effect has
/// decayed (docs/slices.md).
constexpr std::uint32_t kLeadOfThree = 5;

/// Number of lead lengths below which a frame or slice is short. Short ones get leads of twice the length, because
/// errors at borders are a larger share of their time (docs/slices.md).
constexpr std::uint32_t kLeadsOfASmallFrame = 50, kLeadsOfAShortSlice = 5;

}  // namespace

SliceShape slice_shape(const hw::GpuConfig& gpu, const traces::FrameRequirements& requirements) {
  const std::uint32_t in_flight =
      gpu.cores * hw::tiles_in_flight(gpu.tile_buffer, requirements, gpu.ideal.tile_buffer).max_tiles();
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
    const std::uint32_t last = tiles - (count - k) * shape.lead;  // leaves enough tiles for the remaining slices
    const std::uint32_t end = k == count ? tiles : std::clamp(fair, first + shape.lead, last);
    const std::uint32_t lead = std::min(wanted, first);
    slices.push_back(
        // the tiles of the lead also warm the caches
        {first, end, lead, std::min(std::max(shape.warming, lead), first) - lead});
    first = end;
  }
  return slices;
}

}  // namespace tools
