#include "tools/simulation/host_time.h"

#include <algorithm>

#include "shader_kernels/programs/full.h"
#include "tools/simulation/front_end.h"
#include "traces/accel/bvh_tracer.h"

namespace tools {
namespace {

constexpr std::uint32_t kAcross = 24, kDown = 12;  // pixels that are looked at
constexpr double kSecondsPerStep = 100e-9;         // chosen: 60 to 160 ns on processors of these years

}  // namespace

double estimated_host_seconds(const Inputs& inputs, const kernels::ProgramSpec& spec) {
  kernels::RenderConfig few = inputs.config.render;
  const double samples = static_cast<double>(few.width) * few.height * spec.samples;
  few.width = std::min(few.width, kAcross);
  few.height = std::min(few.height, kDown);
  kernels::FullProgram program(inputs.image, inputs.camera, few, 1, inputs.frame);
  const traces::BvhTracer tracer(inputs.image);
  FrontEnd front(program, tracer, 0);
  while (const traces::TileWork* work = front.next()) front.give_back(work);
  const double looked_at = static_cast<double>(few.width) * few.height;
  return static_cast<double>(front.result().traversal_steps) / looked_at * samples * kSecondsPerStep;
}

}  // namespace tools
