#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "hw_models/frame/direct_interface_config.h"
#include "hw_models/memory/latency_sum.h"
#include "hw_models/memory/messages.h"
#include "hw_models/memory/unit_names.h"
#include "hw_models/tni/messages.h"
#include "sim/link.h"
#include "sim/named.h"
#include "sim/unit_report.h"

namespace hw {

/// A FIFO queue of one core's rays or hits (records). Records are written to a ring buffer in memory and read back in
/// order.
///
///   in --> [records of a line] --write--> ring in memory --read--> [lines read back] --> out
///
/// 1. Records are packed without gaps. A line is written when it is full. A partial line is written if it contains the
/// next record to deliver.
/// 2. A written line is read back at once, unless `depth` records are already requested or wait at the output.
/// 3. A read follows its write on the same link, so it cannot overtake the write on the way to the L2.
/// 4. The ring buffer holds up to `ring` records.
template <class Record>
class MemoryFifo {
 public:
  struct Shape {
    Addr base = 0;  ///< start address of the ring buffer, a multiple of the line size
    std::uint32_t record_bytes = 0, ring = 0, depth = 0;
    std::uint16_t client = 0;  ///< client number of this FIFO at the core's port to memory
  };
  struct Links {
    sim::Link<Record>& in;
    sim::Link<Record>& out;
    sim::Link<MemRequest>& memory_out;
    sim::Link<MemResponse>& memory_in;
  };
  struct Counts {
    std::uint64_t records = 0, written = 0, read = 0;  ///< `written` and `read`: number of lines, partial lines
                                                       ///< included
  };
  enum class Waits : std::uint8_t { kNothing, kMemory, kPort, kOutput };

  MemoryFifo(const Shape& shape, const Links& links)
      : shape_(shape), links_(links), records_(shape.ring), chunks_(max_chunks(shape)) {}

  /// Returns the size of the ring buffer in bytes, rounded up to whole lines.
  static Addr memory_bytes(const Shape& shape) { return end_of_line(Addr{shape.ring} * shape.record_bytes - 1); }

  /// Advances the FIFO by one cycle. Returns true if it accepted or delivered a record, or sent a request.
  bool tick(sim::Time now) {
    take_lines(now);
    bool moved = deliver_record(now);
    moved |= send_request(now);
    moved |= take_record(now);
    return moved;
  }

  Waits wait_state(sim::Time now) const {
    if (has_record()) return Waits::kOutput;
    if ((can_read() || can_write()) && !links_.memory_out.can_push(now)) return Waits::kPort;
    return accepted_ != delivered_ ? Waits::kMemory : Waits::kNothing;
  }

  sim::Time next_wake(sim::Time next_cycle) const {
    sim::Time at = links_.memory_in.pop_at();
    if (has_record()) at = std::min(at, links_.out.push_at());
    if (can_read() || can_write()) at = std::min(at, links_.memory_out.push_at());
    if (has_room()) at = std::min(at, links_.in.pop_at());
    return std::max(next_cycle, at);
  }

  const Counts& transfer_counts() const { return counts_; }
  std::uint64_t records_inside() const { return accepted_ - delivered_; }
  const LatencySum& latency_sum() const { return latency_; }

 private:
  struct Entry {
    Record record;
    sim::Time arrived = 0;
  };
  /// A read request to the ring buffer. `end`: end of the requested bytes, as an offset in the sequence of all records
  /// ever written.
  struct Chunk {
    Addr end = 0;
    bool has_arrived = false;
  };

  static Addr end_of_line(Addr address) { return line_of(address) + kLineBytes; }
  /// Returns the maximum number of outstanding read requests of a FIFO. The number is limited because each request ends
  /// at the end of a record or line.
  static std::size_t max_chunks(const Shape& shape) {
    return shape.depth * (std::size_t{shape.record_bytes} / kLineBytes + 2);
  }

  bool has_room() const { return accepted_ - delivered_ < shape_.ring; }
  bool has_record() const { return arrived_ >= (delivered_ + 1) * shape_.record_bytes; }
  bool can_read() const {
    return requested_ < written_ && requested_ < (delivered_ + shape_.depth) * shape_.record_bytes;
  }
  bool can_write() const {
    const Addr accepted = accepted_ * shape_.record_bytes;
    if (written_ == accepted) return false;
    return accepted >= end_of_line(written_) || written_ / shape_.record_bytes == delivered_;
  }

  void take_lines(sim::Time now) {
    while (links_.memory_in.can_pop(now)) chunks_[links_.memory_in.pop(now).tag].has_arrived = true;
    for (; first_ != last_ && chunks_[first_ % chunks_.size()].has_arrived; ++first_) {
      arrived_ = chunks_[first_ % chunks_.size()].end;
    }
  }

  bool deliver_record(sim::Time now) {
    if (!has_record() || !links_.out.can_push(now)) return false;
    const Entry& entry = records_[delivered_ % shape_.ring];
    links_.out.push(now, entry.record);
    latency_.note_departure(entry.arrived, now);
    delivered_ += 1;
    return true;
  }

  /// Sends one pending request to memory. Reads have priority over writes, because they free space in the ring buffer.
  bool send_request(sim::Time now) {
    const bool read = can_read();
    if ((!read && !can_write()) || !links_.memory_out.can_push(now)) return false;
    Addr& at = read ? requested_ : written_;
    const Addr end = std::min(end_of_line(at), read ? written_ : accepted_ * shape_.record_bytes);
    const auto first = static_cast<std::uint32_t>(at % kLineBytes / kSectorBytes);
    const auto past = static_cast<std::uint32_t>((end - 1) % kLineBytes / kSectorBytes + 1);
    MemRequest request{shape_.base + line_of(at) % memory_bytes(shape_),
                       shape_.client,
                       0,
                       !read,
                       static_cast<SectorMask>((1U << past) - (1U << first)),
                       records_[at / shape_.record_bytes % shape_.ring].record.tile};
    if (read) {
      request.tag = static_cast<std::uint16_t>(last_ % chunks_.size());
      chunks_[request.tag] = {end, false};
      last_ += 1;
    }
    links_.memory_out.push(now, request);
    at = end;
    (read ? counts_.read : counts_.written) += 1;
    return true;
  }

  bool take_record(sim::Time now) {
    if (!has_room() || !links_.in.can_pop(now)) return false;
    const sim::Time arrived = links_.in.pop_at();
    records_[accepted_ % shape_.ring] = {links_.in.pop(now), arrived};
    latency_.note_arrival(arrived);
    accepted_ += 1;
    counts_.records += 1;
    return true;
  }

  const Shape shape_;
  Links links_;
  std::vector<Entry> records_;                      ///< contents of the ring buffer, because the simulated memory
                                                    ///< stores no data
  std::vector<Chunk> chunks_;                       ///< outstanding read requests to the ring buffer, oldest first
  std::uint64_t first_ = 0, last_ = 0;              ///< numbers of the outstanding read requests: first_ to last_ - 1
  std::uint64_t accepted_ = 0, delivered_ = 0;      ///< number of records accepted and delivered so far
  Addr written_ = 0, requested_ = 0, arrived_ = 0;  ///< number of bytes written, requested and read back so far
  Counts counts_;
  LatencySum latency_;
};

/// Carries a core's rays and hits through memory if there is no direct interface between shader core (SRP) and T&I
/// unit.
///
///   SRP --> rays --> [ring of rays in memory] --> T&I unit
///   SRP <-- hits <-- [ring of hits in memory] <-- T&I unit
///
/// 1. Rays and hits are separate clients of the core's cache port; each sends one request per cycle.
/// 2. The requests bypass the first-level caches. The L2 handles writes by its write policy (l2.writes).
///
/// Not modelled: the energy of its buffers.
class MemoryInterface {
 public:
  static constexpr const char* kName = "core.memory_interface";
  static constexpr Block kBlock = Block::kInterconnect;
  enum class CycleReason : std::uint8_t { kIdle, kMoving, kMemory, kPortFull, kOutputFull, kCount };
  static constexpr auto kReasons = sim::reasons<CycleReason>({
      {CycleReason::kIdle, sim::idle_reason("idle", "nothing inside")},
      {CycleReason::kMoving,
       sim::working_reason("moving", "a record was accepted or delivered, or a request was sent")},
      {CycleReason::kMemory, sim::waiting_reason("memory", "records are being written to or read from memory")},
      {CycleReason::kPortFull, sim::waiting_reason("port_full", "a request waits for the port")},
      {CycleReason::kOutputFull, sim::waiting_reason("output_full", "a record waits for its reader")},
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
      counter(NAMED(s.ray_latency), "cycles from arrival to departure, summed over rays", "", kAtEnd);
      counter(NAMED(s.hit_latency), "cycles from arrival to departure, summed over hits", "", kAtEnd);
    }
  };
  using Rays = MemoryFifo<RayJob>;
  using Hits = MemoryFifo<RayDone>;

  /// `base`: start address of the ring buffers. `client`: number of the client for rays at the core's port. The client
  /// for hits has the next number.
  MemoryInterface(const DirectInterfaceConfig& config, Addr base, std::uint16_t client, const Rays::Links& rays,
                  const Hits::Links& hits, sim::Clock clock);
  MemoryInterface(const MemoryInterface&) = delete;
  MemoryInterface& operator=(const MemoryInterface&) = delete;

  /// Returns the size in bytes of the ring buffers for the rays and hits of one core.
  static Addr memory_bytes(const DirectInterfaceConfig& config);

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
