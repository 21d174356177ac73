#include "hw_models/memory/cache.h"

#include <list>
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

}  // namespace
}  // namespace hw
