#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "hw_models/memory/messages.h"
#include "hw_models/memory/unit_names.h"
#include "hw_models/tni/messages.h"
#include "hw_models/tni/sort_window.h"
#include "hw_models/tni/tni_config.h"
#include "sim/link.h"
#include "sim/named.h"
#include "sim/unit_report.h"

namespace hw {

/// The ray dispatcher of a T&I unit distributes rays to the traversal units (TRVs) and collects finished rays from
/// them.
///
///   ray FIFO --> [one ray a cycle] --> TRV with the emptiest input buffer, or the next one that has room
///   hit FIFO <-- [one hit every `hit_interval` cycles] <-- TRVs, round robin
///
/// 1. The dispatcher tracks the number of rays in each TRV by counting the rays sent to and returned by the TRV.
/// 2. With a window (sort_window.h) one ray per cycle enters the window, and the window's next ray is sent in a later
/// cycle. The window fills while no TRV has room.
class RayDispatcher {
 public:
  static constexpr const char* kName = "core.tni.dispatcher";
  static constexpr Block kBlock = Block::kTni;
  enum class CycleReason : std::uint8_t { kStarved, kDispatching, kTrvsFull, kCount };
  static constexpr auto kReasons = sim::reasons<CycleReason>({
      {CycleReason::kStarved, sim::idle_reason("starved", "no ray to dispatch")},
      {CycleReason::kDispatching, sim::working_reason("dispatching", "a ray was sent to a TRV, or a hit was returned")},
      {CycleReason::kTrvsFull, sim::waiting_reason("trvs_full", "no TRV has room for the waiting ray")},
  });
  struct Stats {
    std::uint64_t rays_in = 0, hits_out = 0;
    bool sorts = true;  ///< counters of the window are reported
    std::uint64_t window_writes = 0, window_reads = 0, key_moves = 0, timed_out = 0;
    static void describe(auto& s, auto&& counter) {
      counter(NAMED(s.rays_in), "rays dispatched", "tni.ray_setup");
      counter(NAMED(s.hits_out), "hits returned to the shader core", "tni.hit_route");
      if (!s.sorts) return;
      counter(NAMED(s.window_writes), "rays written to the sorted window", "tni.ray_buffer_write");
      counter(NAMED(s.window_reads), "rays read from the sorted window", "tni.ray_buffer_read");
      counter(NAMED(s.key_moves), "keys of the window moved by insertions and removals", "tni.order_compare");
      counter(NAMED(s.timed_out), "rays sent first because of their wait in the window");
    }
  };
  struct Links {
    sim::Link<RayJob>& rays_in;
    sim::Link<RayDone>& hits_out;
    std::vector<sim::Link<RayJob>*> to_trv;
    std::vector<sim::Link<RayDone>*> from_trv;
  };

  struct Policy {
    Dispatch dispatch = Dispatch::kEmptiest;
    std::uint32_t rays_per_trv = 0;  ///< capacity of the input buffer of a traversal unit (TRV)
    std::uint32_t hit_interval = 1;  ///< minimum cycles from one returned hit to the next
    bool ideal = false;              ///< the dispatcher moves unlimited rays and hits per cycle (ideal.tni)
    DispatcherConfig config;
  };

  RayDispatcher(const Policy& policy, Links links, sim::Clock clock);
  RayDispatcher(const RayDispatcher&) = delete;
  RayDispatcher& operator=(const RayDispatcher&) = delete;

  sim::Time tick(sim::Time now);
  const sim::Clock& clock() const { return clock_; }
  const Stats& stats() const { return stats_; }
  const sim::Activity<CycleReason>& activity() const { return activity_; }
  void finish(sim::Time end) { activity_.finish(end); }
  bool idle() const { return stats_.rays_in == stats_.hits_out && !has_rays_in_window(); }
  std::string state() const;

 private:
  bool dispatch_ray(sim::Time now);
  /// Takes a ray, which must have a sort key, into the window.
  bool take_into_window(sim::Time now);
  bool has_rays_in_window() const { return window_ && !window_->is_empty(); }
  /// True if a ray could be sent at time `at` if a TRV had room.
  bool has_ray(sim::Time at) const { return window_ ? !window_->is_empty() : rays_in_.can_pop(at); }
  RayJob next_ray(sim::Time now);
  bool collect_hit(sim::Time now);
  std::size_t emptiest_trv() const;
  /// Returns the TRV that can accept a ray soonest from time `at` on; the next in round-robin order among equals.
  std::size_t next_trv_in_turn(sim::Time at) const;
  std::size_t chosen_trv(sim::Time at) const;
  sim::Time next_wake(sim::Time now) const;

  const sim::Clock clock_;
  const Policy policy_;
  sim::Link<RayJob>& rays_in_;
  sim::Link<RayDone>& hits_out_;
  const std::vector<sim::Link<RayJob>*> to_trv_;
  const sim::Inputs<RayDone> from_trv_;
  Arbiter collects_;
  std::vector<std::uint32_t> load_;  ///< number of rays inside each traversal unit (TRV)
  std::size_t turn_ = 0;             ///< next traversal unit (TRV) in round-robin order
  sim::Time collect_at_ = 0;
  std::optional<SortWindow> window_;
  Stats stats_;
  sim::Activity<CycleReason> activity_;
};

}  // namespace hw
