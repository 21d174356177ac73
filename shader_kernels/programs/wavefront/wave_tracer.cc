#include "shader_kernels/programs/wavefront/wave_tracer.h"

#include <algorithm>
#include <iterator>
#include <type_traits>

#include "traces/walk.h"

namespace kernels {

using traces::RayKind;

namespace {

/// A shadow ray is dropped if its light is below this fraction of the key render.min_weight. By default that is one
/// step of a dark 8-bit sRGB channel. Paths end at render.min_weight itself, which is larger, because a sample has few
/// paths, while a picture may have many dark surfaces.
constexpr float kLeastLight = 0x1p-5F;

}  // namespace

WaveTracer::WaveTracer(const SceneTables& scene, const traces::Tracer& tracer, TileGraph& graph, TileResult& out)
    : scene_(scene), tracer_(tracer), graph_(graph), out_(out), buffer_(out.buffer) {
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
  traces::WalkSink sink{out_.work.walk, out_.work.ray_begin};
  tracer_.trace(std::span(slots.rays).subspan(first, ray_count), kind, std::span(slots.hits).subspan(first, ray_count),
                graph_.is_recording() ? &sink : nullptr);
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

}  // namespace kernels
