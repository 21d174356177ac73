#pragma once
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "tools/run/frame/front_end.h"
#include "tools/run/frame/run_job.h"
#include "tools/sampling/pilot.h"
#include "tools/sampling/timed_tiles.h"

namespace tools {

/// Parameters of sampling (--tile-sampling, --image).
struct TileSampling {
  double share = 0.05;  ///< share of the frame's work to measure
  double target = 0;  ///< --tile-sampling auto: blocks are added until both relative half-widths are below this; 0: off
  bool full_image = true;  ///< render all tiles, including those that are not simulated
};

/// Parses "5%" or "auto", "full" or "none"; InputError otherwise.
TileSampling parse_tile_sampling(const std::string& sampling, const std::string& image);

/// Throws InputError for a program whose tiles cannot be sampled.
void check_tile_sampling(const kernels::ProgramSpec& program);

/// As simulate_frame(), but simulates some tiles and estimates the rest from them (docs/sampling.md).
FrameResult simulate_sampled(const Inputs& inputs, const kernels::ProgramSpec& program, std::uint32_t threads,
                             const TileSampling& sampling, Progress* progress = nullptr);

/// Activity of the machine during the measured part of a block.
struct MeasuredPart {
  sim::Time time = 0;
  std::vector<sim::UnitReport> units;
  std::vector<hw::KernelUse> kernels;
  TileTraits traits;  ///< traits of the work in this part
};

/// One run of a list of blocks on one machine.
struct SampledRun {
  MeasuredPart begin, end;  ///< counters of the first and last block, measured directly
  std::vector<MeasuredPart> parts;
  std::vector<sim::UnitReport> units;  ///< of the whole run
  std::vector<hw::KernelSchedule> kernels;
  sim::Time elapsed = 0;
  sim::Time cycle = 0;  ///< period of the T&I clock
  std::uint64_t timed = 0, warmed = 0;
  double warming_seconds = 0;
};

/// Simulates blocks of a frame. `traits`: traits of each tile from the pilot.
SampledRun run_blocks(const Inputs& inputs, RunTiles& source, const kernels::FrameRequirements& requirements,
                      std::span<const TimedBlock> blocks, std::span<const TileTraits> traits);

/// Returns the sums of counters over similar units by path: "core.tni.trv.counters.l1_hits". Counters that are not sums
/// are left out.
std::map<std::string, double> summed_counters(std::vector<sim::UnitReport> units);

/// Returns the weighted sum of the parts. Peaks are the largest of the simulated parts.
MeasuredPart weighted_sum(std::span<const MeasuredPart* const> parts, std::span<const double> weights,
                          const SampledRun& run);

}  // namespace tools
