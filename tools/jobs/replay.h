#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <vector>

#include "tools/jobs/outcome.h"
#include "tools/timeline/timeline_job.h"
#include "traces/trace_file/trace_reader.h"

namespace tools {

/// A replay: a trace, and the machine that plays it.
class Replay {
 public:
  /// InputError if the trace cannot be read, or does not hold what the configuration asks for.
  Replay(const std::filesystem::path& file, const JobOptions& options);
  /// The same with an effective configuration.
  Replay(const std::filesystem::path& file, const RunConfig& config);

  std::uint32_t frames() const { return static_cast<std::uint32_t>(trace_.frames().size()); }
  /// Runs of a frame program over a frame.
  std::uint32_t parts() const { return frames() * (reference_ ? 2 : 1); }
  /// Traversal steps of all parts, as the file says.
  double recorded_steps() const;
  /// As of a run; without a scene.
  const Inputs& inputs() const { return inputs_; }
  struct How {
    Progress* progress = nullptr;
    bool keep_part = false;           ///< at least the finished tiles of the first frame, or that without its reference
    bool intervals = false;           ///< what machines did over time is kept, without references
    std::uint32_t replicates = 1;     ///< plays of each frame
    bool itemised = false;            ///< what each tile took is kept
    TimelineJob* timeline = nullptr;  ///< records the first frame
  };
  /// Plays all frames, or those that an interrupt has left time for. Interrupted if nothing is kept.
  Outcome run(std::uint32_t threads, const How& how);

 private:
  Replay(const std::filesystem::path& file,
         const std::function<RunConfig(const traces::Json& header, const std::string& name)>& config);
  const traces::TraceReader::Part& part(std::uint32_t frame, bool reference) const;
  Simulation play(const traces::TraceReader::Part& part, const kernels::ProgramSpec& program, std::uint32_t threads,
                  const How& how, sim::Intervals* intervals = nullptr);
  void load_tree(const traces::TraceReader::Part& part);

  traces::TraceReader trace_;
  Inputs inputs_;
  kernels::ProgramSpec program_;
  std::optional<kernels::ProgramSpec> reference_;
  std::vector<traces::KernelId> kernels_;  ///< this program's, by number in the trace
  std::optional<std::size_t> tree_;        ///< the one that is loaded
  traces::TileScope scope_;
};

}  // namespace tools
