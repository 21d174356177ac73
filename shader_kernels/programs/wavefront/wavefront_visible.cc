#include "shader_kernels/programs/wavefront/wavefront.h"

namespace kernels {

/// Gives the last rays of the next wave, which `maker` made, samples of their own.
void Wavefront::begin_branch(Bounce& next, std::uint32_t rays, std::uint32_t apart, Node maker) {
  BeginBranch::Ports<float> ports;
  ports.next_paths.bind(buffer_.next_wave.paths.data() + next.rays);
  ports.apart = apart;
  const Node begun = launch<BeginBranch>(ports, rays);
  wait_all(begun, maker);
  wait_all(begun, retained_.cleared_secondary);
  wait_all(begun, next.begun);
  adds_records(begun);
  next.begun = begun;
}

/// The launch that keeps how deep and how inclined the surfaces are, if these are kept.
Wavefront::Node Wavefront::record_visible(const Bounce& bounce, std::uint32_t surfaces) {
  if (bounce.depth == 1) {
    RecordVisible::Ports<float> ports;
    ports.eye = retained_.visible.eye;
    return launch<RecordVisible>(ports, surfaces, bounce.lanes);
  }
  if (!retained_.visible.keeps_branch(bounce.depth)) return kNone;
  RecordBranchVisible::Ports<float> ports;
  ports.depth_scale = retained_.visible.depth_scale;
  return launch<RecordBranchVisible>(ports, surfaces, bounce.lanes);
}

/// Shadow rays of surfaces that are not shaded.
void Wavefront::cast_shadows(const Bounce& bounce, const Streams& streams) {
  if (streams.diffuse == 0 || !retained_.visible.have_shadows) return;
  for (std::uint32_t light = 0; light < scene_.lights.size(); ++light) {
    for (std::uint32_t ray = 0; ray < scene_.shadow_rays; ++ray) {
      shade_light(bounce, light, ray, buffer_.diffuse, streams.diffuse);
    }
  }
}

}  // namespace kernels
