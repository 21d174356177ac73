#include "tools/run/frame/machine_run.h"

#include <algorithm>
#include <memory>
#include <mutex>
#include <numeric>
#include <utility>
#include <vector>

#include "hw_models/dram/dram_energy.h"
#include "hw_models/machines/gpu.h"
#include "sim/engine.h"
#include "tools/host/parallel.h"
#include "tools/host/process.h"
#include "tools/run/frame/front_end.h"
#include "tools/run/frame/load_config.h"
#include "tools/run/frame/power.h"

namespace tools {

std::unique_ptr<hw::Gpu> make_gpu(const Inputs& inputs, const kernels::FrameRequirements& requirements,
                                  hw::TileSource& tiles, const hw::Perturbation& perturbation, hw::Observer* observer) {
  return make_gpu(inputs, inputs.config, requirements, tiles, perturbation, observer);
}

std::unique_ptr<hw::Gpu> make_gpu(const Inputs& inputs, const RunConfig& config,
                                  const kernels::FrameRequirements& requirements, hw::TileSource& tiles,
                                  const hw::Perturbation& perturbation, hw::Observer* observer,
                                  std::shared_ptr<const hw::ScheduledKernels> scheduled) {
  const bool dma_encodes = config.render.srgb == kernels::SrgbEncoder::kDma;
  return std::make_unique<hw::Gpu>(
      *config.gpu,
      hw::Gpu::Workload{inputs.image, inputs.parents, requirements, dma_encodes, observer, std::move(scheduled)}, tiles,
      perturbation);
}

void check_tables(const hw::Gpu& gpu, const RunConfig& config) {
  check_table_names(gpu.unit_reports(), config);
  energy_of(gpu, config);
  if (!config.area.arrays.empty()) sim::compute_area(gpu.unit_reports(), config.energy, config.area);
}

sim::EnergyReport energy_of(const hw::Gpu& gpu, const RunConfig& config) {
  return energy_of(gpu.unit_reports(), gpu.elapsed_time(), config);
}

sim::EnergyReport energy_of(std::span<const sim::UnitReport> units, sim::Time elapsed, const RunConfig& config) {
  return sim::compute_energy(units, config.energy, hw::dram_energy_events(config.gpu->dram), elapsed,
                             power_scales(config));
}

void run_to_end(hw::Gpu& gpu) {
  gpu.invalidate_first_level();
  const sim::Time last_edge = sim::run(gpu);
  if (!gpu.is_stopped()) gpu.finish(last_edge);
}

void collect_results(const hw::Gpu& gpu, const RunConfig& config, FrameResult& s) {
  s.units = gpu.unit_reports();
  s.kernel_use = gpu.kernel_use();
  s.kernels = gpu.kernel_schedules();
  s.cycles = gpu.elapsed_cycles();
  s.elapsed = gpu.elapsed_time();
  s.energy = energy_of(gpu, config);
}

namespace {

/// Simulates the recorded work of a frame on several machines concurrently.
class VariantRuns {
 public:
  VariantRuns(const Inputs& inputs, const kernels::FrameRequirements& requirements, const InMemoryTrace& work,
              const FrameResult& plain, std::span<const MachineVariant> plays, const char* what, Progress* progress)
      : inputs_(inputs),
        requirements_(requirements),
        work_(work),
        plays_(plays),
        what_(what),
        progress_(progress),
        all_(plays.size(), plain) {
    for (FrameResult& s : all_) s.rendered.rgb = {}, s.rendered.marks = {};
    begin_part();
  }

  std::vector<FrameResult> run_all(std::uint32_t threads) {
    parallel_for(all_.size(), threads, [this](std::size_t i, std::size_t) { simulate_variant(i); });
    return std::move(all_);
  }

 private:
  void simulate_variant(std::size_t i) {
    InMemoryTraceProgram program(work_, requirements_, [&] { note_finished_tile(); });
    const NoTracer no_tracer;
    FrontEnd tiles(program, no_tracer, 0);
    const RunConfig& config = plays_[i].config;
    const auto gpu = make_gpu(inputs_, config, requirements_, tiles, plays_[i].perturbation, {}, plays_[i].scheduled);
    if (plays_[i].start) {
      gpu->set_cache_contents(*plays_[i].start);
    } else if (config.frame.start == FrameStart::kWarm) {
      InMemoryTraceProgram previous(work_, requirements_, [] {});
      warm_with_last_tiles(*gpu, previous, no_tracer, 0);
    }
    run_to_end(*gpu);
    all_[i].machine = config.gpu;
    collect_results(*gpu, config, all_[i]);
  }
  void begin_part() {
    if (progress_ != nullptr) progress_->begin_part(what_, inputs_.frame, work_.tiles());
  }
  void note_finished_tile() {
    const std::lock_guard lock(mutex_);
    tiles_done_ += 1;
    if (progress_ != nullptr) progress_->set_tiles_done(tiles_done_, 0, 0);
    if (tiles_done_ < work_.tiles()) return;
    tiles_done_ = 0;
    if (++parts_done_ < all_.size()) begin_part();
  }

  const Inputs& inputs_;
  const kernels::FrameRequirements& requirements_;
  const InMemoryTrace& work_;
  const std::span<const MachineVariant> plays_;
  const char* const what_;
  Progress* const progress_;
  std::vector<FrameResult> all_;
  std::mutex mutex_;
  std::uint32_t tiles_done_ = 0, parts_done_ = 0;  ///< finished tiles of the current part (a part per machine);
                                                   ///< finished parts
};

}  // namespace

std::vector<FrameResult> simulate_variants(const Inputs& inputs, const kernels::FrameRequirements& requirements,
                                           const InMemoryTrace& work, const FrameResult& plain,
                                           std::span<const MachineVariant> plays, const char* what,
                                           std::uint32_t threads, Progress* progress) {
  return VariantRuns(inputs, requirements, work, plain, plays, what, progress).run_all(host_threads(threads));
}

std::vector<FrameResult> simulate_replicates(const Inputs& inputs, const kernels::FrameRequirements& requirements,
                                             const InMemoryTrace& work, const UnperturbedRun& plain,
                                             std::uint32_t count, std::uint32_t threads, Progress* progress) {
  std::vector<MachineVariant> plays;
  for (std::uint32_t number = 1; number <= count; ++number) {
    plays.push_back({inputs.config, hw::random_perturbation(inputs.config.gpu->cores, inputs.frame, number),
                     plain.scheduled, plain.start});
  }
  return simulate_variants(inputs, requirements, work, plain.result, plays, "replicating", threads, progress);
}

OptionalUnits optional_units_of(const RunConfig& config) {
  return {.rasterisers = config.render.primary == kernels::Primary::kRaster,
          .tree_builder = config.build.engine == traces::BuildEngine::kUnit};
}

std::vector<sim::UnitReport> idle_unit_reports(const hw::GpuConfig& config, const OptionalUnits& units,
                                               const traces::BvhConfig& bvh) {
  traces::MemoryImage nothing;
  if (bvh.is_wide()) {
    nothing.wide_nodes.resize(1);
    nothing.wide_format = bvh.node_format();
    nothing.width = bvh.width;
    nothing.child_order = bvh.order;
  }
  nothing.leaf_format = bvh.leaf;
  hw::TileSource tiles;
  // Kernels that no tile uses get no schedule: scheduling would dominate the time.
  hw::Gpu::Workload workload{
      .image = nothing, .parents = {}, .scheduled = std::make_shared<const hw::ScheduledKernels>()};
  if (units.rasterisers) workload.needs.raster = traces::RasterArraySizes{};
  if (units.tree_builder) workload.needs.build = traces::BuildArraySizes{};
  return std::make_unique<hw::Gpu>(config, workload, tiles)->unit_reports();
}

namespace {

/// View of a frame program that executes the program's tiles but does not commit the results. Throws Interrupted.
class UncommittedTiles final : public kernels::FrameProgram {
 public:
  explicit UncommittedTiles(const kernels::FrameProgram& frame) : FrameProgram(0, 0), frame_(frame) {}

  std::uint32_t tiles() const override { return frame_.tiles(); }
  kernels::FrameRequirements requirements() const override { return frame_.requirements(); }
  void run_tile(std::uint32_t tile_index, const traces::Tracer& tracer, bool record,
                kernels::TileResult& out) const override {
    if (is_interrupted()) throw Interrupted{};
    frame_.run_tile(tile_index, tracer, record, out);
  }
  void commit_tile(const kernels::TileResult& /*tile*/) override {}

 private:
  const kernels::FrameProgram& frame_;
};

bool has_one_pass(const kernels::FrameProgram& frame) { return frame.pass_end(0) == frame.tiles(); }

/// Number of tiles in the first attempt to fill the caches, and factor by which each further attempt has more tiles.
constexpr std::uint32_t kFirstTiles = 64, kMoreTiles = 4;
/// Number of L2 fills, divided by the number of lines in all shared caches, after which the lines of earlier tiles are
/// assumed to be evicted.
constexpr std::uint64_t kFillsPerLine = 2;

/// Warms the machine's caches with the tiles of a front end, which are assigned to cores round robin. Returns the
/// number of lines filled into the L2.
std::uint64_t warm_caches_from(hw::Gpu& gpu, FrontEnd& front_end) {
  std::uint64_t filled = 0;
  std::uint32_t core = 0;
  while (const traces::TileWork* work = front_end.next()) {
    filled += gpu.warm_caches(*work, core);
    core = core + 1 == gpu.core_count() ? 0 : core + 1;
    front_end.release_work(work);
  }
  return filled;
}

}  // namespace

void warm_with_last_tiles(hw::Gpu& gpu, kernels::FrameProgram& frame, const traces::Tracer& tracer,
                          std::uint32_t workers) {
  const std::uint32_t all = frame.tiles();
  if (!has_one_pass(frame)) {
    FrontEnd front_end(frame, tracer, workers);
    warm_caches_from(gpu, front_end);
    return;
  }
  const hw::CacheContents empty = gpu.cache_contents();
  for (std::uint32_t tiles = kFirstTiles;; tiles *= kMoreTiles) {
    const std::uint32_t first = all - std::min(tiles, all);
    std::vector<std::uint32_t> last(all - first);
    std::iota(last.begin(), last.end(), first);
    UncommittedTiles program(frame);
    FrontEnd front_end(program, tracer, workers, true, std::move(last));
    const std::uint64_t filled = warm_caches_from(gpu, front_end);
    if (first == 0 || filled >= kFillsPerLine * gpu.shared_line_count()) return;
    gpu.set_cache_contents(empty);
  }
}

}  // namespace tools
