#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "sim/io/json.h"
#include "tools/analysis/report.h"
#include "tools/intervals/interval_file.h"
#include "tools/tiles/tile_table.h"

namespace tools {

/// Sums over the frames of a run.
struct RunResult {
  std::optional<FrameResult> total, reference;
  double squared_error = 0;  ///< sum over frames
  sim::Json frames = sim::Json::array();
  IntervalPacker intervals;
  sim::Json reference_frames = sim::Json::array();
  bool partial = false;
  std::string lacks;  ///< what an interrupt left out: "its replicates"
  TileTable tiles;    ///< tiles of the itemised frames

  /// Adds a frame and its reference, if any. `error`: mean squared difference of their pictures.
  void add(std::uint32_t number, FrameResult frame, std::optional<FrameResult> compared, double error,
           const sim::Intervals* over_time = nullptr);
  Result totals() const;
  /// Sets `partial` and `lacks` for a frame that should have `replicates` simulations and may lack its reference.
  void set_partial(const FrameResult& frame, std::uint32_t replicates, bool lacks_reference);
  /// Describes what an interrupted run of `all` frames has kept.
  std::string kept(std::size_t all) const;
};

/// Number of frames that an interrupted run needs to replace the result in this report.json or verify.json: as many as
/// a partial result has, more than a complete one has. 1 if there is no result.
std::size_t frames_to_replace(const std::filesystem::path& file);

/// Prints the `warnings` of a report to stderr, without the first `told`.
void tell_warnings(const sim::Json& report, std::size_t told);

/// Writes report.json, report.txt, config.yaml and, if present, intervals and tiles.json to a folder.
void write_report(const std::filesystem::path& folder, const sim::Json& json, const RunConfig& config,
                  const RunResult& result);

/// Inputs and options of a run.
struct Origin {
  const Inputs& inputs;
  const JobOptions& options;
};

/// Writes the report of the reference next to that of the run, if there is a reference.
void write_reference(const std::filesystem::path& folder, const Origin& origin, const RunResult& result);

/// Prints the location of the reference's report and the command that compares both.
void tell_reference(const std::filesystem::path& folder);

}  // namespace tools
