#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "hw_models/memory/cache_tags.h"
#include "hw_models/memory/l2_config.h"
#include "hw_models/memory/messages.h"

namespace hw {

/// The lines of one L2 bank: which pieces of each are here, and which of these are newer than memory (dirty).
/// A written line is put in without being fetched, so it may be here in part; a dirty piece is always here.
class L2Store {
 public:
  enum class Found : std::uint8_t { kNot, kPart, kAll };
  /// What must go to memory because its place was taken; no pieces if nothing must.
  struct Victim {
    Addr line = 0;
    SectorMask pieces = 0;
  };

  explicit L2Store(const L2Config& config)
      : tags_(config.cache, config.banks), here_(tags_.places(), kWholeLine), dirty_(tags_.places(), 0) {}

  /// Are these pieces of the line here?
  Found find(Addr line, SectorMask wanted) {
    const std::size_t place = tags_.look_up(line);
    if (place == CacheTags::kNowhere) return Found::kNot;
    return (wanted & ~here_[place]) == 0 ? Found::kAll : Found::kPart;
  }

  /// Takes a line that is here out, and returns its dirty pieces.
  SectorMask take_out(Addr line) {
    const std::size_t place = tags_.look_up(line);
    tags_.remove(place);
    return clean(place);
  }

  /// Writes pieces of a line that is here, and makes them dirty; returns those that were dirty before.
  SectorMask write(Addr line, SectorMask pieces) {
    const std::size_t place = tags_.look_up(line);
    const SectorMask before = dirty_[place] & pieces;
    here_[place] |= pieces;
    make_dirty(place, pieces);
    return before;
  }

  /// Puts a line in that is not here: these pieces of it, some of them dirty.
  Victim put_in(Addr line, SectorMask pieces, SectorMask dirty) {
    const CacheTags::Filled filled = tags_.fill(line);
    const Victim victim{filled.evicted, clean(filled.place)};
    here_[filled.place] = pieces;
    make_dirty(filled.place, dirty);
    return victim;
  }

  /// Lines of which something is dirty.
  std::size_t dirty_lines() const { return dirty_lines_; }
  /// Cleans a dirty line, the next in the order of places; only if there is one.
  Victim clean_next() {
    while (dirty_[next_] == 0) next_ = next_ + 1 == dirty_.size() ? 0 : next_ + 1;
    return {tags_.line_at(next_), clean(next_)};
  }

 private:
  void make_dirty(std::size_t place, SectorMask pieces) {
    dirty_lines_ += dirty_[place] == 0 && pieces != 0;
    dirty_[place] |= pieces;
  }
  SectorMask clean(std::size_t place) {
    const SectorMask pieces = dirty_[place];
    dirty_lines_ -= pieces != 0;
    dirty_[place] = 0;
    return pieces;
  }

  CacheTags tags_;
  std::vector<SectorMask> here_, dirty_;  ///< by place
  std::size_t dirty_lines_ = 0;
  std::size_t next_ = 0;  ///< for clean_next()
};

}  // namespace hw
