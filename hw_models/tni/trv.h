#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "hw_models/memory/unit_names.h"
#include "hw_models/tni/fetch_stage.h"
#include "hw_models/tni/messages.h"
#include "hw_models/tni/node_prefetcher.h"
#include "hw_models/tni/node_stack.h"
#include "hw_models/tni/timing_wheel.h"
#include "hw_models/tni/tni_config.h"
#include "hw_models/tni/traversal_slot.h"
#include "hw_models/tni/tree_in_memory.h"
#include "sim/link.h"
#include "sim/named.h"
#include "sim/unit_report.h"

namespace hw {

/// Features of a traversal unit on which the code of its tick depends.
struct TrvFeatures {
  bool instances = false;   ///< the scene has instances (a two-level BVH)
  bool plain = true;        ///< a visit is one pass that reads one line and tests two boxes in floating point
  bool one_pipe = false;    ///< box tests, pops and leaves share one pipe
  bool ideal = false;       ///< the unit does unlimited operations per cycle
  bool prefetches = false;  ///< nodes of far children are prefetched
  bool prefetcher = false;  ///< nodes of stack entries or treelets are prefetched
  bool gathers = false;     ///< rays that wait for the same node line are served as a group
  bool reorders = true;     ///< miss handling is `reorder` and the L1 is not ideal
  bool stack = true;        ///< a ray's stack has a capacity of at least one entry
  bool wide = false;        ///< the tree has wide nodes
  bool node_stack = false;  ///< a stack entry of wide nodes is a node (stack_push: node)

  friend bool operator==(const TrvFeatures&, const TrvFeatures&) = default;
};

/// Features of the two most common traversal units: the default one, and one for wide nodes. The code of a tick is
/// compiled three times: with the features of each as constants, and for any features.
inline constexpr TrvFeatures kDefaultTrvFeatures{};
inline constexpr TrvFeatures kWideTrvFeatures{.plain = false, .wide = true};
enum class TrvCode : std::uint8_t { kDefault, kWide, kAny };

/// A traversal unit (TRV) takes independent rays through a BVH. Its three sub-pipes work in parallel, each on
/// one operation per cycle.
///
///   rays --> [input buffer: up to 64 slots] --> inner: node fetch (L1) + boxes -------+
///                   ^                       --> stack: one pop ----------------------+--> back to the buffer
///                   |                       --> leaf: to the IST, `count` cycles -----> ... answer
///                   +---- finished rays leave in any order
///
/// 1. A ray keeps its slot until it retires. Ready rays are served round robin by slot.
/// 2. The fetch stage handles rays whose node misses in the L1 (fetch_stage.h). A visit that needs several lines
/// fetches one per cycle.
/// 3. A push needs no cycle of its own, because the stack RAM has one read and one write port.
/// 4. With one box tester (the unit before 2014) a visit takes two passes, one per child. Passes, pops and leaves then
/// share one pipe, which accepts one of them per cycle; a leaf of n triangles occupies it for n cycles. Latencies do
/// not change.
/// 5. At an instance, the unit reads the instance's record, one line, through the L1 and transforms the ray into the
/// instance's space. The slot keeps the original ray, so a pop out of the instance has no extra cost.
/// 6. A visit of a wide node with n children takes ceil(n / box_testers) cycles of the box pipe. Meanwhile, lines that
/// are not the last of their visit may be read. Decoding quantised boxes and ordering the hit children add latency.
/// 7. With stack_push: node, rays visit children beyond their hit too. Such a visit hits nothing; the tests of such a
/// leaf end with their distance.
/// 8. With gather: node, one read of a line serves all rays that wait for it, up to a full group. The group's rays then
/// enter the box pipe one after the other, and the next group reads its line when the last of them has entered. Full
/// groups are served first, but not twice in a row if other rays are ready. Rays whose line misses wait as a group.
///
/// Not modelled: reuse of a ray's slot in the input buffer while the ray waits in the RAU table.
class Trv {
 public:
  static constexpr const char* kName = "core.tni.trv";
  static constexpr Block kBlock = Block::kTni;
  enum class CycleReason : std::uint8_t {
    kStarved,
    kVisiting,
    kL1Miss,
    kMshrFull,
    kIst,
    kPipe,
    kOutputFull,
    kSerial,
    kRauFull,
    kCount
  };
  static constexpr auto kReasons = sim::reasons<CycleReason>({
      {CycleReason::kStarved, sim::idle_reason("starved", "no ray inside")},
      {CycleReason::kVisiting,
       sim::working_reason(
           "visiting",
           "a node visit, one of its lines, or a transform into an instance entered the box pipe, or a wide "
           "visit occupied it")},
      {CycleReason::kL1Miss, sim::waiting_reason("l1_miss", "rays wait for node lines, or this cycle's probe missed")},
      {CycleReason::kMshrFull, sim::waiting_reason("mshr_full", "rays wait for a free MSHR")},
      {CycleReason::kIst, sim::waiting_reason("ist", "rays wait for the intersection unit")},
      {CycleReason::kPipe,
       sim::working_reason("pipe", "rays are all inside the pipelines: too few of them to fill the latency")},
      {CycleReason::kOutputFull,
       sim::waiting_reason("output_full", "finished rays wait for room at the ray dispatcher")},
      {CycleReason::kSerial,
       sim::working_reason("serial", "a pop, a leaf or a wide visit occupied the shared pipe (box_testers: 1)")},
      {CycleReason::kRauFull,
       sim::waiting_reason("rau_full", "a ray stalls the fetch stage because the table of waiting rays is full (rau)")},
  });
  struct Stats : FetchStats, StackStats {
    std::uint64_t visits = 0, leaves = 0;
    std::uint64_t rays_in = 0, rays_out = 0;
    std::uint64_t restarted_visits = 0, first_passes = 0;
    std::uint64_t box_tests = 0, hybrid_box_tests = 0;  ///< box tests in floating point and in fixed point, computed by
                                                        ///< stats()
    std::uint64_t q8_box_tests = 0, q12_box_tests = 0;  ///< box tests with quantised planes, computed by stats()
    std::uint64_t children = 0;                         ///< children of the wide nodes visited, not reported
    std::uint64_t box_cycles = 0;
    std::uint64_t idle_lanes = 0, clocked_lanes = 0, decoded_nodes = 0, comparisons = 0;
    std::uint64_t node_lines = 0, parent_links = 0, extra_visits = 0, extra_leaves = 0, extra_tests = 0;
    std::uint64_t transforms = 0;
    std::uint64_t bypass_passes = 0, prefetch_probes = 0, prefetches = 0;
    std::uint64_t full = 0, full_visits = 0;
    bool has_prefetcher = true, gathers = true;  ///< counters of the prefetcher and of groups are reported
    std::uint64_t prefetch_stack_reads = 0, prefetches_dropped = 0, prefetched_leaves = 0;
    std::uint64_t map_reads = 0, map_misses = 0, map_fills = 0;
    std::uint64_t prefetches_useful = 0, prefetches_late = 0, prefetches_useless = 0;
    std::uint64_t groups = 0, full_groups = 0, gathered = 0, gather_compares = 0;
    static void describe(auto& s, auto&& counter) {
      counter(NAMED(s.rays_in), "rays accepted into the input buffer", "tni.ray_buffer_write");
      counter(NAMED(s.rays_out), "rays retired", "tni.ray_buffer_read");
      counter(NAMED(s.full), "cycles with a ray in every slot", "", sim::CounterKind::kAtEnd);
      counter(NAMED(s.full_visits), "visits in these cycles");
      counter(NAMED(s.visits), "nodes tested, restarts included", "tni.ray_update");
      counter(NAMED(s.restarted_visits), "of these, nodes tested again after a restart");
      counter(NAMED(s.first_passes), "passes that test the first child only (one box tester)", "tni.ray_update");
      counter(NAMED(s.box_tests), "child boxes tested, floating-point", "tni.box_test");
      counter(NAMED(s.hybrid_box_tests), "child boxes tested, fixed-point planes and origin", "tni.box_test_hybrid");
      counter(NAMED(s.q8_box_tests), "child boxes tested, planes of 8 bits", "tni.box_test_q8");
      counter(NAMED(s.q12_box_tests), "child boxes tested, planes of 12 bits", "tni.box_test_q12");
      counter(NAMED(s.box_cycles), "cycles of the box pipe that visits of wide nodes take");
      counter(NAMED(s.idle_lanes), "box testers without a child in the cycles of visits");
      counter(NAMED(s.clocked_lanes), "of these, testers that are clocked (idle_testers: clocked)", "tni.box_idle");
      counter(NAMED(s.decoded_nodes), "nodes with quantised boxes tested", "tni.node_decode");
      counter(NAMED(s.comparisons), "comparisons that order the children of wide nodes", "tni.order_compare");
      counter(NAMED(s.node_lines), "lines read by visits of wide nodes");
      counter(NAMED(s.parent_links), "parent links read (stack: parent)");
      counter(NAMED(s.extra_visits), "of the visits, those of nodes beyond the hit (stack_push: node)");
      counter(NAMED(s.extra_leaves), "leaves beyond the hit that were sent (stack_push: node)");
      counter(NAMED(s.extra_tests), "triangles of these leaves");
      counter(NAMED(s.transforms), "rays transformed into an instance's space, restarts included", "tni.ray_transform");
      FetchStats::describe(s, counter);
      counter(NAMED(s.bypass_passes), "passes of a ray that missed through the box pipe, without work",
              "tni.bypass_pass");
      counter(NAMED(s.prefetch_probes), "far nodes probed for prefetching", "cache.l1_probe");
      counter(NAMED(s.prefetches), "of these, lines requested from memory");
      if (s.has_prefetcher) {
        counter(NAMED(s.prefetch_stack_reads), "stack entries read for prefetching", "tni.stack_pop");
        counter(NAMED(s.prefetches_useful), "prefetched lines read after they arrived");
        counter(NAMED(s.prefetches_late), "prefetched lines needed before they arrived");
        counter(NAMED(s.prefetches_useless), "prefetched lines evicted before they were needed");
        counter(NAMED(s.prefetches_dropped), "lines, leaves and treelets not prefetched because a queue was full");
        counter(NAMED(s.prefetched_leaves), "leaves sent to the intersection unit for prefetching",
                "tni.ray_buffer_write");
        counter(NAMED(s.map_reads), "lines of the map of treelets read", "cache.l1_read");
        counter(NAMED(s.map_misses), "of these, lines that were not in the L1", "cache.l1_probe");
        counter(NAMED(s.map_fills), "lines of the map requested from memory");
      }
      if (s.gathers) {
        counter(NAMED(s.groups), "groups of rays served by one read of a line");
        counter(NAMED(s.full_groups), "of these, full groups");
        counter(NAMED(s.gathered), "rays of groups served without a probe of their own", "tni.ray_buffer_read");
        counter(NAMED(s.gather_compares), "comparisons of two waiting rays' lines, to form groups",
                "tni.order_compare");
      }
      StackStats::describe(s, counter);
      counter(NAMED(s.leaves), "leaves sent to the intersection unit", "tni.ray_route");
    }
  };
  struct Links {
    sim::Link<RayJob>& rays_in;
    sim::Link<RayDone>& rays_out;
    sim::Link<LeafJob>& leaves_out;
    sim::Link<LeafDone>& leaves_in;
    sim::Link<MemRequest>& memory_out;
    sim::Link<MemResponse>& memory_in;
    sim::Link<LeafPrefetch>* leaf_prefetches_out = nullptr;  ///< null without prefetches of leaves
  };

  /// `treelets`: treelets of the scene, if they are prefetched; otherwise null.
  Trv(const TrvConfig& config, const TniMode& mode, const TreeInMemory& tree, std::shared_ptr<const Treelets> treelets,
      Links links, std::uint16_t client, sim::Clock clock);
  Trv(const Trv&) = delete;
  Trv& operator=(const Trv&) = delete;

  sim::Time tick(sim::Time now);
  /// Ticks those traversal units of a core whose bits in the mask `due` are set, and stores each unit's next wake-up
  /// time in `wakes`. All units must have the same configuration.
  static void tick_due(std::span<Trv* const> trvs, std::uint64_t due, sim::Time* wakes, const Cycle& cycle);
  const sim::Clock& clock() const { return clock_; }
  Stats stats() const;
  std::uint64_t retired_items() const {
    return stats_.visits - stats_.restarted_visits + stats_.leaves + stats_.rays_out;
  }
  const sim::Activity<CycleReason>& activity() const { return activity_; }
  void finish(sim::Time end);
  bool idle() const {
    return occupied_ == 0 && !fetch_.waits_for_memory() && (!prefetcher_ || prefetcher_->is_empty());
  }
  std::string state() const;
  bool warm_line(Addr line) { return fetch_.warm_line(line); }
  const CacheTags& l1_tags() const { return fetch_.l1_tags(); }
  void set_l1_tags(const CacheTags& tags) { fetch_.set_l1_tags(tags); }
  std::size_t clear_l1() { return fetch_.clear_l1(); }

 private:
  using Pipe = TraversalSlot::Pipe;
  static constexpr Pipe kToInner = Pipe::kToInner, kToStack = Pipe::kToStack, kToLeaf = Pipe::kToLeaf,
                        kToRetire = Pipe::kToRetire, kPipes = Pipe::kPipes;
  struct FarNode {
    std::uint32_t node = 0, slot = 0;
  };

  /// Simulates one cycle of the traversal unit. `kCode`: which of its features are constants.
  template <TrvCode kCode>
  sim::Time simulate_cycle(const Cycle& cycle);
  sim::Time simulate_cycle_of_wide(const Cycle& cycle);
  sim::Time simulate_cycle_with_any_features(const Cycle& cycle);
  template <TrvCode kCode>
  TrvFeatures active_features() const {
    if constexpr (kCode == TrvCode::kDefault) return kDefaultTrvFeatures;
    if constexpr (kCode == TrvCode::kWide) return kWideTrvFeatures;
    return features_;
  }

  // Each of these functions does at most one operation. It returns true if it did one.
  bool take_ray(sim::Time now);
  bool take_answer(sim::Time now);
  bool fill_arrived_line(const Cycle& cycle);
  bool issue_leaf(sim::Time now);
  bool retire_ray(sim::Time now);

  /// Takes a cache line, an answer of the intersection unit and a ray from the TRV's input links, if they have arrived.
  void take_arrivals(const Cycle& cycle);
  /// True if the TRV has a leaf to send, a ray to retire or a memory request to send. The conditions are combined into
  /// one test, because each alone is unpredictable.
  bool has_output(sim::Time now) const {
    return (issuable_leaves(now) | waiting_[kToRetire] | fetch_.unsent_requests()) != 0;
  }
  /// Returns a mask of the slots with a leaf to send to the intersection unit; 0 if the leaf pipe or link is occupied.
  std::uint64_t issuable_leaves(sim::Time now) const {
    const bool room = std::max(leaf_free_at_, links_.leaves_out.push_at()) <= now;
    return waiting_[kToLeaf] & (std::uint64_t{0} - std::uint64_t{room});
  }
  /// Sends a leaf, retires a ray, prefetches nodes of far children and sends a memory request, each if possible.
  void issue_outputs(const Cycle& cycle);

  /// Returns the next slot of the mask `slot_mask` to visit a node, in round-robin order.
  std::uint32_t next_slot_round_robin(std::uint64_t slot_mask) {
    const std::uint32_t index = round_robin(slot_mask, inner_turn_);
    inner_turn_ = (index + 1) % 64;
    return index;
  }
  template <TrvCode kCode>
  CycleReason issue_visit(std::uint32_t index, const Cycle& cycle);
  /// A line that a visit reads, with the node of the visit.
  struct VisitLine {
    std::uint32_t node = 0;
    WideRecord record;       ///< only for wide nodes
    bool of_parent = false;  ///< the line is that of the node's parent link
    TreeInMemory::Line read;
  };
  /// Returns the next line that the visit of a slot reads. The slot must not be at an instance.
  template <TrvCode kCode>
  VisitLine next_line(const TraversalSlot& slot, std::uint32_t index) const;
  /// Serves groups of rays: reads the line of the next group if none is being served, and lets a ray of the group visit
  /// its node.
  CycleReason issue_gathered(const Cycle& cycle);
  /// Returns the rays to be served next, as a group that waits for the same line. The lowest slot probes the L1.
  std::uint64_t choose_group();
  /// Reads the line of the next group. Returns the reason of the cycle.
  CycleReason fetch_group(const Cycle& cycle);
  /// True if a group can be served at time `at`.
  bool can_serve_group(sim::Time at) const { return group_ != 0 ? at >= boxes_free_at_ : waiting_[kToInner] != 0; }
  /// Reads a line that is not the last of its visit, if a slot needs one. For cycles in which the box pipe is occupied.
  template <TrvCode kCode>
  void read_early_line(const Cycle& cycle);
  CycleReason handle_miss(FetchStage::Wait wait, std::uint32_t index, std::uint64_t cycle);
  bool enters_instance(const TraversalSlot& slot, std::uint32_t index) const;
  CycleReason issue_transform(TraversalSlot& slot, std::uint32_t index, std::uint64_t cycle);
  CycleReason issue_in_shared_pipe(const Cycle& cycle);
  std::uint64_t shared_pipe_slots(bool room_for_leaves) const;
  template <TrvCode kCode>
  void issue_pop(const Cycle& cycle);
  template <TrvCode kCode>
  void pop_entry(std::uint32_t index, std::uint64_t cycle);
  /// Takes the next child of the youngest entry of a slot's NodeStack. Returns the sub-pipe that the ray then needs.
  Pipe pop_node_stack(TraversalSlot& slot, std::uint32_t index);
  Pipe continue_at_child(TraversalSlot& slot, std::uint32_t index, std::uint32_t link);
  void send_leaf(sim::Time now, std::uint32_t index);
  /// Ends a pass of a node visit, which tests the box of one child. Returns false if the visit needs another pass, for
  /// the other child.
  bool end_box_pass(TraversalSlot& slot, std::uint32_t index, std::uint64_t cycle);
  template <TrvCode kCode>
  void complete_visit(TraversalSlot& slot, std::uint32_t index, std::uint64_t cycle);
  template <TrvCode kCode>
  void complete_wide_visit(TraversalSlot& slot, std::uint32_t index, const VisitLine& line, const Cycle& cycle);
  /// Completes a visit that a restarted ray repeats. Returns the sub-pipe that the ray then needs.
  Pipe complete_replayed_visit(TraversalSlot& slot, std::uint32_t index);
  bool is_extra(std::uint32_t index) const { return (extra_ & slot_bit(index)) != 0; }
  template <TrvCode kCode>
  void take_from_pipes(const Cycle& cycle);
  /// Lists the far children of the last visits of the slots `visited_slots`, which hit both children, for prefetching.
  void collect_far_nodes(std::uint64_t visited_slots);
  void prefetch_far_nodes(std::uint64_t cycle);
  /// Returns the reason to which cycles from time `next` on are charged if no node enters the box pipe.
  CycleReason wait_reason(sim::Time next) const;
  sim::Time next_wake(const Cycle& cycle) const;
  void account_full_buffer(sim::Time now);

  // Members that every tick reads are first, so that they occupy few host cache lines.
  alignas(64) TimingWheel<kPipes>::Masks waiting_{};  ///< mask of the slots that wait for each sub-pipe
  /// Times at which the next ray, answer and cache line arrive. `soonest`: lower bound of the next useful arrival.
  struct Arrivals {
    sim::Time soonest = sim::kNever, rays = sim::kNever, answers = sim::kNever, lines = sim::kNever;
  } arrivals_;
  sim::Time leaf_free_at_ = 0;  ///< time at which the leaf pipe (or the shared pipe) is free
  std::uint32_t inner_turn_ = 0, stack_turn_ = 0, leaf_turn_ = 0, retire_turn_ = 0;
  const std::uint32_t box_latency_, transform_latency_;  ///< latencies in cycles, including an L1 hit
  const std::uint32_t stack_latency_;
  const StackRules stack_;
  const TrvFeatures features_;
  const TrvCode code_;       ///< the code with the TRV's features
  bool rays_moved_ = false;  ///< a ray has entered or left the input buffer in this cycle
  bool full_ = false;        ///< every slot has had a ray since time `full_since_` and visit number `full_since_visit_`
  std::vector<TraversalSlot> slots_;
  const sim::Clock clock_;
  sim::Activity<CycleReason> activity_;
  Stats stats_;
  FetchStage fetch_;
  TimingWheel<kPipes> pipes_;  ///< slots inside the pipes, by the sub-pipe that they need next

  sim::Time boxes_free_at_ = 0;  ///< time at which the box pipe is free, after a visit of several cycles
  const TreeInMemory tree_;
  Links links_;
  std::uint64_t free_;
  std::uint64_t occupied_ = 0;
  std::uint64_t at_ist_ = 0;             ///< mask of the slots that wait for the intersection unit's answer
  std::uint64_t both_children_hit_ = 0;  ///< mask of the slots in the box pipe whose visit hits both children
  /// Mask of the slots that visit a node or leaf beyond the hit, which is not in the walk; the links of these.
  std::uint64_t extra_ = 0;
  std::vector<std::uint32_t> extra_links_;
  const TrvConfig config_;
  const bool reads_parent_links_;  ///< a repeated visit begins with the parent link that names its node
  const bool reads_early_lines_;   ///< visits may read lines that are not their last
  /// Cycles of the box pipe and comparisons of a visit of a wide node, by its number of children.
  std::array<std::uint8_t, traces::kMaxWidth + 1> passes_{}, comparisons_{};
  const WideRecord* const wide_records_;  ///< records of the tree's wide nodes
  std::vector<NodeStack> node_stacks_;
  std::vector<const std::uint32_t*> begins_;  ///< start of the recorded walk of each slot's ray
  std::vector<RestartPath> paths_;            ///< for each slot's ray, the nodes to visit again after a restart
  std::vector<StackEntryOrigin> entries_;     ///< scratch space for restarts of rays
  std::vector<FarNode> far_nodes_;            ///< nodes to be prefetched in this cycle
  std::optional<NodePrefetcher> prefetcher_;
  std::uint64_t group_ = 0;       ///< mask of the rays whose line has been read and that wait for the box pipe
  bool last_group_full_ = false;  ///< the group served last was full
  std::array<Addr, 64> lines_{};  ///< line for which each ready ray waits; valid for slots of `lines_known_`
  std::uint64_t lines_known_ = 0;
  sim::Time full_since_ = 0, full_time_ = 0;
  std::uint64_t full_since_visit_ = 0;
};

}  // namespace hw
