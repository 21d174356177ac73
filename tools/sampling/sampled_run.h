#pragma once
#include <map>
#include <span>
#include <string>
#include <vector>

#include "tools/run/frame/run_job.h"
#include "tools/run/frame/run_tiles.h"
#include "tools/sampling/tile_pilot.h"
#include "tools/sampling/timed_tiles.h"

namespace tools {

/// Work of the machine in a measured part of a block.
struct MeasuredPart {
  sim::Time time = 0;
  std::vector<sim::UnitReport> units;
  std::vector<hw::KernelUse> kernels;
  TileTraits traits;  ///< traits of what it worked on
};

/// One run of blocks on a machine of its own.
struct SampledRun {
  MeasuredPart begin, end;  ///< counters of the frame, or of what stood there
  std::vector<MeasuredPart> parts;
  std::vector<sim::UnitReport> units;  ///< reports of the whole run
  std::vector<hw::KernelSchedule> kernels;
  sim::Time elapsed = 0;
  sim::Time cycle = 0;  ///< cycle of the T&I clock
  std::uint64_t timed = 0, warmed = 0;
  double warming_seconds = 0;
};

/// Plays blocks of a frame. `traits`: of each of its tiles, by the pilot.
SampledRun run_blocks(const Inputs& inputs, RunTiles& source, const kernels::FrameRequirements& requirements,
                      std::span<const TimedBlock> blocks, std::span<const TileTraits> traits);

/// Counters of like units added up, by path: "core.tni.trv.counters.l1_hits". Without those that are no sums over time.
std::map<std::string, double> summed_counters(std::vector<sim::UnitReport> units);

/// The whole from its parts, each with its weight. Peaks are those of what was timed.
MeasuredPart weighted_sum(std::span<const MeasuredPart* const> parts, std::span<const double> weights,
                          const SampledRun& run);

}  // namespace tools
