#include "tools/run_job.h"

#include <algorithm>
#include <charconv>
#include <chrono>
#include <memory>
#include <numeric>
#include <thread>

#include <fmt/format.h>

#include "hw_models/frame/gpu.h"
#include "hw_models/memory/dram_energy.h"
#include "shader_kernels/programs/full.h"
#include "sim/config/config.h"
#include "sim/engine.h"
#include "sim/io/printable.h"
#include "tools/paths.h"
#include "traces/accel/build.h"
#include "traces/accel/bvh_tracer.h"
#include "traces/scene/did_you_mean.h"
#include "traces/scene/library.h"

namespace tools {

namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point begin) { return std::chrono::duration<double>(Clock::now() - begin).count(); }

traces::Camera choose_camera(const traces::Scene& scene, const std::string& wanted) {
  if (wanted.empty()) return scene.cameras.front();
  std::vector<std::string> names;
  for (const traces::Camera& camera : scene.cameras) {
    if (camera.name == wanted) return camera;
    names.push_back(camera.name);
  }
  std::size_t index = 0;
  const char* end = wanted.data() + wanted.size();
  const auto [rest, error] = std::from_chars(wanted.data(), end, index);
  if (error == std::errc{} && rest == end && index < scene.cameras.size()) return scene.cameras[index];
  std::string known;
  for (std::size_t i = 0; i < names.size(); ++i) known += fmt::format("{}{} '{}'", i == 0 ? "" : ", ", i, names[i]);
  throw sim::InputError(fmt::format("scene {} has no camera '{}'{}; it has: {}", scene.name, sim::printable(wanted),
                                    traces::did_you_mean(wanted, names), known));
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

RunConfig load_run_config(const JobOptions& options) {
  sim::set_config_search_path(config_folders());
  std::vector<std::string> sets = options.sets;
  if (!options.resolution.empty()) {
    const Resolution r = parse_resolution(options.resolution);
    sets.push_back(fmt::format("render.width={}", r.width));
    sets.push_back(fmt::format("render.height={}", r.height));
  }
  const std::filesystem::path file = find_config(options.config);
  RunConfig config = sim::load_config<RunConfig>(file, sets);
  if (config.energy.events.empty()) {
    throw sim::InputError(
        fmt::format("{}: energy: no figures; a file that lists only what differs begins with a line "
                    "such as 'extends: sgrt-2016'",
                    file.string()));
  }
  return config;
}

Inputs load_inputs(const JobOptions& options) {
  Inputs in;
  in.config = load_run_config(options);
  const Clock::time_point begin = Clock::now();
  const traces::Scene scene = traces::open_scene(options.scene);
  in.camera = choose_camera(scene, options.camera);
  in.scene = traces::scene_info(scene);
  in.scene_sha256 = scene.sha256;
  in.warnings = scene.warnings;
  in.image = traces::build_memory_image(scene, in.config.bvh, host_threads(options.threads));
  in.parents = traces::parents_of(in.image);
  in.load_seconds = seconds_since(begin);
  return in;
}

std::uint64_t Simulation::rays() const {
  return std::accumulate(std::begin(function.rays), std::end(function.rays), std::uint64_t{0});
}

Simulation simulate(const Inputs& inputs, const kernels::ProgramSpec& program, std::uint32_t threads) {
  const Clock::time_point begin = Clock::now();
  const kernels::FullProgram frame(inputs.image, inputs.camera, inputs.config.render, program.samples, 0);
  const traces::BvhTracer tracer(inputs.image);
  hw::FrontEnd front_end(frame, tracer, host_threads(threads) - 1);
  const std::uint32_t tile_bytes = frame.tile_pixels() * hw::kPixelBytes;
  const auto gpu = std::make_unique<hw::Gpu>(inputs.config.gpu,
                                             hw::Gpu::Workload{inputs.image, inputs.parents, frame.tile_samples(),
                                                               tile_bytes, std::uint64_t{frame.tiles()} * tile_bytes},
                                             front_end);
  const auto energy = [&] {
    return sim::compute_energy(gpu->report(), inputs.config.energy, hw::dram_energy_events(inputs.config.gpu.dram),
                               gpu->elapsed());
  };
  check_energy(gpu->report(), inputs.config.energy);
  energy();  // a figure that is missing is told before the work, not after it
  gpu->finish(sim::run(*gpu));

  Simulation s;
  s.program = program;
  s.function = front_end.result();
  s.units = gpu->report();
  s.kernel_use = gpu->kernel_use();
  s.kernels = gpu->kernels();
  s.cycles = gpu->cycles();
  s.elapsed = gpu->elapsed();
  s.energy = energy();
  s.wall_seconds = seconds_since(begin);
  return s;
}

hw::FrontEnd::Result render(const Inputs& inputs, const kernels::ProgramSpec& program, const traces::Tracer& tracer,
                            std::uint32_t threads) {
  const kernels::FullProgram frame(inputs.image, inputs.camera, inputs.config.render, program.samples, 0);
  hw::FrontEnd front_end(frame, tracer, host_threads(threads), false);
  while (const traces::TileWork* work = front_end.next()) front_end.give_back(work);
  return front_end.result();
}

}  // namespace tools
