#pragma once
#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>

#include "sim/config/config.h"
#include "sim/named.h"

namespace sim::test {

enum class Stack : std::uint8_t { kFull, kShort, kRestart };
constexpr std::array<std::string_view, 3> names_of(Stack) { return {"full", "short", "restart"}; }

enum class Mode : std::uint8_t { kOff, kOn, kAlternate };
constexpr std::array<std::string_view, 3> names_of(Mode) { return {"off", "on", "alternate"}; }

struct CacheConfig {
  ByteSize size{16 * 1024};
  ByteSize line{64};
  std::uint32_t ways = 4;
  static void describe(auto& c, auto&& field) {
    field(NAMED(c.size), "bytes", "data held", between(64, 1 << 20), Affects::kTiming);
    field(NAMED(c.line), "bytes", "data of one line", power_of_two(16, 256), Affects::kTiming);
    field(NAMED(c.ways), "ways", "lines of a set", at_least(1), Affects::kTiming);
  }
  void check(auto&& complain) const {
    if (size.bytes % (ways * line.bytes) != 0) complain("size", "is no whole number of sets");
  }
  friend bool operator==(const CacheConfig&, const CacheConfig&) = default;
};

struct UnitConfig {
  std::uint32_t rays = 32;
  Stack stack = Stack::kFull;
  Mode prefetch = Mode::kOff;
  CacheConfig l1;
  static void describe(auto& c, auto&& field) {
    field(NAMED(c.rays), "rays", "rays held at once", between(1, 64), Affects::kTiming);
    field(NAMED(c.stack), "", "where far children wait | full: all of them", any(), Affects::kWalk);
    field(NAMED(c.prefetch), "", "next line on a miss", any(), Affects::kTiming);
    field.group(NAMED(c.l1), "private cache");
  }
  friend bool operator==(const UnitConfig&, const UnitConfig&) = default;
};

/// A configuration for tests with one field of every kind.
struct MachineConfig {
  bool direct = true;
  std::uint64_t seed = 7;
  double threshold = 0.1;
  std::string name = "plain";
  Frequency clock{500'000'000};
  Duration fabric{50'000'000};
  Band refresh{1, 2, 3};
  std::map<std::string, Band> events;
  UnitConfig unit;
  CacheConfig l2;
  static void describe(auto& c, auto&& field) {
    field(NAMED(c.direct), "", "rays go straight to the unit", any(), Affects::kTiming);
    field(NAMED(c.seed), "", "of the hash", any(), Affects::kFunction);
    field(NAMED(c.threshold), "", "similarity", between(-1, 1), Affects::kFunction);
    field(NAMED(c.name), "", "in reports", any(), Affects::kReport);
    field(NAMED(c.clock), "Hz", "of the unit", between(1e6, 1e10), Affects::kTiming);
    field(NAMED(c.fabric), "ns", "to memory", between(0, 1e9), Affects::kTiming);
    field(NAMED(c.refresh), "pJ", "of a bank", at_least(0), Affects::kEnergy);
    field(NAMED(c.events), "pJ", "of one event", at_least(0), Affects::kEnergy);
    field.group(NAMED(c.unit), "traversal unit");
    field.group(NAMED(c.l2), "shared cache");
  }
  friend bool operator==(const MachineConfig&, const MachineConfig&) = default;
};

}  // namespace sim::test
