#pragma once
#include <array>
#include <cstdint>
#include <string_view>

#include "hw_models/memory/cache_tags.h"
#include "sim/config/field.h"

namespace hw {

/// Where a ray keeps the far children it still has to visit.
enum class StackScheme : std::uint8_t {
  kFull,         ///< as deep as needed
  kRestartLink,  ///< short: when full the oldest entry is dropped and a link to its node kept; when the short stack is
                 ///< empty and entries were dropped, traversal starts again from that node (US patent 9,275,494)
};
constexpr std::array<std::string_view, 2> names_of(StackScheme) { return {"full", "restart_link"}; }

/// A unit's pipelines are kept in a calendar of this many cycles (wheel.h).
inline constexpr std::uint32_t kLongestPipe = 63;

/// One traversal unit.
struct TrvConfig {
  std::uint32_t rays = 32;
  std::uint32_t box_latency = 12;
  std::uint32_t leaf_latency = 4;
  std::uint32_t stack_latency = 2;
  StackScheme stack = StackScheme::kRestartLink;
  std::uint32_t stack_entries = 8;
  std::uint32_t stack_entry_bytes = 8;
  std::uint32_t ray_bytes = 96;
  CacheConfig l1;

  static void describe(auto& c, auto&& field) {
    using sim::Affects;
    field(c.rays, "rays", "rays", "rays held at once (input buffer)", sim::between(1, 64), Affects::kTiming);
    field(c.box_latency, "box_latency", "cycles", "pipeline depth of the test of both child boxes", sim::between(1, 40),
          Affects::kTiming);
    field(c.leaf_latency, "leaf_latency", "cycles", "leaf sub-pipe, from leaf to the intersection unit's buffer",
          sim::between(1, 16), Affects::kTiming);
    field(c.stack_latency, "stack_latency", "cycles", "stack sub-pipe, one pop", sim::between(1, 16), Affects::kTiming);
    field(c.stack, "stack", "", "where far children wait", sim::any(), Affects::kWalk);
    field(c.stack_entries, "stack_entries", "entries", "short stack depth per ray (restart_link)", sim::between(1, 64),
          Affects::kWalk);
    field(c.stack_entry_bytes, "stack_entry_bytes", "bytes", "storage of a stack entry (it leaks)", sim::between(1, 64),
          Affects::kEnergy);
    field(c.ray_bytes, "ray_bytes", "bytes", "storage of a ray in the input buffer (it leaks)", sim::between(16, 256),
          Affects::kEnergy);
    field.group(c.l1, "l1", "private node cache");
  }
  void check(auto&& complain) const {
    if (l1.hit_cycles + box_latency > kLongestPipe)
      complain("box_latency", "node fetch (l1.hit_cycles) and box test together must not exceed 63 cycles");
  }
  /// Cache, input buffer and stacks.
  std::uint64_t sram_bytes() const {
    return l1.size.bytes + std::uint64_t{rays} * (ray_bytes + std::uint64_t{stack_entry_bytes} * stack_entries);
  }
};

/// One intersection unit.
struct IstConfig {
  std::uint32_t leaves = 32;
  std::uint32_t leaf_bytes = 96;
  std::uint32_t distance_stage = 8;
  std::uint32_t barycentric_stage = 16;
  std::uint32_t latency = 22;
  CacheConfig l1{.size = {32 * 1024}};

  static void describe(auto& c, auto&& field) {
    using sim::Affects;
    field(c.leaves, "leaves", "leaves", "leaves held at once (input buffer)", sim::between(1, 64), Affects::kTiming);
    field(c.leaf_bytes, "leaf_bytes", "bytes", "storage of a leaf and its ray in the input buffer (it leaks)",
          sim::between(16, 256), Affects::kEnergy);
    field(c.distance_stage, "distance_stage", "cycles", "stage after which a test that fails on distance is known",
          sim::between(1, 40), Affects::kTiming);
    field(c.barycentric_stage, "barycentric_stage", "cycles",
          "stage after which a test that fails on the edges is known", sim::between(1, 40), Affects::kTiming);
    field(c.latency, "latency", "cycles", "pipeline depth of a triangle test that hits", sim::between(1, 40),
          Affects::kTiming);
    field.group(c.l1, "l1", "triangle cache");
  }
  void check(auto&& complain) const {
    if (l1.hit_cycles + latency > kLongestPipe)
      complain("latency", "triangle fetch (l1.hit_cycles) and test together must not exceed 63 cycles");
    if (distance_stage > barycentric_stage || barycentric_stage > latency)
      complain("latency", "the stages must rise: distance_stage <= barycentric_stage <= latency");
  }
  std::uint64_t sram_bytes() const { return l1.size.bytes + std::uint64_t{leaves} * leaf_bytes; }
};

/// A traversal & intersection unit: one ray dispatcher, several traversal units, one intersection unit.
struct TniConfig {
  std::uint32_t trvs = 4;
  std::uint32_t link_depth = 2;
  TrvConfig trv;
  IstConfig ist;

  static void describe(auto& c, auto&& field) {
    using sim::Affects;
    field(c.trvs, "trvs", "units", "traversal units", sim::between(1, 16), Affects::kTiming);
    field(c.link_depth, "link_depth", "entries", "slots of each link inside the unit", sim::between(1, 64),
          Affects::kTiming);
    field.group(c.trv, "trv", "traversal unit");
    field.group(c.ist, "ist", "intersection unit");
  }
};

}  // namespace hw
