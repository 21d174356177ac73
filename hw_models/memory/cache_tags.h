#pragma once
#include <algorithm>
#include <bit>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "hw_models/memory/cache_config.h"
#include "hw_models/memory/messages.h"

namespace hw {

/// The tags of a set-associative cache (or of one of its banks) with least recently used replacement.
///
///   line --> [ set: `ways` tags, `ways` times of last use ] --> hit or miss
///
/// Lines interleave over `banks` first; a bank holds its share of the sets.
class CacheTags {
 public:
  explicit CacheTags(const CacheConfig& config, std::uint32_t banks = 1)
      : line_shift_(static_cast<std::uint32_t>(std::countr_zero(config.line.bytes))),
        bank_shift_(static_cast<std::uint32_t>(std::countr_zero(banks))),
        ways_(config.ways),
        set_mask_(config.sets() / banks - 1),
        tags_(config.sets() / banks * config.ways, kInvalid),
        used_(tags_.size(), 0) {
    assert(std::has_single_bit(banks) && config.sets() >= banks);
  }

  /// Is the line here? If so it is now the most recently used of its set.
  bool probe(Addr line) {
    const std::size_t base = base_of(line);
    const std::uint32_t way = find(base, tag_of(line));
    if (way == ways_) return false;
    used_[base + way] = ++clock_;
    return true;
  }

  /// Is the line here? Its use is not noted.
  bool holds(Addr line) const { return find(base_of(line), tag_of(line)) != ways_; }

  /// Puts the line in place of an empty way or of the least recently used one.
  void fill(Addr line) {
    const std::size_t base = base_of(line);
    std::size_t way = find(base, tag_of(line));
    if (way == ways_) {
      const auto first = used_.begin() + static_cast<std::ptrdiff_t>(base);
      way = static_cast<std::size_t>(std::min_element(first, first + ways_) - first);
    }
    tags_[base + way] = tag_of(line);
    used_[base + way] = ++clock_;
  }

  /// Forgets every line.
  void invalidate() {
    std::ranges::fill(tags_, kInvalid);
    std::ranges::fill(used_, 0);
  }

 private:
  static constexpr std::uint32_t kInvalid = std::numeric_limits<std::uint32_t>::max();

  /// The number of the line, which names it whatever its set: addresses end far below 2^32 lines.
  std::uint32_t tag_of(Addr line) const { return static_cast<std::uint32_t>(line >> line_shift_); }
  std::size_t base_of(Addr line) const {
    return static_cast<std::size_t>((line >> (line_shift_ + bank_shift_)) & set_mask_) * ways_;
  }
  /// The way that holds `tag`, or `ways_`. No early exit, so that all ways are compared at once.
  std::uint32_t find(std::size_t base, std::uint32_t tag) const {
    const std::uint32_t* tags = &tags_[base];
    std::uint32_t found = ways_;
    for (std::uint32_t way = 0; way < ways_; ++way) found = tags[way] == tag ? way : found;
    return found;
  }

  std::uint32_t line_shift_;
  std::uint32_t bank_shift_;
  std::uint32_t ways_;
  Addr set_mask_;
  std::vector<std::uint32_t> tags_;
  std::vector<std::uint64_t> used_;
  std::uint64_t clock_ = 0;
};

}  // namespace hw
