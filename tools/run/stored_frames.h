#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "tools/run/run.h"
#include "traces/trace_file/trace_reader.h"

namespace tools {

/// Frames read from a trace. Only the machine is simulated; there are no pictures.
class StoredFrames final : public FrameSource {
 public:
  /// Throws InputError if the trace cannot be read or does not fit the configuration.
  StoredFrames(const std::filesystem::path& file, const JobOptions& options);
  /// Opens a trace and simulates each frame `replicates` times. Takes a complete configuration, not command-line
  /// options.
  /// With `sampling`, only samples of the tiles are simulated; the trace must have pilots (record_sampled_work()).
  StoredFrames(const std::filesystem::path& file, const RunConfig& config, std::uint32_t threads,
               std::uint32_t replicates, const std::optional<TileSampling>& sampling = {});

  std::uint32_t frame_count() const override { return static_cast<std::uint32_t>(trace_.frames().size()); }
  /// Estimates the host time to simulate all frames, in seconds. For a long trace it first simulates a few tiles to
  /// measure the speed.
  double estimate_seconds();

  const Inputs& inputs() const override { return inputs_; }
  bool has_whole_frames() const override { return !sampling_; }
  bool has_reference() const override { return reference_.has_value(); }
  std::uint32_t replicates() const override { return replicates_; }
  FrameResult simulate(const SimulateOptions& extras) override;
  FrameResult simulate_reference(const SimulateOptions& extras) override;
  PictureError compare_pictures(const FrameResult& frame, const FrameResult& reference) override;
  bool advance_frame() override;
  /// Goes back to the first frame of the trace.
  void go_to_first_frame() { read_frame(0), caches_ = reference_caches_ = {}; }

 private:
  StoredFrames(const std::filesystem::path& file,
               const std::function<RunConfig(const traces::Json& header, const std::string& name)>& config,
               std::uint32_t threads, std::uint32_t replicates, const std::optional<TileSampling>& sampling = {});
  /// Returns the number of traversal steps in the trace, over all frames and reference frames.
  double recorded_steps() const;
  void read_frame(std::size_t index);
  using Caches = std::shared_ptr<const hw::CacheContents>;
  const traces::TraceReader::Part& find_part(bool reference, bool pilot = false) const;
  FrameResult simulate_samples();
  /// Simulates a part of the trace: a frame or its reference. `caches`: contents of the caches at its start; replaced
  /// by those at its end.
  FrameResult simulate_part(const traces::TraceReader::Part& part, const kernels::ProgramSpec& program,
                            const SimulateOptions& extras, Caches& caches);
  void load_tree(const traces::TraceReader::Part& part);

  traces::TraceReader trace_;
  Inputs inputs_;
  kernels::ProgramSpec program_;
  std::optional<kernels::ProgramSpec> reference_;
  const std::uint32_t threads_, replicates_;
  const std::optional<TileSampling> sampling_;
  std::size_t index_ = 0;                  ///< index of the current frame in the trace
  PictureError error_;                     ///< error of the current frame's picture
  std::vector<traces::KernelId> kernels_;  ///< kernel of this build for each kernel number in the trace
  std::optional<std::size_t> tree_;        ///< index of the loaded BVH in the trace; none before the first frame
  traces::TileScope scope_;
  Caches caches_, reference_caches_;  ///< contents of the caches after the last frame
};

}  // namespace tools
