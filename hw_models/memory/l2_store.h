#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "hw_models/memory/cache_tags.h"
#include "hw_models/memory/l2_config.h"
#include "hw_models/memory/messages.h"

namespace hw {

/// The lines of one L2 bank: which sectors of each are here, and which of these are newer than memory (dirty).
/// A written line is put in without being fetched, so it may be here in part; a dirty sector is always here.
class L2Store {
 public:
  enum class Found : std::uint8_t { kNot, kPart, kAll };
  /// Dirty sectors that must go to memory because their slot was taken; none if nothing must.
  struct Victim {
    Addr line = 0;
    SectorMask sectors = 0;
  };

  explicit L2Store(const L2Config& config)
      : tags_(config.cache, config.banks), here_(tags_.slots(), kWholeLine), dirty_(tags_.slots(), 0) {}

  /// Are these sectors of the line here?
  Found find(Addr line, SectorMask wanted) {
    const std::size_t slot = tags_.look_up(line);
    if (slot == CacheTags::kNoSlot) return Found::kNot;
    return (wanted & ~here_[slot]) == 0 ? Found::kAll : Found::kPart;
  }

  /// Takes a line that is here out, and returns its dirty sectors.
  SectorMask take_out(Addr line) {
    const std::size_t slot = tags_.look_up(line);
    tags_.remove(slot);
    return clean(slot);
  }

  /// Writes sectors of a line that is here, and makes them dirty; returns those that were dirty before.
  SectorMask write(Addr line, SectorMask sectors) {
    const std::size_t slot = tags_.look_up(line);
    const SectorMask before = dirty_[slot] & sectors;
    here_[slot] |= sectors;
    make_dirty(slot, sectors);
    return before;
  }

  /// Puts a line in that is not here: these sectors of it, some of them dirty.
  Victim put_in(Addr line, SectorMask sectors, SectorMask dirty) {
    const CacheTags::Filled filled = tags_.fill(line);
    const Victim victim{filled.evicted, clean(filled.slot)};
    here_[filled.slot] = sectors;
    make_dirty(filled.slot, dirty);
    return victim;
  }

  /// Lines of which something is dirty.
  std::size_t dirty_lines() const { return dirty_lines_; }
  /// Cleans a dirty line, the next in the order of slots; only if there is one.
  Victim clean_next() {
    while (dirty_[next_] == 0) next_ = next_ + 1 == dirty_.size() ? 0 : next_ + 1;
    return {tags_.line_at(next_), clean(next_)};
  }

 private:
  void make_dirty(std::size_t slot, SectorMask sectors) {
    dirty_lines_ += dirty_[slot] == 0 && sectors != 0;
    dirty_[slot] |= sectors;
  }
  SectorMask clean(std::size_t slot) {
    const SectorMask sectors = dirty_[slot];
    dirty_lines_ -= sectors != 0;
    dirty_[slot] = 0;
    return sectors;
  }

  CacheTags tags_;
  std::vector<SectorMask> here_, dirty_;  ///< by slot
  std::size_t dirty_lines_ = 0;
  std::size_t next_ = 0;  ///< for clean_next()
};

}  // namespace hw
