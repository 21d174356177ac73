#include "tools/run/frame/machine_run.h"

#include <mutex>
#include <utility>

#include "hw_models/dram/dram_energy.h"
#include "sim/engine.h"
#include "tools/host/parallel.h"
#include "tools/run/frame/load_config.h"
#include "tools/run/frame/power.h"
#include "tools/run/frame/warm_start.h"

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

}  // namespace tools
