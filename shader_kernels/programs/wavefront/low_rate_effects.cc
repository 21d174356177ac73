#include "shader_kernels/programs/wavefront/wavefront.h"

// Stages of Wavefront for effects that are traced at only some pixels (docs/design/effects.md).

namespace kernels {
namespace {

constexpr WaveStage kFullRateAmbient{&StageQueues::diffuse, launch<ShadeAmbient>, WaitsFor::kBounce, kAddsColours};
constexpr WaveStage kFullRateOcclusionTextures{&StageQueues::occluded, launch_by_mips<ShadeOccluded>, WaitsFor::kBounce,
                                               kAddsColours};

/// Hash key that makes the seeds of diffuse rays differ from those of other effects.
constexpr std::uint32_t kBounceSeed = 0xc2b2ae3dU;

/// Launches the kernel that lights surfaces from a sky of radiance 1.
LaunchResult launch_white_sky(const WaveContext& wave, const WaveBounce& bounce, const StageInput& in) {
  ShadeAmbient::Ports<float> ports;
  bind_stage<ShadeAmbient>(ports, wave, bounce, in);
  ports.ambient = {1, 1, 1};
  return {wave.graph.launch<ShadeAmbient>(ports, in.items, in.lanes), 0};
}

}  // namespace

/// Lights first hits if occlusion and soft shadows are traced at only some pixels: every sample stores its unoccluded
/// light, and only the selected samples cast rays that find the visible fraction.
void Wavefront::shade_low_rate_effects(WaveBounce& bounce) {
  const SceneTables& scene = wave_.scene;
  TileBuffer& buffer = wave_.buffer;
  SlotQueue& diffuse = buffer.queues.diffuse;
  buffer.checks.passed.items = 0;
  if (diffuse.items == 0) return;
  const auto select = [&]<bool kCheckerboard> {
    typename SelectEffects<kCheckerboard>::template Ports<float> ports;
    ports.grid = wave_.retained.low_rate.grid;
    return graph_.launch<SelectEffects<kCheckerboard>>(ports, diffuse.items, bounce.lanes);
  };
  const Node selected =
      scene.is_checkerboard ? select.template operator()<true>() : select.template operator()<false>();
  wait_for_bounce(selected, bounce);
  std::uint32_t layer = 0;
  const auto keep_unoccluded = [&](Launch kernel, std::uint32_t light) {
    const Node node =
        kernel(wave_, bounce,
               {.entries = diffuse.entries.data(),
                .items = diffuse.items,
                .lanes = bounce.lanes,
                .light = light,
                .colours = buffer.filters.lights.data() + std::size_t{layer} * wave_.retained.low_rate.layer})
            .node;
    wait_for_bounce(node, bounce);
    graph_.wait_for_all(node, wave_.retained.cleared);
    graph_.register_record_writer(node);
  };
  if (scene.has_bounce) {
    keep_unoccluded(launch_white_sky, 0);
    selected_ = selected;
    ++layer;
  } else if (scene.occlusion_rays != 0) {
    keep_unoccluded(launch<ShadeAmbient>, 0);
    for (std::uint32_t ray = 0; ray < scene.occlusion_rays; ++ray) {
      trace_visible_fractions(bounce, launch<CastOcclusionShare>, {.ray = ray}, selected, scene.occlusion_share(),
                              layer);
    }
    ++layer;
  } else {
    run_stage(kFullRateAmbient, bounce, diffuse);
    run_stage(kFullRateOcclusionTextures, bounce, buffer.queues.occluded);
  }
  for (std::uint32_t light = 0; light < scene.lights.size(); ++light) {
    if (scene.discs.empty()) {
      shade_light(bounce, light, diffuse, 0, 1);
      continue;
    }
    keep_unoccluded(launch<ShadeOpen>, light);
    for (std::uint32_t ray = 0; ray < scene.shadow_rays; ++ray) {
      trace_visible_fractions(bounce, launch<ShadeSoftShare>, {.light = light, .ray = ray}, selected,
                              scene.discs[light].share, layer);
    }
    ++layer;
  }
}

/// Emits effect rays from the selected samples, and adds the rays' results to the samples' visible fractions.
void Wavefront::trace_visible_fractions(const WaveBounce& bounce, Launch cast, StageInput in, Node selected,
                                        float share, std::uint32_t layer) {
  TileBuffer& buffer = wave_.buffer;
  in.entries = buffer.checks.passed.entries.data();
  in.items = buffer.checks.passed.items;
  in.lanes = bounce.lanes;
  if (in.items == 0) return;
  buffer.rays.shadow.reserve_slots(std::size_t{in.items} + 1);
  const auto [node, rays] = cast(wave_, bounce, in);
  wait_for_bounce(node, bounce);
  graph_.wait_for_all(node, selected);
  if (rays == 0) return;
  const TracedBatch batch = tracer_.trace(traces::RayKind::kShadow, buffer.rays.shadow, 0, rays, node, true);
  CombineRatio::Ports<float> combine;
  combine.ratios.bind(buffer.filters.ratios.data() + std::size_t{layer} * wave_.retained.low_rate.layer);
  combine.share = share;
  const Node combined = graph_.launch<CombineRatio>(combine, rays, bounce.lanes);
  wait_for_batch(combined, batch);
  graph_.wait_for_all(combined, wave_.retained.cleared);
  graph_.register_record_writer(combined);
}

/// Emits a diffuse ray from each selected sample. Another colour of the sample collects its light.
void Wavefront::spawn_bounce_rays(const WaveBounce& bounce, WaveBounce& next) {
  const TileBuffer& buffer = wave_.buffer;
  if (buffer.checks.passed.items == 0) return;
  CastBounce::Ports<float> ports;
  bind_stage<CastBounce>(ports, wave_, bounce,
                         {.entries = wave_.buffer.checks.passed.entries.data(), .next_ray = next.rays});
  ports.draw = {0.5F, 0.5F, scramble_bits<float>(jitter_seed(wave_.out.work.frame) ^ kBounceSeed)};
  ports.apart = wave_.retained.low_rate.layer;
  const TileGraph::Node maker = graph_.launch<CastBounce>(ports, buffer.checks.passed.items, bounce.lanes);
  wait_for_bounce(maker, bounce);
  graph_.wait_for_all(maker, selected_);
  graph_.wait_for_all(maker, wave_.retained.cleared);
  graph_.register_record_writer(maker);
  const std::uint32_t rays = ports.emitted.value;
  RaySlots& slots = wave_.buffer.rays.next_wave;
  next.batches[next.batch_count++] = tracer_.trace(traces::RayKind::kReflection, slots, next.rays, rays, maker, true);
  next.begun = maker;  // colours are cleared before light is added
  next.rays += rays;
  next.lanes += bounce.lanes;
}

}  // namespace kernels
