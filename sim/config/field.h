#pragma once
#include <array>
#include <cstdint>
#include <limits>
#include <string_view>

#include "sim/named.h"
#include "sim/time.h"

namespace sim {

/// Part of the results that a configuration field changes.
enum class Affects : std::uint8_t {
  kFunction,  ///< the recorded work itself: scene, program, thresholds, tile size, BVH build
  kLayout,    ///< addresses: node, triangle and texture formats, placement
  kWalk,      ///< how the canonical walk is expanded: stack scheme and depth, boxes per visit
  kTiming,    ///< all else in the machine: clocks, queues, caches, arrays, memory
  kEnergy,    ///< energy and power only, computed at report time
  kReport,    ///< says what is written, and where
};
constexpr std::array<std::string_view, 6> names_of(Affects) {
  return {"function", "layout", "walk", "timing", "energy", "report"};
}

/// Quantities that carry their unit in the configuration file ("500 MHz", "16 KiB", "50 ns", "12 pJ").
struct Frequency {
  std::uint64_t hz = 0;
  /// The clock domain of this frequency, its period rounded to the nearest femtosecond.
  Clock clock() const { return Clock((kFemtosecondsPerSecond + hz / 2) / hz); }
  friend bool operator==(const Frequency&, const Frequency&) = default;
};
struct ByteSize {
  std::uint64_t bytes = 0;
  friend bool operator==(const ByteSize&, const ByteSize&) = default;
};
struct Duration {
  Time time = 0;
  friend bool operator==(const Duration&, const Duration&) = default;
};
/// A figure known only within a band; its unit ("pJ", "mW") is the field's.
struct Spread {
  double low = 0, nominal = 0, high = 0;
  friend bool operator==(const Spread&, const Spread&) = default;
};

/// A count, or "auto": one that follows from the rest of the configuration, and is worked out once that is read.
struct AutoCount {
  std::uint32_t value = 0;
  bool is_auto = false;
  AutoCount(std::uint32_t count = 0) : value(count) {}  // NOLINT(google-explicit-constructor): a count
  operator std::uint32_t() const { return value; }      // NOLINT(google-explicit-constructor): a count
};

/// Three numbers in one field, "x y z": a point, a direction or a colour.
struct Triple {
  double x = 0, y = 0, z = 0;
  friend bool operator==(const Triple&, const Triple&) = default;
};

/// Values that a number may take. `power_of_two` and the bounds are checked together, bounds inclusive, in the
/// field's own unit (bytes, hertz, femtoseconds for the quantities above).
struct Limits {
  double min = 0;
  double max = std::numeric_limits<double>::infinity();
  bool power_of_two = false;
};
constexpr Limits any() {
  return {-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity(), false};
}
constexpr Limits at_least(double min) { return {min, std::numeric_limits<double>::infinity(), false}; }
constexpr Limits between(double min, double max) { return {min, max, false}; }
constexpr Limits power_of_two(double min, double max) { return {min, max, true}; }

// A configuration struct declares its fields once; parsing, checks, "did you mean", the effective dump, the JSON
// Schema and the manual all come from that declaration:
//
//   struct TrvConfig {
//     std::uint32_t rays = 32;
//     CacheConfig l1;
//     static void describe(auto& c, auto&& field) {
//       field(NAMED(c.rays), "rays", "rays held at once (input buffer)", between(1, 64), Affects::kTiming);
//       field.group(NAMED(c.l1), "private node cache");
//     }
//   };
//
// Members may be bool, std::uint32_t, std::uint64_t, double, std::string, an enum with names (below), Frequency,
// ByteSize, Duration, AutoCount, Triple, Spread, std::map<std::string, Spread> and groups. A struct may add
// `void check(auto&& complain) const` for rules that join several fields: complain("key", "what is wrong, what is
// allowed"). An enum `E` names its values with a function found by argument: `constexpr auto names_of(E) ->
// std::array<std::string_view, n>`.

}  // namespace sim
