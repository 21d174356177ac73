#include <type_traits>

#include "shader_kernels/programs/wavefront/wavefront.h"

namespace kernels {

using traces::RayKind;

namespace {

/// Light is dropped when it is below this share of min_weight: a step of an 8-bit sRGB channel in the dark, by default.
/// A path is dropped earlier, but of paths each sample has a few, and of dark surfaces a picture has many.
constexpr float kLeastLight = 0x1p-5F;

}  // namespace

/// Rays whose hit turns out to be a hole, or to let light pass, go on as rays of their own, made from the original ray
/// and the hit; their hits replace the original's. Returns the last launch that did that, or kNone if there
/// was nothing to test.
Wavefront::Node Wavefront::settle(RayKind kind, RaySlots& slots, std::uint32_t first, std::uint32_t count, Node batch) {
  const std::uint32_t solid = kind == RayKind::kShadow ? scene_.solid_shadow : kSolidNearest;
  buffer_.hold_layers(count);
  ClassifyLayers::Ports<float> classify;
  classify.hits.bind(slots.hits.data() + first);
  classify.solid = solid;
  Node before = launch<ClassifyLayers>(classify, count);
  wait_each(before, batch);
  std::uint32_t items = classify.layer_count.value;
  Node settled = StreamBuilder::kNone;
  for (std::uint32_t layer = 0; items != 0 && layer < scene_.layers; ++layer) {
    const auto test = [&]<bool kInstanced>(std::bool_constant<kInstanced>) {
      return scene_.image.vertices.empty() ? test_layers<false, kInstanced>(kind, slots, first, items, count, settled)
                                           : test_layers<true, kInstanced>(kind, slots, first, items, count, settled);
    };
    const std::uint32_t rays = scene_.image.has_levels() ? test(std::true_type{}) : test(std::false_type{});
    wait_all(settled, before);
    wait_all(settled, batch);
    if (rays == 0) break;
    for (std::uint32_t i = 0; counts_pixels() && i < rays; ++i) {
      buffer_.layer.paths[i].sample = slots.paths[first + buffer_.targets[i]].sample;
    }
    const Node onwards = trace_once(kind, buffer_.layer, 0, rays, settled, true);
    if (!stream_.is_muted()) out_.continued += rays;

    ScatterLayers::Ports<float> scatter;
    scatter.hits.bind(slots.hits.data() + first);
    scatter.solid = solid;
    settled = before = launch<ScatterLayers>(scatter, rays, count);
    wait_each(settled, onwards);
    wait_all(settled, batch);
    items = scatter.layer_count.value;
  }
  return settled;
}

template <bool kColoured, bool kInstanced>
std::uint32_t Wavefront::test_layers(RayKind kind, RaySlots& slots, std::uint32_t first, std::uint32_t items,
                                     std::uint32_t lanes, Node& tested) {
  const auto bind = [&](LayerPorts<float, kColoured, kInstanced>& ports) {
    ports.rays.bind(slots.rays.data() + first);
    ports.hits.bind(slots.hits.data() + first);
    ports.next_rays.bind(buffer_.layer.rays.data());
    ports.epsilon = scene_.epsilon;
    ports.min_weight = scene_.min_weight;
    ports.white = scene_.image.white;
  };
  if (kind == RayKind::kShadow) {
    ShadowLayerPorts<float, kColoured, kInstanced> ports;
    bind(ports);
    ports.min_weight = scene_.min_weight * kLeastLight;
    ports.paths.bind(slots.paths.data() + first);
    tested = launch<TestShadow<kColoured, kInstanced>>(ports, items, lanes);
    return ports.emitted.value;
  }
  LayerPorts<float, kColoured, kInstanced> ports;
  bind(ports);
  tested = launch<TestAlpha<kColoured, kInstanced>>(ports, items, lanes);
  return ports.emitted.value;
}

}  // namespace kernels
