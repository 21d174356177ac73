#pragma once
#include <cstdint>
#include <string>

#include "hw_models/memory/unit_names.h"
#include "hw_models/tni/messages.h"
#include "sim/link.h"
#include "sim/named.h"
#include "sim/unit_report.h"

namespace hw {

/// The predictor of a T&I unit looks up a node for each any-hit ray on its way to the ray dispatcher.
///
///   ray FIFO --> [one look-up a cycle, `latency` cycles] --> ray dispatcher
///
/// 1. All rays pass in order, one per cycle. Only those whose walk begins with a look-up (traces/walk.h) read the
/// table.
/// 2. A ray's outcome is counted with its look-up.
///
/// Not modelled: contents of the table. The functional half records what each look-up finds, from one table for all
/// cores (traces/accel/ray_predictor.h). Updates never delay look-ups: the table has a port for each.
class PredictorStage {
 public:
  static constexpr const char* kName = "core.tni.predictor";
  static constexpr Block kBlock = Block::kTni;
  enum class CycleReason : std::uint8_t { kStarved, kPredicting, kOutputFull, kCount };
  static constexpr auto kReasons = sim::reasons<CycleReason>({
      {CycleReason::kStarved, sim::idle_reason("starved", "no ray to look up")},
      {CycleReason::kPredicting, sim::working_reason("predicting", "a ray was looked up, or passed without look-up")},
      {CycleReason::kOutputFull, sim::waiting_reason("output_full", "a ray waits for room at the ray dispatcher")},
  });
  struct Stats {
    std::uint64_t rays = 0, look_ups = 0, predicted = 0, correct = 0, wrong = 0, updates = 0;
    static void describe(auto& s, auto&& counter) {
      counter(NAMED(s.rays), "rays passed to the ray dispatcher");
      counter(NAMED(s.look_ups), "of these, any-hit rays, which are looked up", "tni.predictor_lookup");
      counter(NAMED(s.predicted), "of these, rays for which a node was found");
      counter(NAMED(s.correct), "of these, rays blocked by a triangle below the node");
      counter(NAMED(s.wrong), "of the predicted rays, those that traverse the tree from the root afterwards");
      counter(NAMED(s.updates), "rays whose hit is stored in the table", "tni.predictor_update");
    }
  };
  struct Links {
    sim::Link<RayJob>& rays_in;
    sim::Link<RayJob>& rays_out;
  };

  /// `ideal`: the stage moves unlimited rays per cycle (ideal.tni).
  PredictorStage(bool ideal, Links links, sim::Clock clock) : clock_(clock), ideal_(ideal), links_(links) {}
  PredictorStage(const PredictorStage&) = delete;
  PredictorStage& operator=(const PredictorStage&) = delete;

  sim::Time tick(sim::Time now);
  const sim::Clock& clock() const { return clock_; }
  const Stats& stats() const { return stats_; }
  std::uint64_t retired_items() const { return stats_.rays; }
  const sim::Activity<CycleReason>& activity() const { return activity_; }
  void finish(sim::Time end) { activity_.finish(end); }
  std::string state() const;

 private:
  bool pass_ray(sim::Time now);

  const sim::Clock clock_;
  const bool ideal_;
  const Links links_;
  Stats stats_;
  sim::Activity<CycleReason> activity_;
};

}  // namespace hw
