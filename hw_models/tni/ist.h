#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "hw_models/memory/messages.h"
#include "hw_models/memory/unit_names.h"
#include "hw_models/tni/fetch_stage.h"
#include "hw_models/tni/leaf_prefetcher.h"
#include "hw_models/tni/messages.h"
#include "hw_models/tni/timing_wheel.h"
#include "hw_models/tni/tni_config.h"
#include "hw_models/tni/tree_in_memory.h"
#include "sim/link.h"
#include "sim/named.h"
#include "sim/unit_report.h"

namespace hw {

/// The intersection unit (IST) of a T&I unit tests the triangles of leaves and reads one line per cycle.
///
///   leaves of all TRVs --> [input buffer] --> triangle fetch (L1) --> distance | edges | hit --> answers
///
/// 1. A triangle test has three phases and ends with the phase that fails. Later phases take no time and energy (T&I
/// engine, 2011).
/// 2. A triangle that straddles two lines takes two L1 accesses.
/// 3. The tests of a leaf's triangles are pipelined. The answer is sent when all results are known.
/// 4. Leaves are served round robin by slot.
/// 5. The triangles of a record of several, a pair or a block, are tested one per cycle after its last line. A triangle
/// decoded from a block takes `decode_interval` cycles, in which no other test and no read begins.
///
/// With tni.trv.prefetch: stack or treelet, a LeafPrefetcher prefetches triangles on behalf of traversal units.
///
/// Not modelled: tests that end early because of a hit in another triangle of the leaf.
class Ist {
 public:
  static constexpr const char* kName = "core.tni.ist";
  static constexpr Block kBlock = Block::kTni;
  enum class CycleReason : std::uint8_t {
    kStarved,
    kTesting,
    kL1Miss,
    kMshrFull,
    kPipe,
    kOutputFull,
    kRauFull,
    kCount
  };
  static constexpr auto kReasons = sim::reasons<CycleReason>({
      {CycleReason::kStarved, sim::idle_reason("starved", "no leaf inside")},
      {CycleReason::kTesting,
       sim::working_reason("testing", "a triangle test began, or a leaf waited for the decoder of blocks")},
      {CycleReason::kL1Miss, sim::waiting_reason("l1_miss", "leaves wait for triangle lines")},
      {CycleReason::kMshrFull, sim::waiting_reason("mshr_full", "leaves wait for a free MSHR")},
      {CycleReason::kPipe, sim::working_reason("pipe", "leaves are all inside the pipeline")},
      {CycleReason::kOutputFull, sim::waiting_reason("output_full", "answers wait for room at their TRV")},
      {CycleReason::kRauFull,
       sim::waiting_reason("rau_full",
                           "a leaf stalls the fetch stage because the table of waiting rays is full (rau)")},
  });
  struct Stats : FetchStats {
    std::uint64_t leaves_in = 0, leaves_out = 0;
    std::uint64_t tests = 0, edge_tests = 0, hits = 0, bypass_passes = 0;
    std::uint64_t shared_tests = 0, decoded = 0;
    bool has_prefetcher = true;  ///< counters of the prefetcher are reported
    std::uint64_t prefetch_probes = 0, prefetches = 0;
    std::uint64_t prefetches_useful = 0, prefetches_late = 0, prefetches_useless = 0;
    static void describe(auto& s, auto&& counter) {
      counter(NAMED(s.leaves_in), "leaves accepted into the input buffer", "tni.ray_buffer_write");
      counter(NAMED(s.leaves_out), "leaves answered", "tni.hit_route");
      counter(NAMED(s.tests), "triangles tested (distance phase)", "tni.tri_phase1");
      counter(NAMED(s.shared_tests), "of these, tests whose record had been read for the triangle before");
      counter(NAMED(s.decoded), "of the tests, those of triangles decoded from a block", "tni.block_decode");
      counter(NAMED(s.edge_tests), "of the tests, those that reached the barycentric phase", "tni.tri_phase2");
      counter(NAMED(s.hits), "of these, tests that reached the hit phase", "tni.tri_phase3");
      FetchStats::describe(s, counter);
      counter(NAMED(s.bypass_passes), "passes of a leaf that missed through the pipe, without work",
              "tni.tri_bypass_pass");
      if (s.has_prefetcher) {
        counter(NAMED(s.prefetch_probes), "lines probed for prefetching", "cache.l1_probe");
        counter(NAMED(s.prefetches), "of these, lines requested from memory");
        counter(NAMED(s.prefetches_useful), "prefetched lines read after they arrived");
        counter(NAMED(s.prefetches_late), "prefetched lines needed before they arrived");
        counter(NAMED(s.prefetches_useless), "prefetched lines evicted before they were needed");
      }
    }
  };
  struct Links {
    std::vector<sim::Link<LeafJob>*> leaves_in;  ///< link from each traversal unit (TRV)
    std::vector<sim::Link<LeafDone>*> leaves_out;
    sim::Link<MemRequest>& memory_out;
    sim::Link<MemResponse>& memory_in;
    std::vector<sim::Link<LeafPrefetch>*> prefetches_in{};  ///< link from each TRV that prefetches leaves
  };

  Ist(const IstConfig& config, const TniMode& mode, const TrianglesInMemory& triangles, Links links,
      std::uint16_t client, sim::Clock clock);
  Ist(const Ist&) = delete;
  Ist& operator=(const Ist&) = delete;

  sim::Time tick(sim::Time now) { return tick(Cycle(now, clock_)); }
  sim::Time tick(const Cycle& cycle);
  const sim::Clock& clock() const { return clock_; }
  Stats stats() const;
  std::uint64_t retired_items() const { return stats_.tests + stats_.leaves_out; }
  const sim::Activity<CycleReason>& activity() const { return activity_; }
  void finish(sim::Time end) { activity_.finish(end); }
  bool idle() const {
    return occupied_ == 0 && !fetch_.waits_for_memory() && (!prefetcher_ || prefetcher_->is_empty());
  }
  std::string state() const;
  bool warm_line(Addr line) { return fetch_.warm_line(line); }
  const CacheTags& l1_tags() const { return fetch_.l1_tags(); }
  void set_l1_tags(const CacheTags& tags) { fetch_.set_l1_tags(tags); }
  std::size_t clear_l1() { return fetch_.clear_l1(); }

 private:
  struct Slot {
    LeafJob job;
    std::uint32_t trv = 0;
    std::uint32_t tested = 0;    ///< triangles of the leaf that have been fetched completely
    std::uint32_t lines = 0;     ///< lines read of the next triangle's record
    std::uint64_t known_at = 0;  ///< cycle in which the results of all tests issued so far are known
  };

  enum Pipe : std::size_t { kToAnswer, kToFetch, kPipes };

  bool fill_arrived_line(const Cycle& cycle);
  bool take_leaf(sim::Time now);
  std::uint64_t issuable_slot_mask() const;
  CycleReason issue_tests(std::uint64_t cycle);
  CycleReason issue_test(std::uint64_t ready_slots, std::uint64_t cycle);
  /// Does what issue_test() does, for records with several triangles or in another order than the triangles' numbers.
  CycleReason issue_record_test(std::uint64_t ready_slots, std::uint64_t cycle);
  CycleReason handle_miss(FetchStage::Wait wait, std::uint32_t index, std::uint64_t cycle);
  void complete_fetch(Slot& slot, std::uint32_t index, bool last_line, std::uint64_t cycle);
  bool send_answer(sim::Time now);
  CycleReason wait_reason() const;
  sim::Time next_wake(const Cycle& cycle) const;

  const IstConfig config_;
  const sim::Clock clock_;
  const TrianglesInMemory triangles_;
  const bool ideal_;     ///< the intersection unit does unlimited operations per cycle
  const bool reorders_;  ///< miss handling is `reorder`, the L1 is not ideal, and no prefetches are counted
  /// Cycles from the fetch of a triangle to the result of its test, by the phase (1 to 3) with which the test ends.
  const std::array<std::uint32_t, 4> known_after_;
  const bool has_records_;             ///< records have several triangles or another order than the triangles
  std::uint64_t decoder_free_at_ = 0;  ///< first cycle in which the block decoder is free again
  sim::Time line_at_ = sim::kNever;    ///< time at which the next line from memory arrives
  const std::vector<sim::Link<LeafDone>*> leaves_out_;
  const sim::Inputs<LeafJob> leaves_in_;
  sim::Link<MemRequest>& memory_out_;
  sim::Link<MemResponse>& memory_in_;
  Arbiter sources_;
  Stats stats_;
  /// Mask of the IST's slots with an answer to send, and mask of the slots that need to read a line.
  TimingWheel<kPipes>::Masks waiting_{};
  FetchStage fetch_;
  std::vector<Slot> slots_;
  std::optional<LeafPrefetcher> prefetcher_;
  TimingWheel<kPipes> pipe_;
  std::uint64_t free_;
  std::uint64_t occupied_ = 0;
  std::uint32_t turn_ = 0, answer_turn_ = 0;
  sim::Activity<CycleReason> activity_;
};

}  // namespace hw
