#include <array>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "hw_models/memory/cache.h"
#include "sim/hash.h"

namespace hw {
namespace {

CacheConfig cache(Replacement replacement, std::uint32_t ways, std::uint32_t sets = 1) {
  CacheConfig c;
  c.size = {std::uint64_t{64} * ways * sets};
  c.ways = ways;
  c.replacement = replacement;
  return c;
}

/// Fills line `n` into a cache with one set, and returns the evicted line.
Addr victim_of(CacheTags& tags, Addr n) {
  const CacheTags::FilledLine filled = tags.fill_line(64 * n);
  EXPECT_TRUE(filled.evicts);
  return filled.evicted / 64;
}

/// Bits of the PLRU tree, by node. A bit is set if the next victim is in the upper half below its node.
struct Tree {
  explicit Tree(std::uint32_t all) : ways(all) {}
  void touch(std::uint32_t way, std::uint32_t low, std::uint32_t size) {
    if (size == 1) return;
    const std::uint32_t half = size / 2;
    const bool upper = way >= low + half;
    (upper ? points_up.erase({low, size}) : points_up.insert({low, size}).second);
    touch(way, upper ? low + half : low, half);
  }
  void touch(std::uint32_t way) { touch(way, 0, ways); }
  std::uint32_t victim() const {
    std::uint32_t low = 0;
    for (std::uint32_t size = ways; size > 1; size /= 2) {
      if (points_up.contains({low, size})) low += size / 2;
    }
    return low;
  }
  std::uint32_t ways;
  std::set<std::pair<std::uint32_t, std::uint32_t>> points_up;
};

TEST(Replacement, OfAllKindsTakesEmptyWaysFirst) {
  for (const Replacement how : {Replacement::kLru, Replacement::kPlru, Replacement::kRandom}) {
    CacheTags tags(cache(how, 8));
    for (Addr n = 0; n < 8; ++n) EXPECT_FALSE(tags.fill_line(64 * n).evicts);
    for (Addr n = 0; n < 8; ++n) EXPECT_TRUE(tags.probe(64 * n));
    tags.clear_slot(tags.look_up(64 * 5));
    EXPECT_FALSE(tags.probe(64 * 5));
    EXPECT_FALSE(tags.fill_line(64 * 9).evicts) << "the way of what was removed";
  }
}

TEST(Replacement, LruByHand) {
  CacheTags tags(cache(Replacement::kLru, 4));
  for (Addr n = 0; n < 4; ++n) tags.fill_line(64 * n);
  tags.probe(0);
  tags.probe(64 * 2);
  EXPECT_EQ(victim_of(tags, 4), 1U);
  EXPECT_EQ(victim_of(tags, 5), 3U);
  EXPECT_EQ(victim_of(tags, 6), 0U);
  EXPECT_EQ(victim_of(tags, 7), 2U);
}

TEST(Replacement, PlruByHand) {
  CacheTags tags(cache(Replacement::kPlru, 4));
  for (Addr n = 0; n < 4; ++n) tags.fill_line(64 * n);
  EXPECT_EQ(victim_of(tags, 4), 0U) << "the last fills were in the upper half, 1 after 0 in the lower";
  EXPECT_EQ(victim_of(tags, 5), 2U) << "way 0 was just filled; of the upper half, 3 came last";
  tags.probe(64 * 1);
  EXPECT_EQ(victim_of(tags, 6), 3U) << "line 3, although line 4 is older than line 5";
  EXPECT_EQ(victim_of(tags, 7), 4U) << "of the lower half, line 1 was used last";
}

TEST(Replacement, PlruOfTwoWaysIsLru) {
  CacheTags plru(cache(Replacement::kPlru, 2, 4)), lru(cache(Replacement::kLru, 2, 4));
  for (std::uint64_t i = 0; i < 5000; ++i) {
    const Addr line = 64 * (sim::hash(i) % 24);
    ASSERT_EQ(plru.probe(line), lru.probe(line));
    plru.fill_line(line);
    lru.fill_line(line);
  }
}

TEST(Replacement, PlruEqualsTheDrawnTree) {
  for (const std::uint32_t ways : {2U, 4U, 8U, 64U}) {
    CacheTags tags(cache(Replacement::kPlru, ways));
    Tree tree(ways);
    std::vector<Addr> lines(ways);
    for (std::uint32_t way = 0; way < ways; ++way) {
      lines[way] = tags.fill_line(64 * way).slot == way ? 64 * way : 1;
      tree.touch(way);
    }
    for (std::uint64_t i = 0; i < 5000; ++i) {
      const Addr line = 64 * (sim::hash(i, ways) % (2 * ways));
      const auto at = std::ranges::find(lines, line);
      ASSERT_EQ(tags.probe(line), at != lines.end()) << ways << " ways, step " << i;
      auto way = static_cast<std::uint32_t>(at - lines.begin());
      if (at == lines.end()) {
        way = tree.victim();
        ASSERT_EQ(tags.fill_line(line).evicted, lines[way]);
        lines[way] = line;
      }
      tree.touch(way);
    }
  }
}

TEST(Replacement, RandomSpreadsOverAllWays) {
  constexpr std::uint32_t kWays = 8, kFills = 8000;
  CacheTags tags(cache(Replacement::kRandom, kWays));
  for (Addr n = 0; n < kWays; ++n) tags.fill_line(64 * n);
  std::array<std::uint32_t, kWays> count{};
  for (Addr n = 0; n < kFills; ++n) count[tags.fill_line(64 * (kWays + n)).slot] += 1;
  for (const std::uint32_t c : count) EXPECT_NEAR(c, kFills / kWays, 150) << "five deviations of a fair draw";
}

TEST(Replacement, RandomDependsOnlyOnFills) {
  CacheTags looked(cache(Replacement::kRandom, 4)), quiet(cache(Replacement::kRandom, 4));
  for (Addr n = 0; n < 200; ++n) {
    for (Addr i = 0; i < n % 3; ++i) looked.probe(64 * i);
    ASSERT_EQ(looked.fill_line(64 * n).slot, quiet.fill_line(64 * n).slot);
  }
}

TEST(Replacement, PlruNeedsAPowerOfTwoOfWays) {
  CacheConfig c = cache(Replacement::kPlru, 3);
  std::vector<std::string> keys;
  const auto complain = [&](const std::string& key, const std::string&) { keys.push_back(key); };
  c.check(complain);
  EXPECT_EQ(keys, std::vector<std::string>{"replacement"});
  keys.clear();
  c.replacement = Replacement::kRandom;
  c.check(complain);
  EXPECT_TRUE(keys.empty());
}

}  // namespace
}  // namespace hw
