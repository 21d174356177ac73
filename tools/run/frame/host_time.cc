#include "tools/run/frame/host_time.h"

#include <algorithm>

#include <fmt/format.h>

#include "shader_kernels/programs/full.h"
#include "sim/error.h"
#include "sim/host_clock.h"
#include "tools/run/frame/front_end.h"
#include "tools/run/frame/machine_run.h"
#include "traces/accel/bvh_tracer.h"

namespace tools {
namespace {

constexpr double kLong = 60;                       // host seconds above which a hint is printed
constexpr std::uint32_t kAcross = 24, kDown = 12;  // largest size of the test picture in pixels
constexpr std::uint32_t kOneOf = 3;                // test picture of a small frame: a third of its columns and rows
constexpr double kSlowestStep = 4e-6;              // host seconds per step; chosen: hairball at 96x64 takes 3.5 us
constexpr std::uint32_t kFewestTiles = 16, kMostTiles = 32;  // tiles simulated to measure the rate
constexpr std::uint32_t kOneTileOf = 50;                     // one tile in 50 is simulated: 2 % of a large frame

/// Returns `count` indices that are spread evenly over 0 to `all` - 1.
std::vector<std::uint32_t> evenly_spaced_indices(std::uint32_t all, std::uint32_t count) {
  std::vector<std::uint32_t> indices;
  for (std::uint64_t k = 0; k < count; ++k) {
    indices.push_back(static_cast<std::uint32_t>((2 * k + 1) * all / (2 * std::uint64_t{count})));
  }
  return indices;
}

}  // namespace

double estimate_steps(const Inputs& inputs, const kernels::ProgramSpec& spec) {
  kernels::RenderConfig few = inputs.config.render;
  const double samples = static_cast<double>(few.width) * few.height * spec.samples;
  few.width = std::clamp(few.width / kOneOf, 1U, kAcross);
  few.height = std::clamp(few.height / kOneOf, 1U, kDown);
  kernels::FullProgram program(inputs.image, inputs.camera, few, 1, inputs.frame);
  const traces::BvhTracer tracer(inputs.image);
  FrontEnd front(program, tracer, 0);
  while (const traces::TileWork* work = front.next()) front.release_work(work);
  const double looked_at = static_cast<double>(few.width) * few.height;
  return static_cast<double>(front.result().traversal_steps) / looked_at * samples;
}

bool may_take_minutes(double steps, const RunParallelism& parallelism) {
  return steps * kSlowestStep * parallelism.replicates >= kLong;
}

HostRate measure_rate(const Inputs& inputs, const kernels::ProgramSpec& spec) {
  const bool is_full = spec.kind == kernels::ProgramSpec::Kind::kFull;
  kernels::FullProgram program(inputs.image, inputs.camera, inputs.config.render, is_full ? spec.samples : 1,
                               inputs.frame);
  return measure_rate(inputs, program, traces::BvhTracer(inputs.image));
}

HostRate measure_rate(const Inputs& inputs, kernels::FrameProgram& program, const traces::Tracer& tracer) {
  const std::uint32_t tiles = program.tiles();
  const std::uint32_t played = std::min(tiles, std::clamp(tiles / kOneTileOf, kFewestTiles, kMostTiles));
  FrontEnd front(program, tracer, 0, true, evenly_spaced_indices(tiles, played));
  const auto gpu = make_gpu(inputs, program.requirements(), front);
  const double begin = sim::thread_seconds();
  run_to_end(*gpu);
  const double all = sim::thread_seconds() - begin;
  const RenderResult& rendered = front.result();
  if (rendered.traversal_steps == 0) return kUsualRate;
  const auto steps = static_cast<double>(rendered.traversal_steps);
  return {.functional = rendered.next_cpu_seconds / steps, .machine = (all - rendered.next_cpu_seconds) / steps};
}

double host_seconds_of_frame(double steps, const HostRate& rate, const RunParallelism& parallelism) {
  const std::uint32_t threads = host_threads(parallelism.threads);
  const double functional = steps * rate.functional, machine = steps * rate.machine;
  const double play = machine / std::min(threads, std::max(parallelism.slices, 1U));
  // One thread simulates the machine, the others run ahead of it.
  const double first = threads == 1 ? functional + play : std::max(functional / (threads - 1), play);
  const std::uint32_t others = std::max(parallelism.replicates, 1U) - 1;
  return first + (others + threads - 1) / threads * machine;
}

double estimate_seconds(const Inputs& inputs, const kernels::ProgramSpec& spec, const RunParallelism& parallelism) {
  const double steps = estimate_steps(inputs, spec);
  HostRate rate = kUsualRate;
  if (may_take_minutes(steps * inputs.frames(), parallelism)) {
    try {
      rate = measure_rate(inputs, spec);
    } catch (const sim::Deadlock&) {  // the run itself reports the error
    }
  }
  return host_seconds_of_frame(steps, rate, parallelism);
}

double estimate_render_seconds(const Inputs& inputs, const kernels::ProgramSpec& spec, double times,
                               std::uint32_t threads) {
  const double steps = estimate_steps(inputs, spec);
  double rate = kUsualRate.functional;
  if (may_take_minutes(steps * inputs.frames(), {})) {
    try {
      rate = measure_rate(inputs, spec).functional;
    } catch (const sim::Deadlock&) {  // ignored: this work is not simulated
    }
  }
  return times * steps * rate / host_threads(threads);
}

void print_duration_hint(double seconds, std::string_view less, Progress& progress) {
  if (seconds < kLong) return;
  progress.print_hint(fmt::format("raywatt: this may take about {:.0f} min on this host{}{}", seconds / 60,
                                  less.empty() ? "" : "; ", less));
}

}  // namespace tools
