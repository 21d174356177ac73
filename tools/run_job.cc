#include "tools/run_job.h"

#include <algorithm>
#include <memory>
#include <numeric>
#include <thread>

#include <fmt/format.h>

#include "hw_models/frame/gpu.h"
#include "hw_models/memory/dram_energy.h"
#include "shader_kernels/programs/programs.h"
#include "sim/engine.h"
#include "sim/host_clock.h"
#include "tools/interrupt.h"
#include "traces/accel/build.h"
#include "traces/accel/bvh_info.h"
#include "traces/accel/bvh_tracer.h"
#include "traces/accel/refit.h"
#include "traces/scene/bounds.h"
#include "traces/scene/workload.h"

namespace tools {

namespace {

/// Lets go of the work when the user has interrupted it.
class Interruptible final : public hw::TileSource {
 public:
  explicit Interruptible(hw::TileSource& source) : source_(source) {}
  const traces::TileWork* next() override {
    if (interrupted()) throw Interrupted{};
    return source_.next();
  }
  void give_back(const traces::TileWork* work) override { source_.give_back(work); }

 private:
  hw::TileSource& source_;
};

/// A frame program for the frame that `inputs` stand at.
struct Program {
  Program(const Inputs& inputs, const kernels::ProgramSpec& spec, const Extras& extras)
      : first(inputs.config.programs.multirate),
        frame(kernels::make_program(
            spec, {inputs.image, inputs.camera, inputs.config.render, inputs.config.programs,
                   extras.rates != nullptr ? *extras.rates : first, inputs.frame, inputs.scene_size})) {
    if (extras.marks) frame->keep_marks();
  }
  const kernels::RateMap first;
  const std::unique_ptr<kernels::FrameProgram> frame;
};

float size_in_frame_0(traces::Scene& scene, const traces::WorkloadConfig& workload) {
  if (workload.first_frame != 0) traces::pose_workload(scene, workload, 0);
  const traces::Bounds bounds = traces::world_bounds(scene);
  if (workload.first_frame != 0) traces::pose_workload(scene, workload, workload.first_frame);
  const glm::vec3 sides = bounds.upper - bounds.lower;
  return std::max({sides.x, sides.y, sides.z});
}

/// Every figure of the table must be one that some counter can use.
void check_energy(std::span<const sim::UnitReport> units, const sim::EnergyConfig& config) {
  std::vector<std::string> declared;
  for (const sim::UnitReport& unit : units) {
    for (const sim::CounterReport& counter : unit.counters) {
      if (unit.block != "dram" && !counter.event.empty()) declared.push_back(counter.event);
    }
  }
  sim::check_energy_events(config, declared);
}

}  // namespace

std::uint32_t host_threads(std::uint32_t wanted) {
  return wanted != 0 ? wanted : std::max(1U, std::thread::hardware_concurrency());
}

Inputs load_inputs(const JobOptions& options) {
  Inputs in;
  in.config = load_run_config(options);
  const sim::HostClock::time_point begin = sim::HostClock::now();
  traces::Scene scene = traces::open_workload(in.config.scene, in.config.limits);
  in.frame = in.config.scene.first_frame;
  in.scene_size = size_in_frame_0(scene, in.config.scene);
  in.camera = scene.cameras.front();
  in.scene = traces::scene_info(scene);
  in.scene_sha256 = scene.sha256;
  in.warnings = scene.warnings;
  in.image = traces::build_memory_image(scene, in.config.bvh, host_threads(options.threads));
  in.bvh_hash = traces::bvh_hash(in.image);
  in.parents = traces::parents_of(in.image);
  if (in.frames() > 1) in.moving = std::move(scene);
  in.load_seconds = sim::seconds_since(begin);
  return in;
}

void advance(Inputs& in, std::uint32_t frame, std::uint32_t threads) {
  const sim::HostClock::time_point begin = sim::HostClock::now();
  const traces::Moved moved = traces::pose_workload(in.moving, in.config.scene, frame);
  in.frame = frame;
  in.camera = in.moving.cameras.front();
  if (moved.geometry && in.config.bvh.update == traces::BvhUpdate::kRefit) {
    traces::refit_memory_image(in.moving, in.image);
  } else if (moved.geometry) {
    in.image = traces::build_memory_image(in.moving, in.config.bvh, host_threads(threads));
    in.parents = traces::parents_of(in.image);
  } else if (moved.lights) {
    in.image.lights = in.moving.lights;
  }
  in.update_seconds += sim::seconds_since(begin);
}

std::uint64_t Simulation::rays() const {
  return std::accumulate(std::begin(function.rays), std::end(function.rays), std::uint64_t{0});
}

void Simulation::add(const Simulation& frame) {
  frames += frame.frames;
  function.add(frame.function);
  sim::add_reports(units, frame.units);
  for (std::size_t k = 0; k < kernel_use.size(); ++k) kernel_use[k] += frame.kernel_use[k];
  energy += frame.energy;
  cycles += frame.cycles;
  elapsed += frame.elapsed;
  wall_seconds += frame.wall_seconds;
  if (sampled) sampled->add(*frame.sampled);
}

Simulation simulate(const Inputs& inputs, const kernels::ProgramSpec& program, std::uint32_t threads,
                    const Extras& extras) {
  const sim::HostClock::time_point begin = sim::HostClock::now();
  const Program made(inputs, program, extras);
  kernels::FrameProgram& frame = *made.frame;
  const traces::BvhTracer tracer(inputs.image);
  hw::FrontEnd front_end(frame, tracer, host_threads(threads) - 1);
  Interruptible tiles(front_end);
  const kernels::Demands demands = frame.demands();
  const auto gpu = std::make_unique<hw::Gpu>(inputs.config.gpu,
                                             hw::Gpu::Workload{inputs.image, inputs.parents, demands.tile_samples,
                                                               demands.region_bytes, demands.attribute_bytes},
                                             tiles);
  const auto energy = [&] {
    return sim::compute_energy(gpu->report(), inputs.config.energy, hw::dram_energy_events(inputs.config.gpu.dram),
                               gpu->elapsed());
  };
  check_energy(gpu->report(), inputs.config.energy);
  energy();  // a figure that is missing is told before the work, not after it
  gpu->finish(sim::run(*gpu));

  Simulation s;
  s.program = program;
  s.machine = inputs.config.gpu;
  s.function = front_end.result();
  s.units = gpu->report();
  s.kernel_use = gpu->kernel_use();
  s.kernels = gpu->kernels();
  s.cycles = gpu->cycles();
  s.elapsed = gpu->elapsed();
  s.energy = energy();
  s.wall_seconds = sim::seconds_since(begin);
  if (extras.rates != nullptr) extras.rates->advance(s.function.sampling);
  return s;
}

hw::FrontEnd::Result render(const Inputs& inputs, const kernels::ProgramSpec& program, const traces::Tracer& tracer,
                            std::uint32_t threads, const Extras& extras) {
  const Program made(inputs, program, extras);
  hw::FrontEnd front_end(*made.frame, tracer, host_threads(threads), false);
  Interruptible tiles(front_end);
  while (const traces::TileWork* work = tiles.next()) tiles.give_back(work);
  if (extras.rates != nullptr) extras.rates->advance(front_end.result().sampling);
  return front_end.result();
}

}  // namespace tools
