#include "tools/timeline/tracks.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

namespace tools {
namespace {

/// Ranks of tracks within a core, top to bottom.
enum Rank : std::int32_t { kOfTiles = 0, kOfSrp = 100, kOfRays = 101, kOfDma = 102, kOfCounters = 103 };

}  // namespace

std::uint64_t TimelineTracks::add(std::uint64_t parent, std::string name, std::int32_t rank, std::string unit) {
  const std::uint64_t id = shared() + tracks_.size() + 1;
  tracks_.push_back({id, parent, std::move(name), rank, std::move(unit)});
  return id;
}

std::uint64_t TimelineTracks::of(const RecordedSlice& slice) {
  Core& core = cores_[slice.core];
  const std::uint64_t parent = process(slice.core);
  switch (slice.kind) {
    case RecordedSlice::Kind::kLoop:
      if (core.srp == 0) core.srp = add(parent, "SRP", kOfSrp);
      return core.srp;
    case RecordedSlice::Kind::kTransfer:
      if (core.dma == 0) core.dma = add(parent, "DMA", kOfDma);
      return core.dma;
    case RecordedSlice::Kind::kTile: {
      if (core.slots.size() <= slice.slot) core.slots.resize(std::size_t{slice.slot} + 1);
      std::uint64_t& slot = core.slots[slice.slot];
      if (slot == 0) slot = add(parent, fmt::format("tile slot {}", slice.slot), kOfTiles + slice.slot);
      return slot;
    }
    case RecordedSlice::Kind::kRays:
      break;
  }
  const auto is_free = [&](const Lane& lane) { return lane.free_at <= slice.begin; };
  auto lane = std::ranges::find_if(core.rays, is_free);
  if (lane == core.rays.end()) {
    core.rays.push_back({add(parent, "T&I rays", kOfRays), 0});
    lane = core.rays.end() - 1;
  }
  lane->free_at = slice.end;
  return lane->id;
}

std::uint64_t TimelineTracks::shared_counter(const std::string& name, const std::string& unit) {
  return add(shared(), name, kOfCounters, unit);
}

std::uint64_t TimelineTracks::core_counter(std::uint32_t core, const std::string& name, const std::string& unit) {
  return add(process(core), name, kOfCounters, unit);
}

void TimelineTracks::describe(TracePackets& to) const {
  for (std::uint32_t core = 0; core < cores_.size(); ++core) {
    to.add_process(process(core), fmt::format("core {}", core), static_cast<std::int32_t>(core));
  }
  to.add_process(shared(), "shared", static_cast<std::int32_t>(cores_.size()));
  for (const TimelineTrack& track : tracks_) to.add_track(track);
}

}  // namespace tools
