#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "sim/io/json.h"
#include "tools/timeline/timeline.h"

namespace tools {

/// `--timeline` of a job: records its first frame.
class TimelineJob {
 public:
  /// `asked`: as the option has it; empty: there is none. InputError if it means nothing.
  explicit TimelineJob(std::string asked);

  const std::optional<TimelineSelection>& selection() const { return selection_; }
  /// InputError if the picture of the frame that `inputs` stand at has no such tile or pixel.
  void check(const Inputs& inputs, const kernels::ProgramSpec& program) const;
  /// Returns the observer of the next frame's machine: null from the second on.
  hw::Observer* begin_frame(const RunConfig& config);
  /// The frame is over; later ones are not looked at. If it was interrupted before a tile that was asked for, there is
  /// a warning instead of a timeline: the frame is not lost.
  void end_frame(const FrameResult& s, const TileFrame& tiles, const RunConfig& config);
  /// Writes the file, and into the report what is in it and what had no room.
  void write(const std::filesystem::path& folder, sim::Json& report) const;

 private:
  const std::string asked_;
  std::optional<TimelineSelection> selection_;
  std::optional<TimelineRecorder> recorder_;
  std::optional<Timeline> made_;
  std::string problem_;  ///< why there is none
};

}  // namespace tools
