#pragma once
#include <optional>
#include <vector>

#include "sim/host_clock.h"
#include "tools/run/run.h"
#include "tools/sampling/frame_sample.h"

namespace tools {

/// Frame source that visits only some frames of a sequence, and estimates the totals of the sequence from them.
///
///   counts of all frames ──► clusters ──► chosen frames ──► machine ──► weighted sums, intervals
///                                              ▲                             │
///                                              └── auto: more, if too wide ──┘
class RepresentativeFrames final : public FrameSource {
 public:
  /// Counts the work of all frames and chooses the frames to simulate. Throws InputError, Interrupted.
  RepresentativeFrames(Inputs& inputs, const RunPlan& plan, std::uint32_t threads, Progress* progress);
  const Inputs& inputs() const override { return inputs_; }
  std::uint32_t frame_count() const override { return static_cast<std::uint32_t>(sample_.chosen().size()); }
  bool has_whole_frames() const override { return false; }
  bool has_reference() const override { return false; }
  FrameResult simulate(const SimulateOptions& extras) override;
  FrameResult simulate_reference(const SimulateOptions& extras) override;
  PictureError compare_pictures(const FrameResult&, const FrameResult&) override { return {}; }
  bool advance_frame() override;
  /// Replaces the sums over the simulated frames by estimates for the sequence. Throws Interrupted for a partial
  /// result.
  void complete_result(RunResult& result) const override;

 private:
  /// Goes to the first chosen frame that is not simulated; false if there is none.
  bool go_to_next_chosen();
  /// Returns the results of the chosen frames, in their order.
  std::vector<const FrameResult*> chosen_results() const;
  /// Chooses more frames if intervals are too wide; false if they are not.
  bool add_frames();
  Interval estimate_cycles() const;
  Interval estimate_energy() const;
  RepresentedFrames summarise_sample() const;
  FrameResult estimate_total() const;

  Inputs& inputs_;
  const FrameSampling sampling_;
  const std::uint32_t threads_;
  Progress* const progress_;
  const std::uint32_t first_;
  const traces::TreeBuilds first_builds_;  ///< trees that the machine builds for the first frame
  RenderedFrames frames_;
  const sim::HostClock::time_point begin_ = sim::HostClock::now();
  FrameSample sample_;
  const double counting_seconds_;
  std::uint32_t rounds_ = 1;
  std::vector<std::optional<FrameResult>> results_;  ///< for each frame of the sequence, its result if simulated
};

}  // namespace tools
