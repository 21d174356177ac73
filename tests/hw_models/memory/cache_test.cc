#include "hw_models/memory/cache.h"

#include <array>
#include <list>
#include <set>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "hw_models/memory/l2_bank.h"
#include "sim/hash.h"

namespace hw {
namespace {

std::vector<std::pair<std::string, std::string>> complaints(const auto& config) {
  std::vector<std::pair<std::string, std::string>> all;
  config.check([&](const std::string& key, const std::string& what) { all.emplace_back(key, what); });
  return all;
}

CacheConfig shape(std::uint64_t size, std::uint64_t line, std::uint32_t ways) {
  CacheConfig c;
  c.size = {size};
  c.line = {line};
  c.ways = ways;
  return c;
}

TEST(CacheTags, ALineIsAbsentUntilFilledAndThenPresent) {
  CacheTags tags(shape(4096, 64, 4));
  EXPECT_FALSE(tags.probe(640));
  tags.fill_line(640);
  EXPECT_TRUE(tags.probe(640));
  EXPECT_FALSE(tags.probe(704));
}

TEST(CacheTags, EvictTheLeastRecentlyUsedLineOfTheSet) {
  const CacheConfig c = shape(4 * 64 * 16, 64, 4);
  CacheTags tags(c);
  const Addr stride = 64 * c.set_count();
  for (Addr i = 0; i < 4; ++i) tags.fill_line(i * stride);
  EXPECT_TRUE(tags.probe(0));
  tags.fill_line(4 * stride);
  EXPECT_TRUE(tags.probe(0)) << "used since";
  EXPECT_FALSE(tags.probe(stride)) << "the oldest";
  EXPECT_TRUE(tags.probe(2 * stride));
}

TEST(CacheTags, EqualsAReferenceWithListsOnRandomTraffic) {
  for (const std::uint32_t ways : {1U, 2U, 3U, 8U}) {
    const CacheConfig c = shape(std::uint64_t{16} * ways * 64, 64, ways);
    CacheTags tags(c);
    std::unordered_map<Addr, std::list<Addr>> sets;
    for (std::uint64_t i = 0; i < 20000; ++i) {
      const Addr line = sim::hash(i, ways) % 200 * 64;
      std::list<Addr>& set = sets[line / 64 % 16];
      const bool expected = std::ranges::find(set, line) != set.end();
      ASSERT_EQ(tags.probe(line), expected);
      if (!expected) tags.fill_line(line);
      set.remove(line);
      set.push_front(line);
      if (set.size() > ways) set.pop_back();
    }
  }
}

TEST(CacheTags, ABankHoldsItsShareOfTheLines) {
  const CacheConfig c = shape(64 * 64, 64, 2);
  CacheTags bank(c, 4);
  for (Addr i = 0; i < 16; ++i) bank.fill_line(i * 4 * 64);
  for (Addr i = 0; i < 16; ++i) EXPECT_TRUE(bank.probe(i * 4 * 64));
}

TEST(CacheConfig, TheDefaultsAreSound) {
  EXPECT_TRUE(complaints(CacheConfig{}).empty());
  EXPECT_TRUE(complaints(L2Config{}).empty());
  EXPECT_TRUE(complaints(shape(12 * 1024, 64, 3)).empty()) << "three ways are fine, the sets are a power of two";
}

TEST(CacheConfig, ImpossibleShapesAreRefused) {
  const auto odd_line = complaints(shape(300, 100, 3));
  ASSERT_EQ(odd_line.size(), 1U);
  EXPECT_EQ(odd_line[0].first, "line");
  EXPECT_NE(odd_line[0].second.find("100"), std::string::npos);

  const auto rest = complaints(shape(1000, 64, 4));
  ASSERT_EQ(rest.size(), 1U);
  EXPECT_EQ(rest[0], std::make_pair(std::string("size"),
                                    std::string("1000 bytes cannot be divided into sets of 4 ways of 64 bytes")));

  const auto sets = complaints(shape(3 * 256, 64, 4));
  ASSERT_EQ(sets.size(), 1U);
  EXPECT_NE(sets[0].second.find("3 sets"), std::string::npos);
}

TEST(CacheConfig, AnL2WhoseBanksDoNotDivideItIsRefused) {
  L2Config c;
  c.cache.mshrs = 30;
  ASSERT_EQ(complaints(c).size(), 1U);
  EXPECT_EQ(complaints(c)[0].first, "mshrs");
  c = L2Config{};
  c.cache.size = {2048};
  c.banks = 8;
  ASSERT_EQ(complaints(c).size(), 1U);
  EXPECT_EQ(complaints(c)[0].first, "banks");
}

TEST(MshrFile, FindsAllocatesAndReleasesByLine) {
  MshrFile<std::uint64_t> file(2);
  EXPECT_EQ(file.find_payload(64), nullptr);
  file.allocate(64) = 1;
  file.allocate(128) = 2;
  EXPECT_TRUE(file.is_full());
  *file.find_payload(64) |= 8;
  EXPECT_EQ(file.release(64), 9U);
  EXPECT_FALSE(file.is_full());
  EXPECT_EQ(*file.find_payload(128), 2U);
  file.allocate(64) = 4;
  EXPECT_EQ(*file.find_payload(64), 4U);
  EXPECT_EQ(file.release(128), 2U);
  EXPECT_EQ(file.size(), 1U);
}

TEST(MshrFile, HoldsItsCapacityForAnyVectorWidthOfTheHost) {
  for (const std::uint32_t capacity : {1U, 7U, 8U, 9U, 20U}) {
    MshrFile<std::uint64_t> file(capacity);
    for (std::uint64_t round = 0; round < 50; ++round) {
      const auto line = [&](std::uint64_t i) { return 64 * (round * capacity + i); };
      for (std::uint64_t i = 0; i < capacity; ++i) file.allocate(line(i)) = i;
      ASSERT_TRUE(file.is_full());
      for (std::uint64_t left = capacity; left > 0; --left) {
        const std::uint64_t i = (round + left * 7) % capacity;
        // Releases the first outstanding miss from number i on, with wrap-around.
        for (std::uint64_t k = 0; k < capacity; ++k) {
          const std::uint64_t next = (i + k) % capacity;
          if (file.find_payload(line(next)) == nullptr) continue;
          ASSERT_EQ(*file.find_payload(line(next)), next);
          ASSERT_EQ(file.release(line(next)), next);
          ASSERT_EQ(file.find_payload(line(next)), nullptr);
          break;
        }
        ASSERT_EQ(file.size(), left - 1);
      }
    }
  }
}

TEST(CacheTags, KeepTheirOrderWhenTheirClockRestarts) {
  const CacheConfig config;
  CacheTags fresh(config), late(config, 1, 0xffffffffU - 100);
  for (std::uint64_t n = 0; n < 3000; ++n) {
    const Addr line = sim::mix_bits(n) % 700 * 64;
    const bool here = fresh.probe(line);
    ASSERT_EQ(late.probe(line), here) << "probe " << n;
    if (here) continue;
    const CacheTags::FilledLine a = fresh.fill_line(line), b = late.fill_line(line);
    ASSERT_EQ(a.slot, b.slot);
    ASSERT_EQ(a.evicted, b.evicted);
  }
}

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
