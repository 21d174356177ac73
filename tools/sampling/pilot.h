#pragma once
#include <cmath>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "hw_models/memory/cache.h"
#include "hw_models/srp/schedule.h"
#include "shader_kernels/programs/full.h"
#include "tools/run/frame/run_job.h"
#include "traces/accel/memory_image.h"
#include "traces/stream.h"

namespace hw {
struct GpuConfig;
}

namespace tools {

/// Traits of a tile that predict its cost without simulating it.
struct TileTraits {
  double tiles = 0;
  double array = 0;        ///< busy cycles of the shader core's array, without pipeline fill
  double visits = 0;       ///< node visits
  double tests = 0;        ///< triangle tests
  double l1_misses = 0;    ///< misses of the first-level caches of the traversal and intersection units
  double data_misses = 0;  ///< data cache misses
  double l2_misses = 0;
  double spills = 0;  ///< ray slots needed beyond a tile's share of the tile buffer, summed over launches
  double path = 0;    ///< critical path of launches and rays in T&I cycles, if the tile is alone on the machine

  static constexpr std::size_t kCount = 9;
  static constexpr double TileTraits::*kAll[kCount] = {
      &TileTraits::tiles,       &TileTraits::array,     &TileTraits::visits, &TileTraits::tests, &TileTraits::l1_misses,
      &TileTraits::data_misses, &TileTraits::l2_misses, &TileTraits::spills, &TileTraits::path};
  void add(const TileTraits& other, double factor = 1) {
    for (const auto member : kAll) this->*member += factor * (other.*member);
  }
};

/// Predicted traits and costs of all tiles of a frame. They come from a picture in which one of every `thinning`
/// samples is rendered.
struct Pilot {
  std::vector<TileTraits> traits;  ///< traits of each tile of the frame
  std::vector<double> costs;
  double thinning = 1;
  RenderResult rendered;
};

/// Returns the side length of a tile, in samples.
std::uint32_t tile_side(const kernels::RenderConfig& render, const kernels::ProgramSpec& spec);

/// Returns the program of the pilot: one sample per square of samples, and the same number of tiles as the frame.
/// `thinning`: set to the frame's samples per sample of the pilot.
kernels::FullProgram make_pilot(const Inputs& inputs, const kernels::ProgramSpec& spec, double& thinning);

/// Returns a program that only counts work: a picture of at least a few thousand samples, with tiles of the same number
/// of samples as the frame's. `thinning`: set to the frame's samples per sample of the picture.
std::unique_ptr<kernels::FullProgram> make_counting_pilot(const Inputs& inputs, const kernels::ProgramSpec& spec,
                                                          double& thinning);

/// Returns the number of triangle tests of a ray's walk.
std::uint32_t count_tests(const std::uint32_t* walk);

/// Predicts traits and cost of every tile by executing the pilot, a picture with few samples. `requirements`: of the
/// frame.
Pilot survey_tiles(const Inputs& inputs, kernels::FrameProgram& program, double thinning,
                   const kernels::FrameRequirements& requirements, const traces::Tracer& tracer, std::uint32_t threads,
                   Progress* progress);

/// Estimates the relative host time of each tile from a picture with even fewer samples than survey_tiles() renders.
std::vector<double> estimate_costs(const Inputs& inputs, const kernels::ProgramSpec& spec, const traces::Tracer& tracer,
                                   std::uint32_t threads);

/// Returns the pilot's render result with all counts of work scaled to the frame's full number of samples.
RenderResult scale_to_frame(const Pilot& pilot, const Inputs& inputs, const kernels::ProgramSpec& spec);

inline std::uint64_t round_count(double x) { return static_cast<std::uint64_t>(std::llround(x)); }

/// Predicts the traits of tiles, in frame order, from tiles in which one of every `thinning` samples is traced. Caches
/// are modelled as tags that fill at once. Tiles are assigned to cores, and rays to traversal units, round robin.
class TilePilot {
 public:
  /// `slots`: number of ray slots in a core's tile buffer that one tile can use.
  TilePilot(const hw::GpuConfig& config, const traces::Layout& layout, std::span<const hw::KernelSchedule> kernels,
            double thinning, double slots);

  TileTraits measure_tile(const traces::TileWork& work);
  /// Returns the estimated T&I cycles of a tile on the whole machine; used to choose tiles, not as a result.
  double estimate_cost(const TileTraits& traits) const;

 private:
  struct Core {
    std::vector<hw::CacheTags> trvs;
    hw::CacheTags ist, data;
  };
  double critical_path(const traces::TileWork& work);
  double spilled_slots(const traces::TileWork& work);

  const hw::GpuConfig& config_;
  const traces::Layout& layout_;
  const std::span<const hw::KernelSchedule> kernels_;
  const double thinning_;
  const double slots_;      ///< number of ray slots that one tile can use
  const double srp_cycle_;  ///< period of the SRP clock in T&I cycles
  std::vector<Core> cores_;
  hw::CacheTags l2_;
  std::vector<std::uint32_t> steps_;  ///< traversal steps of each ray of the tile
  std::vector<double> done_;          ///< completion time of each node of the tile's work
  std::vector<double> made_;          ///< number of rays that each launch creates
};

}  // namespace tools
