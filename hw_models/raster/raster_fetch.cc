#include "hw_models/raster/raster_fetch.h"

#include <algorithm>
#include <bit>

#include <fmt/format.h>

namespace hw {

void RasterFetch::enter(const traces::RasterTriangle& triangle, std::uint32_t entry, Owner owner) {
  l1_.belongs(static_cast<std::uint32_t>(entered_ % slots_.size()), owner);
  Slot& s = slot(entered_++);
  s = Slot{};
  s.triangle = &triangle;
  s.entry = entry;
}

void RasterFetch::add(Slot& slot, Addr first, std::uint32_t bytes) {
  for (const Addr line : {line_of(first), line_of(first + bytes - 1)}) {
    const auto end = slot.lines.begin() + slot.count;
    if (std::find(slot.lines.begin(), end, line) == end) slot.lines[slot.count++] = line;
  }
}

void RasterFetch::list_lines(Stage stage, Slot& slot) {
  slot.listed = true;
  slot.count = slot.next = 0;
  if (stage == kList) {
    if (slot.entry != kBatch) add(slot, memory_.entry_at(slot.entry), RasterMemory::kEntryBytes);
  } else if (stage == kIndices) {
    add(slot, memory_.index_at(slot.triangle->number), RasterMemory::kIndexBytes);
  } else {
    list_vertices(slot);
  }
}

void RasterFetch::list_vertices(Slot& slot) {
  for (const std::uint32_t vertex : slot.triangle->vertices) {
    if (slot.entry != kBatch) {
      add(slot, memory_.transformed_at(vertex), RasterMemory::kTransformedBytes);
    } else if (vertex_cache_.use(vertex)) {
      stats_.vertices_reused += 1;
    } else {
      slot.vertices[slot.missed++] = vertex;
      add(slot, memory_.position_at(vertex), RasterMemory::kPositionBytes);
    }
  }
}

bool RasterFetch::advance(Stage stage, std::uint32_t& looked) {
  const std::uint64_t number = done_[stage];
  if (number == entered_ || (stage != kList && done_[stage - 1] <= number)) return false;
  Slot& s = slot(number);
  if (!s.listed) {
    if (s.pending != 0) return false;  // lines of the stage before are on their way
    list_lines(stage, s);
  }
  if (s.next < s.count) {
    const auto slot_number = static_cast<std::uint32_t>(number % slots_.size());
    switch (l1_.access(s.lines[s.next], slot_number)) {
      case L1Cache::Result::kFull:
        return false;
      case L1Cache::Result::kMiss:
        s.pending += 1;
        stats_.l1_misses += 1;
        break;
      case L1Cache::Result::kHit:
        stats_.l1_hits += 1;
        break;
    }
    stats_.l1_accesses += 1;
    looked += 1;
    s.next += 1;
  }
  if (s.next == s.count) {
    done_[stage] += 1;
    s.listed = false;
  }
  return true;
}

bool RasterFetch::look_up() {
  std::uint32_t looked = 0;
  bool any = false;
  for (bool moved = true; moved && looked < lookups_;) {
    moved = advance(kVertices, looked) || advance(kIndices, looked) || advance(kList, looked);
    any |= moved;
  }
  return any;
}

void RasterFetch::fill(Addr line) {
  stats_.l1_fills += 1;
  for (std::uint64_t waiting = l1_.fill(line).slots; waiting != 0; waiting &= waiting - 1) {
    slots_[static_cast<std::size_t>(std::countr_zero(waiting))].pending -= 1;
  }
}

std::string RasterFetch::state() const {
  return fmt::format("triangles in the window {}, lines on their way {}", entered_ - left_, l1_.outstanding());
}

}  // namespace hw
