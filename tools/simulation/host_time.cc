#include "tools/simulation/host_time.h"

#include <algorithm>

#include <fmt/format.h>

#include "shader_kernels/programs/full.h"
#include "tools/simulation/front_end.h"
#include "traces/accel/bvh_tracer.h"
#include "traces/walk_steps.h"

namespace tools {
namespace {

constexpr std::uint32_t kAcross = 24, kDown = 12;  // pixels that are looked at
constexpr std::uint32_t kOneOf = 3;                // columns and rows of a small picture: cheap beside its run
constexpr double kSecondsPerStep = 100e-9;         // chosen: 60 to 160 ns on processors of these years
constexpr double kRecordingShare = 0.125;          // chosen: tracing and shading are 6 to 12 times cheaper than timing
constexpr double kStepsPerEnter = 10;              // chosen: a walk of 100,000 instances took 5 to 6 times its steps

}  // namespace

double host_seconds(double steps) { return steps * kSecondsPerStep; }

double estimated_host_seconds(const Inputs& inputs, const kernels::ProgramSpec& spec) {
  kernels::RenderConfig few = inputs.config.render;
  const double samples = static_cast<double>(few.width) * few.height * spec.samples;
  few.width = std::clamp(few.width / kOneOf, 1U, kAcross);
  few.height = std::clamp(few.height / kOneOf, 1U, kDown);
  kernels::FullProgram program(inputs.image, inputs.camera, few, 1, inputs.frame);
  const traces::BvhTracer tracer(inputs.image);
  FrontEnd front(program, tracer, 0);
  double steps = 0;
  while (const traces::TileWork* work = front.next()) {
    const traces::WalkSteps walks = traces::count_steps(work->walk);
    steps += static_cast<double>(walks.all()) + kStepsPerEnter * static_cast<double>(walks.enters);
    front.give_back(work);
  }
  const double looked_at = static_cast<double>(few.width) * few.height;
  return host_seconds(steps / looked_at * samples);
}

double estimated_recording_seconds(const Inputs& inputs, const kernels::ProgramSpec& spec, std::uint32_t threads) {
  return kRecordingShare * estimated_host_seconds(inputs, spec) / host_threads(threads);
}

void tell_long(double seconds, std::string_view less, Progress& progress) {
  if (seconds < 60) return;
  progress.hint(fmt::format("raywatt: this may take about {:.0f} min on this host{}{}", seconds / 60,
                            less.empty() ? "" : "; ", less));
}

}  // namespace tools
