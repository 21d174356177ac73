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

/// The frames of a run added up.
struct RunResult {
  std::optional<FrameResult> total, reference;
  double squared_error = 0;  ///< sum over frames
  sim::Json frames = sim::Json::array();
  IntervalPacker intervals;
  sim::Json reference_frames = sim::Json::array();
  bool partial = false;
  std::string lacks;  ///< parts that an interrupt has left out, in words: "its replicates"
  TileTable tiles;    ///< those of frames that were itemised

  /// Adds a frame, and what it is compared with, if anything: `error` is their pictures' mean squared difference.
  void add(std::uint32_t number, FrameResult frame, std::optional<FrameResult> compared, double error,
           const sim::Intervals* over_time = nullptr);
  Result totals() const;
  /// Sets `partial` and `lacks` by a frame that should have `replicates` plays and may lack its reference.
  void set_partial(const FrameResult& frame, std::uint32_t replicates, bool lacks_reference);
  /// Part that an interrupted run has kept, in words; `all` frames were wanted.
  std::string kept(std::size_t all) const;
};

/// Frames that interrupted work must have to take the place of what this report.json or verify.json tells of: no fewer
/// than unfinished work has, more than finished work. 1 if there is none.
std::size_t frames_to_replace(const std::filesystem::path& file);

/// Says on standard error what stands in `warnings` of a report behind the first `told`.
void tell_warnings(const sim::Json& report, std::size_t told);

/// Writes report.json, report.txt, config.yaml and, where there are any, intervals and tiles.json into a folder.
void write_report(const std::filesystem::path& folder, const sim::Json& json, const RunConfig& config,
                  const RunResult& result);

/// Inputs and options of a run.
struct Origin {
  const Inputs& inputs;
  const JobOptions& options;
};

/// Writes the reference's own report beside that of the run, if there is a reference.
void write_reference(const std::filesystem::path& folder, const Origin& origin, const RunResult& result);

/// Says where it is, and how the two are compared.
void tell_reference(const std::filesystem::path& folder);

}  // namespace tools
