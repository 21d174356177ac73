#pragma once
#include <array>
#include <cstdint>
#include <limits>
#include <string_view>

#include "sim/named.h"
#include "sim/time.h"

namespace sim {

/// Part of the results that a configuration field affects.
enum class Affects : std::uint8_t {
  kFunction,  ///< the recorded work of a frame: scene, program, thresholds, tile size, BVH build
  kLayout,    ///< memory addresses: formats of nodes, triangles and textures, placement
  kWalk,      ///< how rays' recorded walks are executed: stack scheme and depth, boxes per visit
  kTiming,    ///< timing of the machine: clocks, queues, caches, arrays, memory
  kEnergy,    ///< energy and power, computed at report time
  kReport,    ///< what output is written, and where
};
constexpr std::array<std::string_view, 6> names_of(Affects) {
  return {"function", "layout", "walk", "timing", "energy", "report"};
}

/// A frequency, written with a unit in configuration files ("500 MHz").
struct Frequency {
  std::uint64_t hz = 0;
  /// Returns the clock domain with this frequency. The clock period is rounded to the nearest femtosecond.
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
/// A value with uncertainty: low, nominal and high, in the unit of the field ("pJ", "mW").
struct Band {
  double low = 0, nominal = 0, high = 0;
  friend bool operator==(const Band&, const Band&) = default;
};

/// A count that is given as a number or as `auto`. An `auto` count is computed from the rest of the configuration after
/// loading.
struct AutoCount {
  std::uint32_t value = 0;
  bool is_auto = false;
  AutoCount(std::uint32_t count = 0) : value(count) {}  // NOLINT(google-explicit-constructor): a count
  operator std::uint32_t() const { return value; }      // NOLINT(google-explicit-constructor): a count
};

/// Three numbers in one configuration field, "x y z": a point, direction or colour.
struct Triple {
  double x = 0, y = 0, z = 0;
  friend bool operator==(const Triple&, const Triple&) = default;
};

/// Allowed values of a numeric configuration field. Bounds are inclusive and in the field's unit (bytes, hertz or
/// femtoseconds for quantities).
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

// A configuration struct declares its fields once. Parsing, checks, hints, YAML output, JSON Schema and manual are
// derived from the declaration:
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
// ByteSize, Duration, AutoCount, Triple, Band, std::map<std::string, Band> and groups. A struct may add `void
// check(auto&& complain) const` for rules that involve several fields: complain("key", "what is wrong, what is
// allowed"). The names of an enum `E` are returned by a function found by argument-dependent lookup: `constexpr auto
// names_of(E) -> std::array<std::string_view, n>`.

}  // namespace sim
