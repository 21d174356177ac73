#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "hw_models/memory/l1_cache.h"
#include "hw_models/tni/messages.h"
#include "hw_models/tni/tni_config.h"
#include "hw_models/tni/wheel.h"
#include "sim/activity.h"
#include "sim/link.h"

namespace hw {

/// What a traversal unit knows of the tree in memory: where records lie, and each node's parent (for restarts).
struct TreeInMemory {
  Addr nodes = 0;
  std::uint32_t node_bytes = 64;  ///< of a record; it may lie across two lines
  std::span<const std::uint32_t> parents;
  /// Of each inner node, the records of its two children, where a record holds a single box; empty where it holds both
  /// boxes of a node.
  std::span<const std::array<std::uint32_t, 2>> single_boxes;
  bool hybrid = false;  ///< fixed-point boxes
};

/// A traversal unit (TRV): takes independent rays through a 2-wide BVH, three sub-pipes side by side, each one
/// operation a cycle.
///
///   rays --> [input buffer: up to 64 slots] --> inner: node fetch (L1) + both boxes --+
///                   ^                       --> stack: one pop ----------------------+--> back to the buffer
///                   |                       --> leaf: to the IST, `count` cycles -----> ... answer
///                   +---- finished rays leave in any order
///
/// A ray keeps its slot until it retires. A ray whose node is not in the L1 stays in the input buffer, marked, and is
/// not pushed through the pipe; it tries again when its line has come (the buffer is reordered by the result of the
/// cache access: Lee et al. 2015, "reorder buffer"). Which of several ready rays goes first is round robin by slot.
/// A push shares the cycle of the visit that causes it (the stack RAM has one read and one write port).
/// A line that has come stays readable for the rays that waited for it, whatever is filled meanwhile: each of them
/// makes progress, however small the cache.
class Trv {
 public:
  enum class Why : std::uint8_t {
    kStarved,     ///< no ray inside
    kVisiting,    ///< a node went into the box pipe
    kL1Miss,      ///< rays wait for node lines, or this cycle's probe missed
    kMshrFull,    ///< rays wait for a free miss register
    kIst,         ///< rays wait for the intersection unit
    kPipe,        ///< rays are all inside the pipelines: too few of them to fill the latency
    kOutputFull,  ///< finished rays cannot leave
    kCount
  };
  struct Stats {
    std::uint64_t rays_in = 0, rays_out = 0;
    std::uint64_t visits = 0, restarted_visits = 0, box_tests = 0;
    std::uint64_t l1_accesses = 0, l1_hits = 0, l1_misses = 0, l1_fills = 0, mshr_full = 0;
    std::uint64_t pushes = 0, pops = 0, dropped = 0, restarts = 0, leaves = 0;
    static void describe(auto& s, auto&& counter) {
      counter(s.rays_in, "rays_in", "rays accepted into the input buffer", "tni.ray_buffer_write");
      counter(s.rays_out, "rays_out", "rays retired", "tni.ray_buffer_read");
      counter(s.visits, "visits", "nodes tested, restarts included", "tni.ray_update");
      counter(s.restarted_visits, "restarted_visits", "of these, nodes tested again after a restart");
      counter(s.box_tests, "box_tests", "child boxes tested", "tni.box_test");
      counter(s.l1_accesses, "l1_accesses", "probes of the node cache, retries included", "tni.ray_buffer_read");
      counter(s.l1_hits, "l1_hits", "probes that found the line", "cache.l1_read");
      counter(s.l1_misses, "l1_misses", "probes that did not", "cache.l1_probe");
      counter(s.l1_fills, "l1_fills", "lines filled", "cache.l1_fill");
      counter(s.mshr_full, "mshr_full", "misses that found no free miss register");
      counter(s.pushes, "pushes", "stack entries written", "tni.stack_push");
      counter(s.pops, "pops", "stack entries read", "tni.stack_pop");
      counter(s.dropped, "dropped", "stack entries dropped because the short stack was full");
      counter(s.restarts, "restarts", "restarts from the link");
      counter(s.leaves, "leaves", "leaves sent to the intersection unit", "tni.ray_route");
    }
  };
  struct Links {
    sim::Link<RayJob>& rays_in;
    sim::Link<RayDone>& rays_out;
    sim::Link<LeafJob>& leaves_out;
    sim::Link<LeafDone>& leaves_in;
    sim::Link<MemRequest>& memory_out;
    sim::Link<MemResponse>& memory_in;
  };

  Trv(const TrvConfig& config, const TreeInMemory& tree, Links links, std::uint16_t port, sim::Clock clock);
  Trv(const Trv&) = delete;
  Trv& operator=(const Trv&) = delete;

  sim::Time tick(sim::Time now);
  const sim::Clock& clock() const { return clock_; }
  const Stats& stats() const { return stats_; }
  const sim::Activity<Why>& activity() const { return activity_; }
  void finish(sim::Time end) { activity_.finish(end); }
  bool idle() const { return occupied_ == 0; }
  std::string state() const;

 private:
  /// Sub-pipes a slot can come out of.
  enum Pipe : std::size_t { kToInner, kToStack, kToLeaf, kToRetire, kPipes };
  struct Slot {
    const std::uint32_t* next = nullptr;   ///< the step to take now
    const std::uint32_t* begin = nullptr;  ///< the ray's first step
    std::uint32_t id = 0;
    std::uint32_t culls = 0;    ///< stack entries still to pop and drop before `next`
    std::uint16_t stacked = 0;  ///< entries not popped yet, dropped ones included
    std::uint16_t held = 0;     ///< of these, entries in the short stack
    bool must_pop = false;      ///< `next` is reached through the stack
    bool restarting = false;    ///< on the way back down: its nodes are in paths_
  };
  static_assert(sizeof(Slot) == 32, "two slots a cache line of the host: a tick touches little else");

  void take_rays(sim::Time now);
  void take_answers(sim::Time now);
  void take_lines(sim::Time now);
  Why issue_visit();
  void issue_pop();
  void issue_leaf(sim::Time now);
  void retire(sim::Time now);
  void visited(Slot& slot, std::uint32_t index);
  /// Which sub-pipe the slot needs for its next step.
  Pipe next_pipe(Slot& slot) const;
  void restart(Slot& slot, std::uint32_t index);
  void release(const Wheel<kPipes>::Masks& out);
  Why waiting() const;  ///< what a cycle goes to in which no node enters the box pipe
  sim::Time next_wake(sim::Time now) const;

  const TrvConfig config_;
  const sim::Clock clock_;
  const TreeInMemory tree_;
  const std::uint32_t visit_latency_;
  Links links_;
  L1Cache l1_;
  std::vector<Slot> slots_;
  std::vector<std::vector<std::uint32_t>> paths_;  ///< per slot: nodes to test again after a restart, last one first
  Wheel<kPipes> pipes_;
  std::uint64_t free_;
  std::uint64_t occupied_ = 0;
  std::uint64_t ready_ = 0, popping_ = 0, leaving_ = 0, retiring_ = 0;  ///< waiting for the sub-pipe of that name
  std::uint64_t missing_ = 0;                                           ///< waiting for a line
  std::uint64_t no_mshr_ = 0;                                           ///< waiting for a miss register
  std::uint64_t served_ = 0;                                            ///< their line has come and is kept for them
  std::uint64_t at_ist_ = 0;                                            ///< waiting for the intersection unit's answer
  std::uint32_t inner_turn_ = 0, stack_turn_ = 0, leaf_turn_ = 0, retire_turn_ = 0;
  sim::Time leaf_free_at_ = 0;
  Stats stats_;
  sim::Activity<Why> activity_;
};

constexpr std::array<std::string_view, 7> names_of(Trv::Why) {
  return {"starved", "visiting", "l1_miss", "mshr_full", "ist", "pipe", "output_full"};
}

}  // namespace hw
