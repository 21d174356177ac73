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
#include "sim/hash.h"

namespace hw {

/// The tags of a set-associative cache (or of one of its banks).
///
///   line --> [ set: `ways` tags, `ways` times of last use or a tree of bits ] --> place of the line, or miss
///
/// Lines interleave over `banks` first; a bank holds its share of the sets. A place names a line of the array from its
/// fill until another fill takes the place.
class CacheTags {
 public:
  static constexpr std::size_t kNowhere = std::numeric_limits<std::size_t>::max();
  /// Where a line was put, and what had to go for it.
  struct Filled {
    std::size_t place = 0;
    bool evicts = false;
    Addr evicted = 0;
  };

  explicit CacheTags(const CacheConfig& config, std::uint32_t banks = 1)
      : line_shift_(static_cast<std::uint32_t>(std::countr_zero(config.line.bytes))),
        bank_shift_(static_cast<std::uint32_t>(std::countr_zero(banks))),
        ways_(config.ways),
        replacement_(config.replacement),
        set_mask_(config.sets() / banks - 1),
        tags_(config.sets() / banks * config.ways, kInvalid),
        used_(tags_.size(), 0),
        trees_(replacement_ == Replacement::kPlru ? config.sets() / banks : 0, 0) {
    assert(std::has_single_bit(banks) && config.sets() >= banks);
  }

  std::size_t places() const { return tags_.size(); }

  /// Is the line here? If so it counts as used now.
  bool probe(Addr line) { return look_up(line) != kNowhere; }

  /// The same, and says where; kNowhere if it is not here.
  std::size_t look_up(Addr line) {
    const std::size_t base = base_of(line);
    const std::uint32_t way = find(base, tag_of(line));
    if (way == ways_) return kNowhere;
    use(base, way);
    return base + way;
  }

  /// Is the line here? Its use is not noted.
  bool holds(Addr line) const { return find(base_of(line), tag_of(line)) != ways_; }

  /// Puts the line in place of an empty way or of the one whose turn it is to go.
  Filled fill(Addr line) {
    const std::size_t base = base_of(line);
    const std::uint32_t found = find(base, tag_of(line));
    const std::uint32_t way = found != ways_ ? found : victim(base, tag_of(line));
    const std::uint32_t before = tags_[base + way];
    fills_ += 1;
    tags_[base + way] = tag_of(line);
    use(base, way);
    return {base + way, before != kInvalid && found == ways_, Addr{before} << line_shift_};
  }

  /// Empties the place.
  void remove(std::size_t place) {
    tags_[place] = kInvalid;
    used_[place] = 0;
  }
  /// The line at a place that is not empty.
  Addr line_at(std::size_t place) const { return Addr{tags_[place]} << line_shift_; }

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

  void use(std::size_t base, std::uint32_t way) {
    used_[base + way] = ++clock_;
    if (replacement_ == Replacement::kPlru) point_away(trees_[base / ways_], way);
  }
  /// An empty way, the first of several, or the one to replace.
  std::uint32_t victim(std::size_t base, std::uint32_t tag) const {
    const auto first = used_.begin() + static_cast<std::ptrdiff_t>(base);
    const auto least = static_cast<std::uint32_t>(std::min_element(first, first + ways_) - first);
    if (replacement_ == Replacement::kLru || tags_[base + least] == kInvalid) return least;
    if (replacement_ == Replacement::kRandom) return static_cast<std::uint32_t>(sim::hash(tag, fills_) % ways_);
    return pointed_at(trees_[base / ways_]);
  }

  // The tree: bit n says in which half below node n the next victim is; node 1 is the root, 2n and 2n + 1 the halves.
  void point_away(std::uint64_t& tree, std::uint32_t way) const {
    for (std::uint32_t node = way + ways_; node > 1; node /= 2) {
      const std::uint64_t bit = std::uint64_t{1} << (node / 2);
      tree = node % 2 == 0 ? tree | bit : tree & ~bit;
    }
  }
  std::uint32_t pointed_at(std::uint64_t tree) const {
    std::uint32_t node = 1;
    while (node < ways_) node = 2 * node + static_cast<std::uint32_t>((tree >> node) & 1U);
    return node - ways_;
  }

  std::uint32_t line_shift_;
  std::uint32_t bank_shift_;
  std::uint32_t ways_;
  Replacement replacement_;
  Addr set_mask_;
  std::vector<std::uint32_t> tags_;
  std::vector<std::uint64_t> used_;
  std::vector<std::uint64_t> trees_;  ///< of each set
  std::uint64_t clock_ = 0, fills_ = 0;
};

}  // namespace hw
