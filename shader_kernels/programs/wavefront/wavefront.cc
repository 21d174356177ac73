#include "shader_kernels/programs/wavefront/wavefront.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <optional>
#include <type_traits>
#include <utility>

#include "shader_kernels/programs/wavefront/guides.h"
#include "traces/walk.h"

namespace kernels {

using traces::RayKind;
using Node = TileGraph::Node;

namespace {

/// A shadow ray is dropped if its light is below this fraction of the key render.min_weight, by default one step of a
/// dark 8-bit sRGB channel. Paths end at render.min_weight itself: a sample has fewer paths than shadow rays.
constexpr float kLeastLight = 0x1p-5F;

}  // namespace

WaveTracer::WaveTracer(const SceneTables& scene, const traces::Tracer& tracer, TileGraph& graph, TileResult& out)
    : scene_(scene),
      tracer_(tracer),
      graph_(graph),
      out_(out),
      buffer_(out.buffer),
      key_grid_(scene.image.lower, scene.image.upper) {
  out.rays = {};
  out.continued = 0;
  out.traversal_steps = out.triangle_tests = 0;
  out.pixel_work.clear();
  buffer_.scratch.pixel_work.clear();
  out.background.clear();
}

TracedBatch WaveTracer::trace(RayKind kind, RaySlots& slots, std::uint32_t first, std::uint32_t ray_count, Node maker,
                              bool is_mapped) {
  TracedBatch batch{trace_rays_once(kind, slots, first, ray_count, maker, is_mapped)};
  if (kind == RayKind::kShadow ? scene_.has_shades : scene_.has_alpha) {
    batch.settled = continue_through_layers(kind, slots, first, ray_count, batch.rays);
  }
  return batch;
}

TracedBatch WaveTracer::find_primary_hits(std::uint32_t ray_count, Node maker) {
  RaySlots& wave = buffer_.rays.wave;
  if (out_.rasteriser == nullptr) return trace(RayKind::kPrimary, wave, 0, ray_count, maker, false);
  // The host traces the rays to find the hits, but the recorded work is that of the rasteriser.
  tracer_.trace({wave.rays.data(), ray_count}, RayKind::kPrimary, {wave.hits.data(), ray_count}, nullptr);
  TracedBatch batch;
  if (graph_.is_recording()) {
    out_.rasteriser->rasterise_samples({wave.rays.data(), ray_count}, buffer_.scratch.coverage, &out_.work);
    batch.rays = graph_.stream_builder().add_rasterisation(ray_count, maker);
  }
  if (scene_.has_alpha) batch.settled = continue_through_layers(RayKind::kPrimary, wave, 0, ray_count, batch.rays);
  return batch;
}

WaveTracer::Node WaveTracer::trace_rays_once(RayKind kind, RaySlots& slots, std::uint32_t first,
                                             std::uint32_t ray_count, Node maker, bool is_mapped) {
  const std::size_t first_ray = out_.work.ray_begin.size();
  traces::WalkSink sink{out_.work.walk, out_.work.ray_begin, out_.predictions};
  tracer_.trace(std::span(slots.rays).subspan(first, ray_count), kind, std::span(slots.hits).subspan(first, ray_count),
                graph_.is_recording() ? &sink : nullptr);
  if (graph_.is_recording()) {
    for (const traces::Ray& ray : std::span(slots.rays).subspan(first, ray_count)) {
      out_.work.ray_keys.push_back(key_grid_.key_of(ray));
    }
  }
  if (graph_.is_muted()) return TileGraph::kNone;
  count_traversal_steps(first_ray, std::span(slots.paths).subspan(first, ray_count));
  const Node node = graph_.stream_builder().add_rays(kind, ray_count, rays_traced_, maker, is_mapped);
  rays_traced_ += ray_count;
  out_.rays[static_cast<std::size_t>(kind)] += ray_count;
  return node;
}

/// Counts the traversal steps of the rays that were traced last, for the tile and for their samples.
void WaveTracer::count_traversal_steps(std::size_t first_ray, std::span<const PathRecord<float>> paths) {
  const std::span walk(out_.work.walk);
  const std::vector<std::uint32_t>& begin = out_.work.ray_begin;
  if (first_ray == begin.size()) return;  // the tracer has recorded no walks
  if (!counts_pixels()) {
    const traces::WalkSteps steps = traces::count_steps(walk.subspan(begin[first_ray]));
    out_.traversal_steps += steps.total_steps();
    out_.triangle_tests += steps.tests;
    return;
  }
  for (std::size_t ray = first_ray; ray < begin.size(); ++ray) {
    const std::size_t end = ray + 1 == begin.size() ? walk.size() : begin[ray + 1];
    const traces::WalkSteps steps = traces::count_steps(walk.subspan(begin[ray], end - begin[ray]));
    PixelWork& work = buffer_.scratch.pixel_work[paths[ray - first_ray].sample];
    work.rays += 1;
    work.steps += static_cast<std::uint32_t>(steps.total_steps());
    work.tests += static_cast<std::uint32_t>(steps.tests);
    out_.traversal_steps += steps.total_steps();
    out_.triangle_tests += steps.tests;
  }
}

/// Records that a sample belongs to pixel (x, y), for counting its work. Sample numbers are reused, so work counted for
/// the sample's former pixel is first moved to the result.
void WaveTracer::assign_sample_to_pixel(std::uint32_t sample, std::uint32_t x, std::uint32_t y) {
  std::vector<PixelWork>& all = buffer_.scratch.pixel_work;
  if (all.size() <= sample) all.resize(std::size_t{sample} + 1);
  PixelWork& work = all[sample];
  if (work.rays != 0) out_.pixel_work.push_back(work);
  work = {.pixel = y * scene_.width + x};
}

void WaveTracer::finish() {
  std::ranges::copy_if(buffer_.scratch.pixel_work, std::back_inserter(out_.pixel_work),
                       [](const PixelWork& work) { return work.rays != 0; });
}

/// Continues rays whose hit is a hole or lets light pass. New rays are made from the original ray and hit, and their
/// hits replace the original ones. Returns the last launch that wrote hits, or kNone if nothing was tested.
WaveTracer::Node WaveTracer::continue_through_layers(RayKind kind, RaySlots& slots, std::uint32_t first,
                                                     std::uint32_t ray_count, Node batch) {
  const std::uint32_t solid = kind == RayKind::kShadow ? scene_.solid_shadow : kSolidNearest;
  buffer_.reserve_layers(ray_count);
  ClassifyLayers::Ports<float> classify;
  classify.hits.bind(slots.hits.data() + first);
  classify.solid = solid;
  Node before = graph_.launch<ClassifyLayers>(classify, ray_count);
  graph_.wait_item_by_item(before, batch);
  std::uint32_t items = classify.layer_count.value;
  Node settled = TileGraph::kNone;
  for (std::uint32_t layer = 0; items != 0 && layer < scene_.layers; ++layer) {
    const auto test = [&]<bool kInstanced>(std::bool_constant<kInstanced>) {
      return scene_.image.vertices.empty()
                 ? test_layers<false, kInstanced>(kind, slots, first, items, ray_count, settled)
                 : test_layers<true, kInstanced>(kind, slots, first, items, ray_count, settled);
    };
    const std::uint32_t rays = scene_.image.has_two_levels() ? test(std::true_type{}) : test(std::false_type{});
    graph_.wait_for_all(settled, before);
    graph_.wait_for_all(settled, batch);
    if (rays == 0) break;
    for (std::uint32_t i = 0; counts_pixels() && i < rays; ++i) {
      buffer_.rays.layer.paths[i].sample = slots.paths[first + buffer_.queues.targets.entries[i]].sample;
    }
    const Node onwards = trace_rays_once(kind, buffer_.rays.layer, 0, rays, settled, true);
    if (!graph_.is_muted()) out_.continued += rays;

    ScatterLayers::Ports<float> scatter;
    scatter.hits.bind(slots.hits.data() + first);
    scatter.solid = solid;
    settled = before = graph_.launch<ScatterLayers>(scatter, rays, ray_count);
    graph_.wait_item_by_item(settled, onwards);
    graph_.wait_for_all(settled, batch);
    items = scatter.layer_count.value;
  }
  return settled;
}

template <bool kColoured, bool kInstanced>
std::uint32_t WaveTracer::test_layers(RayKind kind, RaySlots& slots, std::uint32_t first, std::uint32_t items,
                                      std::uint32_t lanes, Node& tested) {
  const auto bind = [&](LayerPorts<float, kColoured, kInstanced>& ports) {
    ports.rays.bind(slots.rays.data() + first);
    ports.hits.bind(slots.hits.data() + first);
    ports.next_rays.bind(buffer_.rays.layer.rays.data());
    ports.epsilon = scene_.epsilon;
    ports.min_weight = scene_.min_weight;
    ports.white = scene_.image.white;
  };
  if (kind == RayKind::kShadow) {
    ShadowLayerPorts<float, kColoured, kInstanced> ports;
    bind(ports);
    ports.min_weight = scene_.min_weight * kLeastLight;
    ports.paths.bind(slots.paths.data() + first);
    tested = graph_.launch<TestShadow<kColoured, kInstanced>>(ports, items, lanes);
    return ports.emitted.value;
  }
  LayerPorts<float, kColoured, kInstanced> ports;
  bind(ports);
  tested = graph_.launch<TestAlpha<kColoured, kInstanced>>(ports, items, lanes);
  return ports.emitted.value;
}

namespace {

using Q = StageQueues;

// Tables of the surface stages, which fetch the surfaces of a bounce and sort them into queues by material class.
constexpr auto kSeparate = std::to_array<WaveStage>({
    {&Q::surfaces, launch_by_instances_and_cones<ShadeSurface>, WaitsFor::kBounce, kFetches},
    {&Q::surfaces, launch<ClassifySurfaces>, WaitsFor::kItem, kFillsQueues | kEndsSurfaces},
});

constexpr auto kSeparateDetailed = std::to_array<WaveStage>({
    {&Q::surfaces, launch_by_instances_and_cones<ShadeSurface>, WaitsFor::kBounce, kFetches},
    {&Q::surfaces, launch<ClassifyDetails>, WaitsFor::kItem, kFillsQueues | kOwnItemsOnly},
    {&Q::absorbing, launch<Absorb>, WaitsFor::kBounce, kFillsQueues},
    {&Q::vertexed, launch_by_instances<FetchVertices>, WaitsFor::kBounce, kFillsQueues},
    {&Q::based, launch_by_mips<ShadeBase>, WaitsFor::kBounce, kFillsQueues},
    {&Q::physical, launch_physical, WaitsFor::kBounce, kFillsQueues},
    {&Q::bumped, launch_by_mips<ShadeBump>, WaitsFor::kBounce, kFillsQueues},
    {&Q::blended, launch<ShadeBlend>, WaitsFor::kBounce, kFillsQueues},
    {&Q::surfaces, launch<ClassifySurfaces>, WaitsFor::kInspector, kFillsQueues | kEndsSurfaces},
});

/// Stages for texture details, which run before the fused stage that lights surfaces.
constexpr auto kFusedDetails = std::to_array<WaveStage>({
    {&Q::surfaces, launch_by_instances_and_cones<FetchSurface>, WaitsFor::kBounce, kFillsQueues},
    {&Q::absorbing, launch<Absorb>, WaitsFor::kBounce, kFillsQueues},
    {&Q::vertexed, launch_by_instances<FetchVertices>, WaitsFor::kBounce, kFillsQueues},
    {&Q::based, launch_by_mips<ShadeBase>, WaitsFor::kBounce, kFillsQueues},
    {&Q::physical, launch_physical, WaitsFor::kBounce, kFillsQueues},
    {&Q::bumped, launch_by_mips<ShadeBump>, WaitsFor::kBounce, kFillsQueues},
    {&Q::blended, launch<ShadeBlend>, WaitsFor::kBounce, kFillsQueues},
});

/// Fused stage that also adds ambient light and the first light, in two variants: for scenes without and with texture
/// details.
struct LitStage {
  WaveStage plain, detailed;
};
constexpr LitStage lit_stage(Launch plain, Launch detailed, std::uint32_t effects) {
  const std::uint32_t all = kFillsQueues | kAddsColours | kCastsRays | effects;
  return {{&Q::surfaces, plain, WaitsFor::kBounce, all}, {&Q::surfaces, detailed, WaitsFor::kBounce, all}};
}
constexpr LitStage kLit = lit_stage(launch_by_instances_and_cones<FetchLit>, launch<LightSurface>, kEndsSurfaces);
constexpr LitStage kLitGeometry =
    lit_stage(launch_by_instances_and_cones<FetchLitGeometry>, launch_by_instances<LightSurfaceGeometry>, kRecordsHits);
constexpr LitStage kLitKept =
    lit_stage(launch_by_instances_and_cones<FetchLitKept>, launch_by_instances<LightSurfaceKept>, kRecordsHits);
constexpr LitStage kLitSecondary = lit_stage(launch_by_instances_and_cones<FetchLitSecondary>,
                                             launch_by_instances<LightSurfaceSecondary>, kRecordsHits);
constexpr LitStage kLitOpen =
    lit_stage(launch_by_instances_and_cones<FetchLitOpen>, launch<LightSurfaceOpen>, kEndsSurfaces);
constexpr LitStage kLitSoft =
    lit_stage(launch_by_instances_and_cones<FetchLitSoft>, launch<LightSurfaceSoft>, kEndsSurfaces);
constexpr LitStage kLitOcclusion = lit_stage(launch_by_instances_and_cones<FetchLitOcclusion>,
                                             launch<LightSurfaceOcclusion>, kEndsSurfaces | kCastsAmbientRays);

constexpr WaveStage kReducedRate{&Q::surfaces, launch_by_instances_and_cones<FetchVisible>, WaitsFor::kBounce,
                                 kFillsQueues | kRecordsHits};

// Stages that shade the sorted surfaces.

constexpr WaveStage kBackground{&Q::misses, launch<ShadeBackground>, WaitsFor::kBounce, kAddsColours};
constexpr WaveStage kTextures{&Q::textured, launch_by_mips<ShadeTextured>, WaitsFor::kInspector, kBaseColours};
constexpr auto kEmission = std::to_array<WaveStage>({
    {&Q::emissive, launch<ShadeEmission>, WaitsFor::kBounce, kAddsColours},
    {&Q::glowing, launch_by_mips<ShadeGlow>, WaitsFor::kBounce, kAddsColours},
});
constexpr WaveStage kAmbient{&Q::diffuse, launch<ShadeAmbient>, WaitsFor::kBounce, kAddsColours};
constexpr WaveStage kOcclusionTextures{&Q::occluded, launch_by_mips<ShadeOccluded>, WaitsFor::kBounce, kAddsColours};
constexpr WaveStage kOcclusionRays{&Q::diffuse, launch<CastOcclusion>, WaitsFor::kBounce,
                                   kCastsRays | kCastsAmbientRays};
constexpr WaveStage kAmbientAndFirstLight{&Q::deferred, launch<LightDeferred>, WaitsFor::kBounce,
                                          kAddsColours | kCastsRays};
constexpr WaveStage kOpenLight{&Q::diffuse, launch<ShadeOpen>, WaitsFor::kBounce, kAddsColours};
constexpr WaveStage kHardShadows{&Q::diffuse, launch<ShadeDiffuse>, WaitsFor::kBounce, kCastsRays};
constexpr WaveStage kSoftShadows{&Q::diffuse, launch<ShadeSoft>, WaitsFor::kBounce, kCastsRays};

// Stages for interpolated surfaces, whose shadows are already known.
constexpr WaveStage kSortInterpolated{&Q::surfaces, launch<ClassifySurfaces>, WaitsFor::kInspector, kFillsQueues};
constexpr WaveStage kFindOcclusionTextures{&Q::surfaces, launch<ClassifyOccluded>, WaitsFor::kInspector, kFillsQueues};
constexpr WaveStage kKnownShadows{&Q::diffuse, launch<ShadeVisible>, WaitsFor::kBounce, kAddsColours};

// Stages that emit the rays of the next wave.
constexpr auto kSpawn = std::to_array<SpawnStage>({
    {&Q::blended, launch<ShadeStraight>, RayKind::kRefraction, &WaveBounce::straight, std::nullopt},
    {&Q::mirror, launch_mirror, RayKind::kReflection, &WaveBounce::mirrored, Effect::kReflections},
    {&Q::glass, launch<ShadeGlass>, RayKind::kRefraction, &WaveBounce::refracted, Effect::kRefractions},
});

// Stages that record a sample's hits and shadow rays.
/// Records the secondary hit whose ray has the largest weight in its sample. The weights of all rays are compared
/// first, because the ray with the largest weight may hit nothing.
template <bool kInstanced>
LaunchResult record_branch(const WaveContext& wave, const WaveBounce& bounce, const StageInput& in) {
  const Node weighed = wave.graph.launch<WeighBranch>(bounce.rays);
  wave.graph.wait_for_all(weighed, bounce.inspector);
  wave.graph.wait_for_all(weighed, wave.retained.cleared);
  const LaunchResult recorded = launch<RecordBranch<kInstanced>>(wave, bounce, in);
  wave.graph.wait_for_all(recorded.node, weighed);
  return recorded;
}
LaunchResult record_branches(const WaveContext& wave, const WaveBounce& bounce, const StageInput& in) {
  return wave.scene.image.has_two_levels() ? record_branch<true>(wave, bounce, in)
                                           : record_branch<false>(wave, bounce, in);
}

constexpr RecordStages kGeometryRecords{launch_by_instances<RecordGeometry>, launch<RecordShadow>,
                                        launch<CombineRecordShadow>};
constexpr RecordStages kSurfaceRecords{launch_by_instances<RecordSurface>, launch<RecordShadow>,
                                       launch<CombineRecordShadow>};
constexpr RecordStages kTraitsRecords{launch_by_instances<RecordTraits>, launch<RecordTraitsShadow>,
                                      launch<CombineRecordTraitsShadow>};
constexpr RecordStages kBranchRecords{record_branches, launch<RecordBranchShadow>, launch<CombineRecordBranchShadow>};
constexpr RecordStages kSecondaryRecords{launch_by_instances<RecordSecondary>, launch<RecordSecondaryShadow>,
                                         launch<CombineRecordSecondaryShadow>};
constexpr RecordStages kVisibleRecords{launch<RecordVisible>, launch<RecordVisibleShadow>,
                                       launch<CombineRecordVisibleShadow>};
constexpr RecordStages kVisibleBranchRecords{launch<RecordBranchVisible>, launch<RecordVisibleShadow>,
                                             launch<CombineRecordVisibleShadow>};

/// Returns a hash of the number of the bounce. The two lowest bits of the hash are 0.
std::uint32_t bounce_hash(std::uint32_t depth) { return depth * 0x9e3779b9U; }

/// Hash key that makes the seeds of occlusion rays differ from those of soft-shadow rays.
constexpr std::uint32_t kAmbientSeed = 0x9e3779b9U;

/// Returns point `index` of a set of `count` points that cover the unit square evenly (Hammersley).
RandomPointUniforms<float> hammersley_point(std::uint32_t index, std::uint32_t count, std::uint32_t seed) {
  std::uint32_t mirrored = 0;
  for (std::uint32_t bit = 0; bit < 32; ++bit) mirrored |= (index >> bit & 1U) << (31 - bit);
  return {(static_cast<float>(index) + 0.5F) / static_cast<float>(count), hash_to_unit_float<float>(mirrored), seed};
}

/// Records to which pixels the primary rays of listed samples belong.
void assign_listed_samples_to_pixels(WaveTracer& tracer, const GridUniforms<float>& grid, const SampleQueue& list,
                                     std::uint32_t items) {
  if (!tracer.counts_pixels()) return;
  const auto pitch = static_cast<std::uint32_t>(grid.pitch), side = static_cast<std::uint32_t>(grid.grid);
  const auto x0 = static_cast<std::int32_t>(grid.x0), y0 = static_cast<std::int32_t>(grid.y0);
  for (std::uint32_t i = 0; i < items; ++i) {
    const std::uint32_t sample = list.entries[i];
    const auto column = static_cast<std::int32_t>(sample % pitch), row = static_cast<std::int32_t>(sample / pitch);
    tracer.assign_ray_to_pixel(i, static_cast<std::uint32_t>(x0 + column) / side,
                               static_cast<std::uint32_t>(y0 + row) / side);
  }
}

}  // namespace

BounceUniforms<float> bounce_uniforms(const WaveBounce& bounce) {
  return {bounce_hash(bounce.depth), bounce.mirrored, bounce.refracted, bounce.depth == 2 ? 1.0F : 0.0F};
}

std::uint32_t secondary_shadow_hash(const WaveBounce& bounce, std::uint32_t light) {
  return scramble_bits<float>(bounce_hash(bounce.depth) ^ light);
}

RandomPointUniforms<float> occlusion_points(const WaveContext& wave, std::uint32_t ray) {
  return hammersley_point(ray, wave.scene.occlusion_rays,
                          scramble_bits<float>(jitter_seed(wave.out.work.frame) ^ kAmbientSeed));
}

RandomPointUniforms<float> soft_shadow_points(const WaveContext& wave, std::uint32_t light, std::uint32_t ray) {
  return hammersley_point(ray, wave.scene.shadow_rays, scramble_bits<float>(jitter_seed(wave.out.work.frame) + light));
}

Wavefront::Wavefront(const SceneTables& scene, const traces::Tracer& tracer, bool record,
                     const ConeUniforms<float>& cone, TileResult& out)
    : out_(out),
      graph_(scene, record, out),
      tracer_(scene, tracer, graph_, out),
      wave_{scene, graph_, out, out.buffer, cone} {}

void Wavefront::run(Node maker, std::uint32_t rays, const RetainedRecords& retained, std::uint32_t lanes,
                    std::uint32_t padding) {
  wave_.retained = retained;
  TileBuffer& buffer = wave_.buffer;
  WaveBounce bounce;
  bounce.rays = rays;
  bounce.lanes = std::max(rays, lanes);
  bounce.padding = padding;
  buffer.reserve_wave(rays);
  bounce.batches[bounce.batch_count++] = tracer_.find_primary_hits(rays, maker);
  while (bounce.rays != 0) {
    classify_hits(bounce);
    if (is_shaded()) run_stage(kBackground, bounce, buffer.queues.misses);
    if (buffer.queues.surfaces.items == 0) return;
    shade_surfaces(bounce);
    if (is_shaded()) {
      run_stage(kTextures, bounce, buffer.queues.textured);
      if (retained.guides != nullptr && bounce.depth == 1) run_stage(kGuides, bounce, buffer.queues.surfaces);
      run_stages(kEmission, bounce);
      uses_low_rate_effects(bounce) ? shade_low_rate_effects(bounce) : shade_local_lights(bounce);
    } else if (wave_.retained.visible.have_shadows && wave_.scene.shadow_rays != 0) {
      for (std::uint32_t light = 0; light < wave_.scene.lights.size(); ++light) {
        shade_light(bounce, light, buffer.queues.diffuse);
      }
    }
    if (bounce.depth == std::min(wave_.scene.depth, wave_.retained.visible.depth)) return;
    bounce = spawn_secondary_rays(bounce);
  }
}

void Wavefront::finish() {
  graph_.finish();
  tracer_.finish();
}

void Wavefront::classify_hits(WaveBounce& bounce) {
  ClassifyHits::Ports<float> ports;
  bounce.inspector = graph_.launch<ClassifyHits>(ports, bounce.rays, bounce.lanes, bounce.padding);
  bounce.colours = kNone;
  graph_.wait_for_all(bounce.inspector, bounce.begun);
  if (bounce.batch_count == 1 && bounce.batches[0].settled == kNone) {
    graph_.wait_item_by_item(bounce.inspector, bounce.batches[0].rays);
  } else {
    for (const TracedBatch& batch : bounce.batches) {
      graph_.wait_for_all(bounce.inspector, batch.rays);
      graph_.wait_for_all(bounce.inspector, batch.settled);
    }
  }
  if (bounce.depth != 1 || graph_.is_muted()) return;
  const TileBuffer& buffer = wave_.buffer;
  for (std::uint32_t i = 0; i < buffer.queues.misses.items; ++i) {
    out_.background.push_back(buffer.rays.wave.paths[buffer.queues.misses.entries[i]].sample);
  }
}

/// Fetches the surfaces that the rays of a bounce have hit, sorts them by material class and shades each class. Stages
/// that the scene and the bounce do not need are left out.
void Wavefront::shade_surfaces(WaveBounce& bounce) {
  const SceneTables& scene = wave_.scene;
  const RetainedRecords& kept = wave_.retained;
  TileBuffer& buffer = wave_.buffer;
  buffer.queues.clear_surfaces();
  if (scene.has_details) buffer.reserve_details(bounce.rays);
  // Surfaces are not lit immediately if a sample has two rays in the wave and light may be deferred, because the lights
  // would be added in another order.
  const bool has_light = !kept.is_path && (!scene.lights.empty() || scene.occlusion_rays != 0);
  const bool is_lit = is_shaded() && scene.fuses && has_light && !uses_low_rate_effects(bounce) &&
                      (bounce.is_single || !scene.has_deferred);
  if (is_lit) {
    const LitStage* stage = &kLit;
    if (!scene.has_plain_lighting()) {
      stage = scene.occlusion_rays != 0 ? &kLitOcclusion : scene.shadow_rays == 0 ? &kLitOpen : &kLitSoft;
    } else if (bounce.depth == 1 && kept.geometry) {
      stage = &kLitGeometry;
    } else if (bounce.depth == 1 && kept.surfaces) {
      stage = &kLitKept;
    } else if (bounce.depth > 1 && kept.secondary) {
      stage = &kLitSecondary;
    }
    if (scene.has_details) run_stages(kFusedDetails, bounce);
    run_stage(scene.has_details ? stage->detailed : stage->plain, bounce, buffer.queues.surfaces);
    bounce.has_lit = true;
  } else if (uses_low_rate_effects(bounce) && scene.fuses && !scene.has_details) {
    run_stage(kReducedRate, bounce, buffer.queues.surfaces);
  } else if (scene.has_details) {
    run_stages(kSeparateDetailed, bounce);
  } else {
    run_stages(kSeparate, bounce);
  }
}

void Wavefront::run_stages(std::span<const WaveStage> stages, WaveBounce& bounce) {
  for (const WaveStage& stage : stages) run_stage(stage, bounce, wave_.buffer.queues.*stage.queue);
}

/// Launches a shading stage on a queue. Traces the rays that the stage emits and adds their light.
Node Wavefront::run_stage(const WaveStage& stage, WaveBounce& bounce, SlotQueue& queue, std::uint32_t light,
                          std::uint32_t ray) {
  if (queue.items == 0) return kNone;
  RaySlots& shadow = wave_.buffer.rays.shadow;
  if (stage.has(kCastsRays)) shadow.reserve_slots(std::size_t{queue.items} + 1);
  const LaunchResult launched = stage.launch(wave_, bounce,
                                             {.entries = queue.entries.data(),
                                              .items = queue.items,
                                              .lanes = stage.has(kOwnItemsOnly) ? 0 : bounce.lanes,
                                              .light = light,
                                              .ray = ray});
  const Node node = launched.node;
  if (stage.waits == WaitsFor::kItem) graph_.wait_item_by_item(node, bounce.fetched);
  if (stage.waits == WaitsFor::kInspector) graph_.wait_for_all(node, bounce.inspector);
  if (stage.waits == WaitsFor::kBounce) wait_for_bounce(node, bounce);
  if (stage.has(kAddsColours)) graph_.register_colour_writer(node);
  if (stage.has(kFetches)) bounce.fetched = node;
  if (stage.has(kFillsQueues)) bounce.inspector = node;
  if (stage.has(kBaseColours)) bounce.colours = node;

  TracedBatch batch;
  if (launched.rays != 0) batch = tracer_.trace(RayKind::kShadow, shadow, 0, launched.rays, node, true);
  if (stage.has(kRecordsHits)) {
    graph_.wait_for_all(node, bounce.depth == 1 ? wave_.retained.cleared : wave_.retained.cleared_secondary);
    graph_.register_record_writer(node);
    bounce.recorded = node;
  }
  if (stage.has(kEndsSurfaces)) record_hits(bounce);
  if (launched.rays != 0) combine_shadows(bounce, light, batch, launched.rays, !stage.has(kCastsAmbientRays));
  return node;
}

void Wavefront::wait_for_bounce(Node node, const WaveBounce& bounce) {
  graph_.wait_for_all(node, bounce.colours != kNone ? bounce.colours : bounce.inspector);
  // The rays are already traced. These edges keep their slots reserved.
  for (const TracedBatch& batch : bounce.batches) graph_.wait_for_all(node, batch.rays);
  if (bounce.depth > 1) graph_.wait_for_all(node, bounce.after);
}

/// Makes `node` wait for a batch of rays: item by item, unless rays continued after transparent surfaces.
void Wavefront::wait_for_batch(Node node, const TracedBatch& batch) {
  if (batch.settled == kNone) return graph_.wait_item_by_item(node, batch.rays);
  graph_.wait_for_all(node, batch.rays);
  graph_.wait_for_all(node, batch.settled);
}

/// Adds ambient light and all lights to diffuse surfaces. At surfaces that a fused stage has lit, ambient light and the
/// first light are already added, or the first occlusion ray is already emitted.
void Wavefront::shade_local_lights(WaveBounce& bounce) {
  const SceneTables& scene = wave_.scene;
  StageQueues& queues = wave_.buffer.queues;
  if (queues.diffuse.items == 0) return;
  SlotQueue& first = unlit_queue(bounce);
  const bool keeps_local = wave_.retained.surfaces && bounce.depth == 1;
  const auto lights = static_cast<std::uint32_t>(scene.lights.size());
  const bool has_occlusion_rays = scene.occlusion_rays != 0;
  const bool is_fused = scene.has_plain_lighting() && scene.fuses && lights != 0 && queues.occluded.items == 0;
  // Surfaces that were lit immediately had no colour before.
  if (keeps_local && first.items != 0) bounce.colours = record_local_colour<false>(bounce, first);
  if (has_occlusion_rays) {
    run_stage(kOcclusionRays, bounce, first);
    for (std::uint32_t ray = 1; ray < scene.occlusion_rays; ++ray) {
      run_stage(kOcclusionRays, bounce, queues.diffuse, 0, ray);
    }
  } else if (is_fused) {
    run_stage(kAmbientAndFirstLight, bounce, first);
  } else {
    run_stage(kAmbient, bounce, first);
    run_stage(kOcclusionTextures, bounce, queues.occluded);
  }
  for (std::uint32_t light = 0; light < lights; ++light) {
    if (light != 0 || has_occlusion_rays) {
      shade_light(bounce, light, queues.diffuse);
    } else {
      if (!is_fused) shade_light(bounce, 0, first, 0, 1);
      shade_light(bounce, 0, queues.diffuse, 1);
    }
  }
  if (keeps_local) bounce.after = record_local_colour<true>(bounce, queues.diffuse);
}

/// Adds the light of one light source to the surfaces of a queue. Of each surface's rays to this light it casts the
/// rays [first_ray, end_ray), by default all.
void Wavefront::shade_light(WaveBounce& bounce, std::uint32_t light, SlotQueue& queue, std::uint32_t first_ray,
                            std::uint32_t end_ray) {
  const SceneTables& scene = wave_.scene;
  const WaveStage& stage = scene.shadow_rays == 0 ? kOpenLight : scene.discs.empty() ? kHardShadows : kSoftShadows;
  for (std::uint32_t ray = first_ray; ray < std::min(end_ray, scene.launches_per_light()); ++ray) {
    run_stage(stage, bounce, queue, light, ray);
  }
}

/// Adds the light of shadow rays to their samples, and records which rays were blocked.
void Wavefront::combine_shadows(const WaveBounce& bounce, std::uint32_t light, const TracedBatch& batch,
                                std::uint32_t rays, bool is_recorded) {
  const StageInput in{.items = rays, .lanes = bounce.lanes, .light = light};
  const RecordStages* kept = is_recorded ? record_stages(bounce) : nullptr;
  if (wave_.retained.visible.are_kept && !wave_.retained.visible.have_shadows) kept = nullptr;
  const auto combine = [&](Launch kernel, bool adds_colours, bool records) {
    const Node node = kernel(wave_, bounce, in).node;
    wait_for_batch(node, batch);
    if (records) {
      graph_.wait_for_all(node, bounce.recorded);
      graph_.register_record_writer(node);
    }
    if (adds_colours) graph_.register_colour_writer(node);
  };
  if (kept != nullptr && is_shaded() && wave_.scene.fuses) return combine(kept->combine_shadows, true, true);
  if (kept == nullptr || is_shaded()) combine(launch<CombineShadow>, true, false);
  if (kept != nullptr) combine(kept->shadows, false, true);
}

/// Returns the kernels that record the hits of a bounce, or null if the samples keep no records.
const RecordStages* Wavefront::record_stages(const WaveBounce& bounce) const {
  const RetainedRecords& kept = wave_.retained;
  if (kept.visible.are_kept) {
    if (bounce.depth == 1) return &kVisibleRecords;
    return kept.visible.keeps_branch(bounce.depth) ? &kVisibleBranchRecords : nullptr;
  }
  if (bounce.depth == 1 && kept.geometry) return &kGeometryRecords;
  if (bounce.depth == 1 && kept.surfaces) return &kSurfaceRecords;
  if (bounce.depth == 1 && kept.traits) return &kTraitsRecords;
  if (bounce.depth == 2 && kept.traits) return &kBranchRecords;
  return bounce.depth > 1 && kept.secondary ? &kSecondaryRecords : nullptr;
}

void Wavefront::record_hits(WaveBounce& bounce) {
  const RecordStages* kept = record_stages(bounce);
  if (kept == nullptr) return;
  bounce.recorded =
      kept->hits(wave_, bounce, {.items = wave_.buffer.queues.surfaces.items, .lanes = bounce.lanes}).node;
  if (bounce.recorded == kNone) return;
  wait_for_bounce(bounce.recorded, bounce);
  graph_.wait_for_all(bounce.recorded, bounce.depth == 1 ? wave_.retained.cleared : wave_.retained.cleared_secondary);
  graph_.register_record_writer(bounce.recorded);
}

/// Records the samples' colours before local lights are added or, with kAfter, after they were added. Later bounces
/// wait for the launch with kAfter.
template <bool kAfter>
Node Wavefront::record_local_colour(const WaveBounce& bounce, SlotQueue& queue) {
  const StageInput in{.entries = queue.entries.data(), .items = queue.items, .lanes = bounce.lanes};
  const Node node = launch<RecordLocal<kAfter>>(wave_, bounce, in).node;
  wait_for_bounce(node, bounce);
  graph_.wait_for_colour_writers(node);
  if (!kAfter) graph_.wait_for_all(node, wave_.retained.cleared);
  return node;
}

WaveBounce Wavefront::spawn_secondary_rays(const WaveBounce& bounce) {
  TileBuffer& buffer = wave_.buffer;
  const StageQueues& queues = buffer.queues;
  RaySlots& slots = buffer.rays.next_wave;
  slots.reserve_slots(std::size_t{queues.blended.items} + queues.mirror.items + queues.glass.items + bounce.rays + 1);
  WaveBounce from = bounce;
  from.colours = kNone;  // these kernels do not read base colours
  WaveBounce next;
  next.depth = bounce.depth + 1;
  next.after = bounce.after;
  for (const SpawnStage& stage : kSpawn) {
    next.*stage.first = next.rays;
    SlotQueue& queue = buffer.queues.*stage.queue;
    if (queue.items == 0 || (stage.effect && !wave_.scene.effects.has(*stage.effect))) continue;
    const auto [maker, rays] = stage.launch(
        wave_, from,
        {.entries = queue.entries.data(), .items = queue.items, .lanes = bounce.lanes, .next_ray = next.rays});
    wait_for_bounce(maker, from);
    if (rays == 0) continue;
    next.batches[next.batch_count++] = tracer_.trace(stage.kind, slots, next.rays, rays, maker, true);
    const std::uint32_t apart = bounce.depth == 1 ? wave_.retained.visible.branch_offset(stage.kind) : 0;
    if (apart != 0) assign_branch_samples(next, rays, apart, maker);
    next.rays += rays;
    next.lanes += bounce.lanes;
  }
  if (uses_low_rate_effects(bounce) && wave_.scene.has_bounce) spawn_bounce_rays(bounce, next);
  next.is_single = bounce.is_single && next.batch_count < 2;
  std::swap(buffer.rays.wave, buffer.rays.next_wave);
  buffer.reserve_wave(next.rays);
  return next;
}

/// Gives each of the last `rays` rays of the next wave a sample of its own, which collects mirrored or refracted light.
/// Launch `maker` emitted these rays.
void Wavefront::assign_branch_samples(WaveBounce& next, std::uint32_t rays, std::uint32_t apart, Node maker) {
  BeginBranch::Ports<float> ports;
  ports.next_paths.bind(wave_.buffer.rays.next_wave.paths.data() + next.rays);
  ports.apart = apart;
  const Node begun = graph_.launch<BeginBranch>(ports, rays);
  graph_.wait_for_all(begun, maker);
  graph_.wait_for_all(begun, wave_.retained.cleared_secondary);
  graph_.wait_for_all(begun, next.begun);
  graph_.register_record_writer(begun);
  next.begun = begun;
}

template <bool kAlongY>
void Wavefront::shade_interpolated(const LineUniforms<float>& line, std::uint32_t items, std::uint32_t lanes,
                                   Node checked) {
  TileBuffer& buffer = wave_.buffer;
  StageQueues& queues = buffer.queues;
  buffer.reserve_wave(items);
  queues.clear_surfaces();
  queues.surfaces.items = items;
  WaveBounce bounce;
  bounce.lanes = std::max(items, lanes);
  bounce.has_lit = wave_.scene.fuses && !wave_.scene.lights.empty();
  const Launch interpolate = bounce.has_lit ? launch<InterpolateLit<kAlongY>> : launch<InterpolateAttributes<kAlongY>>;
  bounce.inspector = interpolate(wave_, bounce, {.items = items, .lanes = lanes, .line = &line}).node;
  graph_.wait_for_all(bounce.inspector, checked);
  graph_.register_record_writer(bounce.inspector);
  graph_.register_colour_writer(bounce.inspector);
  if (!bounce.has_lit) run_stage(kSortInterpolated, bounce, queues.surfaces);
  if (wave_.scene.has_occlusion) {
    buffer.reserve_details(items);
    run_stage(kFindOcclusionTextures, bounce, queues.surfaces);
  }
  run_stage(kTextures, bounce, queues.textured);
  run_stage(kAmbient, bounce, unlit_queue(bounce));
  run_stage(kOcclusionTextures, bounce, queues.occluded);
  for (std::uint32_t light = 0; light < wave_.scene.lights.size(); ++light) {
    run_stage(kKnownShadows, bounce, light == 0 ? unlit_queue(bounce) : queues.diffuse, light);
  }
}
template void Wavefront::shade_interpolated<false>(const LineUniforms<float>& line, std::uint32_t items,
                                                   std::uint32_t lanes, Node checked);
template void Wavefront::shade_interpolated<true>(const LineUniforms<float>& line, std::uint32_t items,
                                                  std::uint32_t lanes, Node checked);

Node Wavefront::generate_listed_rays(GenerateListedRays::Ports<float>& ports, SampleQueue& list, Node lister,
                                     std::uint32_t items, RetainedRecords& retained, std::uint32_t lanes) {
  const auto launch_on_list = [&]<class K, class... Clear>(std::type_identity<K>, std::type_identity<Clear>...) {
    typename K::template Ports<float> bound;
    if constexpr (std::is_base_of_v<GenerateListedRays::Ports<float>, typename K::template Ports<float>>) {
      ports_of<GenerateListedRays>(bound) = ports;
      (ports_of<Clear>(bound).samples.bind(list.entries.data()), ...);
    } else {
      bound.samples.bind(list.entries.data());
    }
    if constexpr (std::is_base_of_v<ClearTraits::Ports<float>, typename K::template Ports<float>>) {
      ports_of<ClearTraits>(bound).secondary.bind(wave_.buffer.subpixels.secondary_traits.data());
    }
    return graph_.launch<K>(bound, items, lanes);
  };
  using std::type_identity;
  ports.samples.bind(list.entries.data());
  if (wave_.scene.fuses && (retained.geometry || retained.surfaces || retained.traits)) {
    const type_identity<ClearGeometry> geometry;
    const Node node =
        retained.traits     ? launch_on_list(type_identity<GenerateTraits>{}, type_identity<ClearTraits>{})
        : retained.surfaces ? launch_on_list(type_identity<GenerateSurface>{}, type_identity<ClearSurface>{})
        : retained.secondary
            ? launch_on_list(type_identity<GenerateSecondary>{}, geometry, type_identity<ClearSecondary>{})
            : launch_on_list(type_identity<GenerateGeometry>{}, geometry);
    retained.cleared = retained.cleared_secondary = node;
    assign_listed_samples_to_pixels(tracer_, ports.grid, list, items);
    graph_.wait_for_all(node, lister);
    graph_.register_record_writer(node);
    return node;
  }
  const Node generated = launch_on_list(type_identity<GenerateListedRays>{});
  assign_listed_samples_to_pixels(tracer_, ports.grid, list, items);
  graph_.wait_for_all(generated, lister);
  const auto clear = [&](auto kernel) {
    const Node node = launch_on_list(kernel);
    graph_.wait_for_all(node, lister);
    graph_.register_record_writer(node);
    return node;
  };
  if (retained.surfaces) retained.cleared = clear(type_identity<ClearSurface>{});
  if (retained.geometry) retained.cleared = clear(type_identity<ClearGeometry>{});
  if (retained.traits) retained.cleared = clear(type_identity<ClearTraits>{});
  if (retained.secondary) retained.cleared_secondary = clear(type_identity<ClearSecondary>{});
  return generated;
}

}  // namespace kernels
