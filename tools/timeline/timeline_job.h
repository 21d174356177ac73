#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "sim/io/json.h"
#include "tools/timeline/timeline.h"

namespace tools {

/// The option `--timeline` of a job: records the job's first frame.
class TimelineJob {
 public:
  /// `asked`: the option's text; empty: no timeline. Throws InputError for an invalid text.
  explicit TimelineJob(std::string asked);

  const std::optional<TimelineSelection>& tile_selection() const { return selection_; }
  /// Throws InputError if the picture of the current frame of `inputs` has no such tile or pixel.
  void check_selection(const Inputs& inputs, const kernels::ProgramSpec& program) const;
  /// Returns the observer of the next frame's machine: null from the second on.
  hw::Observer* begin_frame(const RunConfig& config);
  /// Makes the timeline of the first frame; ignores later frames. If the frame was interrupted before a selected tile,
  /// it prints a warning and makes no timeline.
  void end_frame(const FrameResult& s, const TileFrame& tiles, const RunConfig& config);
  /// Writes the file, and its numbers of shown and dropped slices into the report.
  void write_file(const std::filesystem::path& folder, sim::Json& report) const;

 private:
  const std::string asked_;
  std::optional<TimelineSelection> selection_;
  std::optional<TimelineRecorder> recorder_;
  std::optional<Timeline> made_;
  std::string problem_;  ///< why there is no timeline
};

}  // namespace tools
