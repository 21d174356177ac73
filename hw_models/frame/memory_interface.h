#pragma once
#include <cstdint>
#include <string>

#include "hw_models/frame/direct_interface_config.h"
#include "hw_models/frame/record_stream.h"
#include "hw_models/memory/unit_names.h"
#include "hw_models/tni/messages.h"
#include "sim/activity.h"
#include "sim/counter_kind.h"
#include "sim/link.h"
#include "sim/named.h"

namespace hw {

/// Replacement of the direct interface when that is off: rays and hits of a core travel through memory.
///
///   SRP --> rays --> [ring of rays in memory] --> T&I unit
///   SRP <-- hits <-- [ring of hits in memory] <-- T&I unit
///
/// Each direction is a client of the core's cache port of its own and does one request a cycle; there is no
/// first-level cache on its way, and what the L2 does with the writes is its matter (l2.writes).
/// Not modelled: the energy of its own buffers, which are those of the direct interface.
class MemoryInterface {
 public:
  static constexpr const char* kName = "core.memory_interface";
  static constexpr Block kBlock = Block::kInterconnect;
  enum class CycleReason : std::uint8_t { kIdle, kMoving, kMemory, kPortFull, kOutputFull, kCount };
  static constexpr auto kReasons = sim::reasons<CycleReason>({
      {CycleReason::kIdle, sim::idle("idle", "nothing inside")},
      {CycleReason::kMoving, sim::working("moving", "a record came or went, or a request left")},
      {CycleReason::kMemory, sim::waiting("memory", "records are on their way through memory")},
      {CycleReason::kPortFull, sim::waiting("port_full", "a request waits for the port")},
      {CycleReason::kOutputFull, sim::waiting("output_full", "a record waits for its reader")},
  });
  struct Stats {
    std::uint64_t rays = 0, hits = 0;
    std::uint64_t ray_writes = 0, ray_reads = 0, hit_writes = 0, hit_reads = 0;
    std::uint64_t ray_latency = 0, hit_latency = 0;
    static void describe(auto& s, auto&& counter) {
      constexpr auto kAtEnd = sim::CounterKind::kAtEnd;
      counter(NAMED(s.rays), "rays that went through memory", "", kAtEnd);
      counter(NAMED(s.hits), "hits that went through memory", "", kAtEnd);
      counter(NAMED(s.ray_writes), "lines or parts of lines of rays written", "", kAtEnd);
      counter(NAMED(s.ray_reads), "lines or parts of lines of rays read", "", kAtEnd);
      counter(NAMED(s.hit_writes), "lines or parts of lines of hits written", "", kAtEnd);
      counter(NAMED(s.hit_reads), "lines or parts of lines of hits read", "", kAtEnd);
      counter(NAMED(s.ray_latency), "cycles from a ray's arrival until it leaves, of all rays together", "", kAtEnd);
      counter(NAMED(s.hit_latency), "the same for hits", "", kAtEnd);
    }
  };
  using Rays = RecordStream<RayJob>;
  using Hits = RecordStream<RayDone>;

  /// `base`: of the memory set aside; `port`: number of the rays as a client, the hits' is the next.
  MemoryInterface(const DirectInterfaceConfig& config, Addr base, std::uint16_t port, const Rays::Links& rays,
                  const Hits::Links& hits, sim::Clock clock);
  MemoryInterface(const MemoryInterface&) = delete;
  MemoryInterface& operator=(const MemoryInterface&) = delete;

  /// Memory that it needs, in bytes.
  static Addr bytes_of(const DirectInterfaceConfig& config);

  sim::Time tick(sim::Time now);
  const sim::Clock& clock() const { return clock_; }
  const Stats& stats() const { return stats_; }
  const sim::Activity<CycleReason>& activity() const { return activity_; }
  void finish(sim::Time end);
  std::string state() const;

 private:
  const sim::Clock clock_;
  Rays rays_;
  Hits hits_;
  Stats stats_;
  sim::Activity<CycleReason> activity_;
};

}  // namespace hw
