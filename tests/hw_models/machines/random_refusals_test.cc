#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "sim/config/config.h"
#include "sim/error.h"
#include "sim/hash.h"
#include "tests/hw_models/machines/random_config.h"

// Checks that random machines with one invalid value are refused with a message of the key and the allowed values.

namespace hw {
namespace {

/// A rule of a struct's check(), and a change that violates it on any valid machine without violating an earlier rule.
struct Break {
  std::string_view key;      ///< key of the error
  std::string_view problem;  ///< text that the error message contains
  void (*apply)(GpuConfig& c);
};

/// Sets a cache to four ways and 64 sets.
void reset(CacheConfig& cache) {
  cache.size.bytes = 16 * 1024;
  cache.line.bytes = 64;
  cache.ways = 4;
  cache.replacement = Replacement::kLru;
}

/// A cache of the machine, and the configuration group that sets it.
struct Cache {
  std::string_view key;
  CacheConfig& (*of)(GpuConfig& c);
};

constexpr Cache kCaches[] = {
    {"tni.trv.l1", [](GpuConfig& c) -> CacheConfig& { return c.tni.trv.l1; }},
    {"tni.ist.l1", [](GpuConfig& c) -> CacheConfig& { return c.tni.ist.l1; }},
    {"srp.data_cache", [](GpuConfig& c) -> CacheConfig& { return c.srp.data_cache; }},
    {"l2",
     [](GpuConfig& c) -> CacheConfig& {
       c.l2.banks = 1;
       return c.l2.cache;
     }},
};

/// A rule of CacheConfig, and a change that violates it after reset().
struct CacheBreak {
  std::string_view key;  ///< key of the error within the cache's group
  std::string_view problem;
  void (*apply)(CacheConfig& cache);
};

constexpr CacheBreak kCacheBreaks[] = {
    {"size", "cannot be divided into sets of 3 ways of 64 bytes", [](CacheConfig& cache) { cache.ways = 3; }},
    {"size", "make 48 sets; the number of sets must be a power of two",
     [](CacheConfig& cache) { cache.size.bytes = 12 * 1024; }},
    {"replacement", "3 ways are no power of two; allowed: lru, random",
     [](CacheConfig& cache) {
       cache.size.bytes = 12 * 1024;
       cache.ways = 3;
       cache.replacement = Replacement::kPlru;
     }},
    {"line", "must be 64 B", [](CacheConfig& cache) { cache.line.bytes = 128; }},
};

constexpr Break kBreaks[] = {
    {"tni.trv.stack_entries", "must be at least 1; 0 is allowed with stack: restart_trail or parent only",
     [](GpuConfig& c) {
       c.tni.trv.stack = StackScheme::kRestartLink;
       c.tni.trv.stack_entries = 0;
     }},
    {"tni.trv.stack_entries", "must be at least 1; 0 is allowed with stack: restart_trail or parent only",
     [](GpuConfig& c) {
       c.tni.trv.stack = StackScheme::kFull;
       c.tni.trv.stack_entries = 0;
     }},
    {"tni.trv.box_latency", "together must not exceed 63 cycles",
     [](GpuConfig& c) { c.tni.trv.l1.hit_cycles = 64 - c.tni.trv.box_latency; }},
    {"tni.ist.latency", "together must not exceed 63 cycles",
     [](GpuConfig& c) { c.tni.ist.l1.hit_cycles = 64 - c.tni.ist.latency; }},
    {"tni.ist.latency", "the stages must rise",
     [](GpuConfig& c) {
       c.tni.ist.l1.hit_cycles = 1;
       c.tni.ist.barycentric_stage = 2;
       c.tni.ist.distance_stage = 3;
     }},
    {"tni.ist.latency", "the stages must rise",
     [](GpuConfig& c) {
       c.tni.ist.l1.hit_cycles = 1;
       c.tni.ist.latency = c.tni.ist.barycentric_stage = c.tni.ist.distance_stage = 20;
       c.tni.ist.latency -= 1;
     }},
    {"dram.line", "must be 64 B", [](GpuConfig& c) { c.dram.line.bytes = 128; }},
    {"l2.mshrs", "9 miss registers cannot be divided over 2 banks",
     [](GpuConfig& c) {
       reset(c.l2.cache);
       c.l2.banks = 2;
       c.l2.cache.mshrs = 9;
     }},
    {"l2.banks", "more banks (64) than sets (32)",
     [](GpuConfig& c) {
       reset(c.l2.cache);
       c.l2.cache.ways = 8;
       c.l2.cache.mshrs = c.l2.banks = 64;
     }},
    {"direct_interface.ray_bytes", "8-byte pieces; 44 is no multiple",
     [](GpuConfig& c) { c.direct_interface.ray_bytes = 44; }},
    {"direct_interface.hit_bytes", "8-byte pieces; 20 is no multiple",
     [](GpuConfig& c) { c.direct_interface.hit_bytes = 20; }},
    {"srp.array.mul_units", "functional units cannot have a multiplier",
     [](GpuConfig& c) { c.srp.array.mul_units = c.srp.array.unit_count() + 1; }},
    {"srp.array.div_sqrt_units", "functional units cannot have a divider",
     [](GpuConfig& c) { c.srp.array.div_sqrt_units = c.srp.array.unit_count() + 1; }},
    {"srp.latency.load_queue", "make more than 64 cycles",
     [](GpuConfig& c) { c.srp.latency.cached_load = c.srp.latency.load_queue = 33; }},
    {"dram.controller.write_low", "must be less than write_high",
     [](GpuConfig& c) { c.dram.controller.write_low = c.dram.controller.write_high; }},
    {"dram.controller.write_high", "must not be more than write_queue holds",
     [](GpuConfig& c) {
       c.dram.controller.write_queue = c.dram.controller.write_low + 1;
       c.dram.controller.write_high = c.dram.controller.write_low + 2;
     }},
    {"dram.line", "must be whole bursts (128 bytes)", [](GpuConfig& c) { c.dram.organisation.burst.bytes = 128; }},
    {"dram.line", "of one row (64 bytes)",
     [](GpuConfig& c) {
       c.dram.line.bytes = 128;
       c.dram.organisation.page.bytes = 64;
     }},
    {"dram.line", "has too many bursts: their commands must fit 64 nCK",
     [](GpuConfig& c) {
       c.dram.organisation.burst.bytes = 8;
       c.dram.timing.ccd_l = 32;
     }},
    {"dram.organisation.bank_groups", "must not be more than banks (4)",
     [](GpuConfig& c) {
       c.dram.organisation.banks = 4;
       c.dram.organisation.bank_groups = 8;
     }},
    {"dram.organisation.refresh_banks", "must not be more than banks (1)",
     [](GpuConfig& c) {
       c.dram.organisation.banks = c.dram.organisation.bank_groups = 1;
       c.dram.organisation.refresh_banks = 2;
     }},
    {"dram.organisation.banks", "at most 32, all ranks together",
     [](GpuConfig& c) {
       c.dram.organisation.ranks = 2;
       c.dram.organisation.banks = 32;
     }},
    {"dram.timing.wl", "must not be more than rl", [](GpuConfig& c) { c.dram.timing.wl = c.dram.timing.rl + 1; }},
    {"dram.timing.ccd_s", "burst <= ccd_s <= ccd_l",
     [](GpuConfig& c) { c.dram.timing.burst = c.dram.timing.ccd_s + 1; }},
    {"dram.timing.ccd_s", "burst <= ccd_s <= ccd_l",
     [](GpuConfig& c) { c.dram.timing.ccd_s = c.dram.timing.ccd_l + 1; }},
    {"dram.timing.ca_column", "must not be more than the distance of a line's commands",
     [](GpuConfig& c) {
       c.dram.organisation.burst.bytes = c.dram.line.bytes / 2;
       c.dram.organisation.bl32 = false;
       c.dram.timing.burst = c.dram.timing.ccd_s = c.dram.timing.ccd_l = 4;
       c.dram.timing.ca_column = 5;
     }},
    {"dram.timing", "leaves a bank no time between its refreshes: rfc_pb",
     [](GpuConfig& c) {
       c.dram.controller.refresh = RefreshKind::kPerBank;
       c.dram.timing.refi_pb = c.dram.organisation.refresh_banks * c.dram.timing.rfc_pb / c.dram.organisation.banks;
     }},
    {"dram.timing", "leaves a bank no time between its refreshes: rfc_ab",
     [](GpuConfig& c) {
       c.dram.controller.refresh = RefreshKind::kAllBank;
       c.dram.timing.refi_ab = c.dram.timing.rfc_ab;
     }},
};

void expect_refused(const std::string& message, std::string_view key, std::string_view problem) {
  EXPECT_NE(message.find(fmt::format("{}: ", key)), std::string::npos) << message << "\nshould name " << key;
  EXPECT_NE(message.find(problem), std::string::npos) << message << "\nshould say " << problem;
  EXPECT_EQ(message.find('\n'), std::string::npos) << message;
}

/// Returns the error message about a machine; empty if it is valid.
std::string complaint_of(const GpuConfig& config) {
  try {
    sim::check_config(config);
  } catch (const sim::InputError& error) {
    return error.what();
  }
  return {};
}

std::string complaint_of(GpuConfig& config, const std::string& set) {
  try {
    sim::apply_sets(config, std::array{set});
  } catch (const sim::InputError& error) {
    return error.what();
  }
  return {};
}

TEST(RandomRefusals, EveryRuleBetweenKeysRefusesTwoHundredMachinesThatBreakIt) {
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    const GpuConfig valid = test::random_config(seed);
    ASSERT_EQ(complaint_of(valid), "") << seed;
    for (const Break& broken : kBreaks) {
      GpuConfig config = valid;
      broken.apply(config);
      SCOPED_TRACE(seed);
      expect_refused(complaint_of(config), broken.key, broken.problem);
    }
    for (const Cache& cache : kCaches) {
      for (const CacheBreak& broken : kCacheBreaks) {
        GpuConfig config = valid;
        CacheConfig& changed = cache.of(config);
        reset(changed);
        broken.apply(changed);
        SCOPED_TRACE(seed);
        expect_refused(complaint_of(config), fmt::format("{}.{}", cache.key, broken.key), broken.problem);
      }
    }
  }
}

void collect(const sim::ConfigNode& node, std::vector<const sim::ConfigNode*>& fields) {
  if (!node.is_group()) fields.push_back(&node);
  for (const sim::ConfigNode& child : node.children) collect(child, fields);
}

TEST(RandomRefusals, AnInvalidValueOfEveryFieldIsRefusedWithTheAllowedOnes) {
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    GpuConfig config = test::random_config(seed);
    const sim::ConfigNode root = sim::config_tree(config);
    std::vector<const sim::ConfigNode*> fields;
    collect(root, fields);
    for (std::size_t i = seed % 7; i < fields.size(); i += 7) {
      const sim::ConfigNode& field = *fields[i];
      if (field.kind() == sim::FieldKind::kString) continue;
      for (const char* value : {"-1", "1.5.2", "nonsense", "[]"}) {
        GpuConfig other = config;
        SCOPED_TRACE(fmt::format("{}={}", field.path, value));
        expect_refused(complaint_of(other, fmt::format("{}={}", field.path, value)), field.path, "llowed: ");
      }
    }
  }
}

TEST(RandomRefusals, ANumberBeyondItsLimitsIsRefusedWithTheLimits) {
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    GpuConfig config = test::random_config(seed);
    const sim::ConfigNode root = sim::config_tree(config);
    std::vector<const sim::ConfigNode*> fields;
    collect(root, fields);
    for (std::size_t i = seed % 7; i < fields.size(); i += 7) {
      auto* const* member = std::get_if<std::uint32_t*>(&*fields[i]->target);
      if (member == nullptr) continue;
      const sim::Limits& limits = fields[i]->limits;
      const std::uint32_t before = **member;
      for (const double wrong : {limits.min - 1, limits.max + 1, limits.power_of_two ? 3.0 : -1.0}) {
        if (wrong < 0) continue;
        **member = static_cast<std::uint32_t>(wrong);
        SCOPED_TRACE(seed);
        expect_refused(complaint_of(config), fields[i]->path, fmt::format("'{}' is out of range; allowed: ", wrong));
      }
      **member = before;
    }
  }
}

TEST(RandomRefusals, AMisspeltKeyIsRefusedWithAKeyOfItsGroup) {
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    GpuConfig config = test::random_config(seed);
    const std::vector<sim::FieldInfo> fields = sim::list_fields(config);
    const sim::FieldInfo& field = fields[sim::hash(seed) % fields.size()];
    const std::string message = complaint_of(config, field.path + "q=1");
    EXPECT_NE(message.find("unknown key '"), std::string::npos) << message;
    const std::string group = field.path.substr(0, field.path.rfind('.') + 1);
    EXPECT_NE(message.find("did you mean '" + group), std::string::npos) << message;
  }
}

}  // namespace
}  // namespace hw
