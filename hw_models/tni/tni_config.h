#pragma once
#include <array>
#include <bit>
#include <cstdint>
#include <string_view>
#include <vector>

#include "hw_models/memory/cache.h"
#include "sim/config/field.h"
#include "sim/named.h"
#include "sim/unit_report.h"
#include "traces/accel/node_format.h"
#include "traces/accel/ray_predictor.h"

namespace hw {

/// Stack scheme of a traversal unit: how a ray stores the far children that it has yet to visit.
enum class StackScheme : std::uint8_t {
  kFull,          ///< a stack of unlimited depth
  kRestartLink,   ///< short stack: an overflow drops the oldest entry but keeps a link to its node, at which traversal
                  ///< restarts when the stack is empty (US patent 9,275,494)
  kRestartTrail,  ///< short stack or none: for each BVH level, a trail stores how many hit children are finished; when
                  ///< the stack is empty, traversal restarts at the root and follows the trail (US patents 9,495,792
                  ///< and 9,390,545; Vaidyanathan et al. 2019 for wide trees)
  kParent,        ///< short stack or none: when the stack is empty, the ray climbs by parent links, tests each parent
                  ///< again and continues at its next hit child
};
constexpr std::array<std::string_view, 4> names_of(StackScheme) {
  return {"full", "restart_link", "restart_trail", "parent"};
}

/// What one stack entry of a wide visit stores.
enum class StackPush : std::uint8_t {
  kChild,  ///< one hit child; a child that begins beyond the hit is dropped when popped
  kNode,   ///< all hit children that remain of a node, in packed order and without distances; each pop takes the next
           ///< child, which is visited even if it begins beyond the hit
};
constexpr std::array<std::string_view, 2> names_of(StackPush) { return {"child", "node"}; }

/// Whether box testers without a child are clocked during a visit.
enum class IdleTesters : std::uint8_t { kGated, kClocked };
constexpr std::array<std::string_view, 2> names_of(IdleTesters) { return {"gated", "clocked"}; }

/// Properties of the trees for which a T&I unit is built, as far as they determine its logic.
struct TreeKind {
  bool wide = false;
  traces::NodeFormat format = traces::NodeFormat::kFp32;
  std::uint32_t slots = 2;  ///< most children of a node, empty slots included
  traces::ChildOrder order = traces::ChildOrder::kSort;
  traces::LeafFormat leaf = traces::LeafFormat::kTriangles;

  bool is_decoded() const { return wide && traces::is_quantised(format); }
  /// Returns the number of comparisons that order `children` entry distances.
  std::uint32_t comparisons(std::uint32_t children) const {
    // Smallest known sorting networks (Knuth, The Art of Computer Programming, volume 3), by number of inputs.
    constexpr std::array<std::uint32_t, 9> kSort{0, 0, 1, 3, 5, 9, 12, 16, 19};
    if (!wide || children < 2 || order == traces::ChildOrder::kOctant) return 0;
    return order == traces::ChildOrder::kSort ? kSort[children] : children - 1;
  }
};

/// Prefetching policy of a traversal unit.
enum class Prefetch : std::uint8_t {
  kNone,
  kSibling,  ///< prefetch the far child's node when a visit hits both children
  kStack,    ///< prefetch the next stack entries on a pop that follows a pop (Tozlu et al. 2026)
  kTreelet,  ///< prefetch the nodes and leaves of a treelet when the line of its root misses (Chou et al. 2023)
};
constexpr std::array<std::string_view, 4> names_of(Prefetch) { return {"none", "sibling", "stack", "treelet"}; }

/// Whether rays that wait for the same node line are served as a group by one read of the line.
enum class Gather : std::uint8_t { kOff, kNode };
constexpr std::array<std::string_view, 2> names_of(Gather) { return {"off", "node"}; }

/// Handling of misses in the first-level caches of a T&I unit (fetch_stage.h): what happens to a ray or leaf that
/// misses.
enum class MissHandling : std::uint8_t {
  kReorder,   ///< wait in the input buffer and probe again when the line has arrived (Lee et al. 2015)
  kBypass,    ///< go through the pipe without work and probe again, until it hits (US patent 9,754,403)
  kRau,       ///< wait in the RAU table until the line has arrived, then resume without a probe (US patent 9,342,919)
  kBlocking,  ///< stall the fetch stage until the line has arrived
};
constexpr std::array<std::string_view, 4> names_of(MissHandling) { return {"reorder", "bypass", "rau", "blocking"}; }

/// Configuration of the ray accumulation unit (RAU), a table with one row for each missed line. A row stores the rays
/// that wait for the line.
struct RauConfig {
  std::uint32_t rows = 16;
  std::uint32_t rays = 4;

  static void describe(auto& c, auto&& field) {
    using sim::Affects;
    field(NAMED(c.rows), "rows", "lines that rays wait for at the same time", sim::between(1, 64), Affects::kTiming);
    field(NAMED(c.rays), "rays", "rays that can wait for one line", sim::between(1, 64), Affects::kTiming);
  }
  /// Returns the size of the RAU table in bytes. A row stores a line and `rays` rays.
  std::uint64_t sram_bytes(std::uint32_t ray_bytes, std::uint64_t line_bytes) const {
    return rows * (std::uint64_t{rays} * ray_bytes + line_bytes);
  }
};

/// Dispatch policy of a T&I unit: which traversal unit gets the next ray.
enum class Dispatch : std::uint8_t {
  kEmptiest,    ///< the ray goes to the traversal unit with the fewest rays inside
  kRoundRobin,  ///< the ray goes to the next traversal unit with room, in round-robin order
};
constexpr std::array<std::string_view, 2> names_of(Dispatch) { return {"emptiest", "round_robin"}; }

/// Order in which the ray dispatcher sends rays.
enum class RaySort : std::uint8_t {
  kNone,          ///< the order of the shader core
  kOriginOctant,  ///< by cell of the origin and octant of the direction (traces/ray_key.h), within a window
};
constexpr std::array<std::string_view, 2> names_of(RaySort) { return {"none", "origin_octant"}; }

/// Configuration of the ray dispatcher: the window in which rays are sorted.
struct DispatcherConfig {
  RaySort sort = RaySort::kNone;
  std::uint32_t window = 256;
  std::uint32_t timeout = 4096;

  static constexpr std::uint64_t kRayBytes = 48;  ///< storage of a ray in the window

  static void describe(auto& c, auto&& field) {
    using sim::Affects;
    field(NAMED(c.sort), "", "order in which rays are sent to traversal units", sim::any(), Affects::kTiming);
    field(NAMED(c.window), "rays", "rays held at once for sorting (sort: origin_octant)", sim::between(16, 1024),
          Affects::kTiming);
    field(NAMED(c.timeout), "cycles", "wait in the window after which a ray is sent before all others",
          sim::between(1, 1 << 20), Affects::kTiming);
  }
  bool is_sorting() const { return sort != RaySort::kNone; }
  /// Returns the size in bytes of the window.
  std::uint64_t sram_bytes() const { return is_sorting() ? window * kRayBytes : 0; }
  /// Returns the parts of the ray dispatcher: a comparator for each entry of the sorted window.
  std::vector<sim::UnitPart> parts() const { return {{"comparator", is_sorting() ? window : 0}}; }
};

/// Maximum latency, in cycles, of pipelines in the T&I unit, which a TimingWheel simulates.
inline constexpr std::uint32_t kLongestPipe = 63;

/// Configuration of a traversal unit (TRV).
struct TrvConfig {
  std::uint32_t rays = 32;
  std::uint32_t box_testers = 2;
  IdleTesters idle_testers = IdleTesters::kGated;
  std::uint32_t box_latency = 12;
  std::uint32_t decode_latency = 2;
  std::uint32_t order_latency = 3;
  std::uint32_t leaf_latency = 4;
  std::uint32_t stack_latency = 2;
  std::uint32_t transform_latency = 12;
  StackScheme stack = StackScheme::kRestartLink;
  StackPush stack_push = StackPush::kChild;
  std::uint32_t stack_entries = 8;
  std::uint32_t stack_entry_bytes = 8;
  std::uint32_t ray_bytes = 96;
  Prefetch prefetch = Prefetch::kNone;
  std::uint32_t prefetch_depth = 2;
  sim::ByteSize treelet_bytes{1024};
  Gather gather = Gather::kOff;
  std::uint32_t gather_width = 8;
  CacheConfig l1;

  static constexpr std::uint32_t kPrefetchQueue = 128;  ///< lines, and leaves, that can wait for their prefetch
  static constexpr std::uint32_t kMapReads = 8;         ///< treelets whose lists can be read at once

  static void describe(auto& c, auto&& field) {
    using sim::Affects;
    field(NAMED(c.rays), "rays", "rays held at once (input buffer)", sim::between(1, 64), Affects::kTiming);
    field(
        NAMED(c.box_testers), "testers",
        "boxes tested per cycle: a visit of n children takes ceil(n / box_testers) cycles of the box pipe, parallel to "
        "stack and leaf pipes; 1: one box per pass, one pipe for all work",
        sim::between(1, traces::kMaxWidth), Affects::kWalk);
    field(NAMED(c.idle_testers), "", "whether box testers without a child are clocked during a visit", sim::any(),
          Affects::kTiming);
    field(NAMED(c.box_latency), "cycles", "pipeline depth of a box test", sim::between(1, 40), Affects::kTiming);
    field(NAMED(c.decode_latency), "cycles", "additional latency of a visit to a node with quantised boxes",
          sim::between(0, 8), Affects::kTiming);
    field(NAMED(c.order_latency), "cycles",
          "additional latency of a visit to a wide node, whose hit children are ordered by distance",
          sim::between(0, 8), Affects::kTiming);
    field(NAMED(c.leaf_latency), "cycles", "latency of the leaf sub-pipe, to the intersection unit's buffer",
          sim::between(1, 16), Affects::kTiming);
    field(NAMED(c.stack_latency), "cycles", "latency of a stack pop", sim::between(1, 16), Affects::kTiming);
    field(NAMED(c.transform_latency), "cycles",
          "latency of transforming a ray into an instance's space in the box pipe (bvh.instances: two_level)",
          sim::between(1, 40), Affects::kTiming);
    field(NAMED(c.stack), "", "stack scheme: where far children are kept", sim::any(), Affects::kWalk);
    field(NAMED(c.stack_push), "",
          "stack entries of wide nodes: one for each hit child, or one for all hit children of a node, without culls",
          sim::any(), Affects::kWalk);
    field(NAMED(c.stack_entries), "entries",
          "entries of each ray's short stack; with stack: full, entries that take area and leak; 0: restart_trail or "
          "parent without a stack",
          sim::between(0, 64), Affects::kWalk);
    field(NAMED(c.stack_entry_bytes), "bytes", "storage of a stack entry, for leakage and area", sim::between(1, 64),
          Affects::kEnergy);
    field(NAMED(c.ray_bytes), "bytes", "storage of a ray in the input buffer, for leakage and area",
          sim::between(16, 256), Affects::kEnergy);
    field(NAMED(c.prefetch), "", "which node lines are prefetched", sim::any(), Affects::kTiming);
    field(NAMED(c.prefetch_depth), "entries", "stack entries whose nodes a pop prefetches (prefetch: stack)",
          sim::between(1, 4), Affects::kTiming);
    field(NAMED(c.treelet_bytes), "", "largest size of a treelet, in whole lines (prefetch: treelet)",
          sim::power_of_two(512, 8192), Affects::kTiming);
    field(NAMED(c.gather), "", "whether rays that wait for the same node line are served by one read", sim::any(),
          Affects::kTiming);
    field(NAMED(c.gather_width), "rays", "rays of a full group, which is served first (gather: node)",
          sim::between(4, 16), Affects::kTiming);
    field.group(NAMED(c.l1), "private node cache");
  }
  void check(auto&& complain) const {
    if (stack_entries == 0 && stack != StackScheme::kRestartTrail && stack != StackScheme::kParent)
      complain("stack_entries", "must be at least 1; 0 is allowed with stack: restart_trail or parent only");
    if (gather != Gather::kOff && box_testers == 1)
      complain("gather", "is node; allowed with box_testers of 2 or more, whose box pipe is separate");
    if (l1.hit_cycles + box_latency > kLongestPipe)
      complain("box_latency", "node fetch (l1.hit_cycles) and box test together must not exceed 63 cycles");
    if (l1.hit_cycles + transform_latency > kLongestPipe)
      complain("transform_latency", "instance fetch (l1.hit_cycles) and transform together must not exceed 63 cycles");
  }
  /// Returns the bytes by which a ray's restart trail is larger in wide trees. A level of a tree of up to w children
  /// takes the bits of w + 1 values (Vaidyanathan et al. 2019); one bit per level is in ray_bytes.
  std::uint32_t trail_bytes(const TreeKind& tree) const {
    constexpr std::uint32_t kLevels = 32;  // wide trees of a million triangles have up to about twenty levels
    if (!tree.wide || stack != StackScheme::kRestartTrail) return 0;
    return (static_cast<std::uint32_t>(std::bit_width(tree.slots)) - 1) * kLevels / 8;
  }
  /// Returns the most cycles of the box pipe that a visit takes.
  std::uint32_t most_passes(const TreeKind& tree) const {
    return tree.wide ? (tree.slots + box_testers - 1) / box_testers : 1;
  }
  /// Returns the latency of a visit after its last line, if the visit takes one cycle of the box pipe.
  std::uint32_t visit_latency(const TreeKind& tree) const {
    const bool ordered = tree.wide && tree.order != traces::ChildOrder::kOctant;
    return box_latency + (tree.is_decoded() ? decode_latency : 0) + (ordered ? order_latency : 0);
  }
  /// Returns the parts of a traversal unit that is built for trees of one kind.
  std::vector<sim::UnitPart> parts(const TreeKind& tree) const;
  bool has_prefetch_queue() const { return prefetch == Prefetch::kStack || prefetch == Prefetch::kTreelet; }
  /// Returns the size in bytes of a traversal unit's cache, input buffer, stacks and queue of prefetches. With gather,
  /// the input buffer also holds the line for which each ray waits.
  std::uint64_t sram_bytes() const {
    constexpr std::uint64_t kLineNumberBytes = 4;
    return l1.size.bytes + std::uint64_t{rays} * (ray_bytes + std::uint64_t{stack_entry_bytes} * stack_entries) +
           (has_prefetch_queue() ? 2 * kPrefetchQueue * kLineNumberBytes : 0) +
           (prefetch == Prefetch::kTreelet ? kMapReads * kLineNumberBytes : 0) +
           (gather == Gather::kOff ? 0 : rays * kLineNumberBytes);
  }
};

/// Configuration of an intersection unit (IST).
struct IstConfig {
  std::uint32_t leaves = 32;
  std::uint32_t leaf_bytes = 96;
  std::uint32_t distance_stage = 8;
  std::uint32_t barycentric_stage = 16;
  std::uint32_t latency = 22;
  std::uint32_t decode_interval = 1;
  CacheConfig l1{.size = {32 * 1024}};

  static void describe(auto& c, auto&& field) {
    using sim::Affects;
    field(NAMED(c.leaves), "leaves", "leaves held at once (input buffer)", sim::between(1, 64), Affects::kTiming);
    field(NAMED(c.leaf_bytes), "bytes", "storage of a leaf and its ray in the input buffer, for leakage and area",
          sim::between(16, 256), Affects::kEnergy);
    field(NAMED(c.distance_stage), "cycles", "stages until a test that fails by distance ends", sim::between(1, 40),
          Affects::kTiming);
    field(NAMED(c.barycentric_stage), "cycles", "stages until a test that fails by edges ends", sim::between(1, 40),
          Affects::kTiming);
    field(NAMED(c.latency), "cycles", "pipeline depth of a triangle test that hits", sim::between(1, 40),
          Affects::kTiming);
    field(NAMED(c.decode_interval), "cycles",
          "cycles from one triangle that is decoded from a block to the next (bvh.leaf: block128)", sim::between(1, 16),
          Affects::kTiming);
    field.group(NAMED(c.l1), "triangle cache");
  }
  void check(auto&& complain) const {
    if (l1.hit_cycles + latency > kLongestPipe)
      complain("latency", "triangle fetch (l1.hit_cycles) and test together must not exceed 63 cycles");
    if (distance_stage > barycentric_stage || barycentric_stage > latency)
      complain("latency", "the stages must rise: distance_stage <= barycentric_stage <= latency");
  }
  /// Returns the parts of an intersection unit that is built for trees of one kind.
  std::vector<sim::UnitPart> parts(const TreeKind& tree) const;
  std::uint64_t sram_bytes() const { return l1.size.bytes + std::uint64_t{leaves} * leaf_bytes; }
};

/// Settings that all units of a T&I unit share.
struct TniMode {
  MissHandling handling = MissHandling::kReorder;
  RauConfig rau;
  bool ideal = false;     ///< all units do unlimited operations of each kind per cycle (ideal.tni)
  bool ideal_l1 = false;  ///< every probe of an L1 hits (ideal.l1)
};

/// Configuration of a T&I (traversal and intersection) unit: a ray dispatcher, traversal units, intersection units.
struct TniConfig {
  std::uint32_t trvs = 4;
  std::uint32_t ists = 1;
  std::uint32_t link_depth = 2;
  Dispatch dispatch = Dispatch::kEmptiest;
  MissHandling miss_handling = MissHandling::kReorder;
  RauConfig rau;
  DispatcherConfig dispatcher;
  TrvConfig trv;
  IstConfig ist;
  traces::PredictorConfig predictor;

  static void describe(auto& c, auto&& field) {
    using sim::Affects;
    field(NAMED(c.trvs), "units", "traversal units", sim::between(1, 16), Affects::kTiming);
    field(NAMED(c.ists), "units", "intersection units; the traversal units share them evenly", sim::between(1, 4),
          Affects::kTiming);
    field(NAMED(c.link_depth), "entries", "slots of each link inside the unit", sim::between(1, 64), Affects::kTiming);
    field(NAMED(c.dispatch), "", "which traversal unit gets a ray", sim::any(), Affects::kTiming);
    field(NAMED(c.miss_handling), "", "how a ray or leaf that misses in its L1 is handled", sim::any(),
          Affects::kTiming);
    field.group(NAMED(c.rau), "table of waiting rays, one per L1, with miss_handling: rau");
    field.group(NAMED(c.dispatcher), "ray dispatcher");
    field.group(NAMED(c.trv), "traversal unit");
    field.group(NAMED(c.ist), "intersection unit");
    field.group(NAMED(c.predictor), "predictor of any-hit rays");
  }
  void check(auto&& complain) const {
    if (ists > trvs) {
      complain("ists", "is " + std::to_string(ists) + "; allowed: 1 to tni.trvs, which is " + std::to_string(trvs));
    }
    if (trv.gather != Gather::kOff && miss_handling != MissHandling::kReorder)
      complain("miss_handling", "is not reorder; allowed with tni.trv.gather: off, groups wait in the input buffer");
  }
  /// Returns the SRAM bytes of one traversal unit, or of one intersection unit, with its RAU table if it has one.
  /// `tree`: kind of the trees for which the unit is built.
  std::uint64_t trv_sram_bytes(const TreeKind& tree = {}) const {
    return trv.sram_bytes() + std::uint64_t{trv.rays} * trv.trail_bytes(tree) +
           rau_bytes(trv.ray_bytes, trv.l1.line.bytes);
  }
  std::uint64_t ist_sram_bytes() const { return ist.sram_bytes() + rau_bytes(ist.leaf_bytes, ist.l1.line.bytes); }

 private:
  std::uint64_t rau_bytes(std::uint32_t ray_bytes, std::uint64_t line_bytes) const {
    return miss_handling == MissHandling::kRau ? rau.sram_bytes(ray_bytes, line_bytes) : 0;
  }
};

}  // namespace hw
