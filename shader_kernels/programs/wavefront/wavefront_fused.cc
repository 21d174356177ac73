#include <algorithm>
#include <type_traits>

#include "shader_kernels/programs/wavefront/wavefront.h"

namespace kernels {

using traces::RayKind;

/// Whether the bounce's surfaces are lit while they are fetched. Where a sample has two rays in one wave and surfaces
/// that come later, its lights would be added in another order.
bool Wavefront::lights_at_once(const Bounce& bounce) const {
  const bool has_light = !scene_.lights.empty() || scene_.occlusion_rays != 0;
  return is_shaded() && scene_.fuses && has_light && !rates(bounce) && (bounce.is_single || !scene_.has_later);
}

Wavefront::Streams Wavefront::light_surfaces(Bounce& bounce, std::uint32_t surfaces) {
  Streams streams;
  with_surfaces([&]<bool kInstanced, bool kCones> { light_surfaces<kInstanced, kCones>(bounce, surfaces, streams); });
  return streams;
}

template <bool kInstanced, bool kCones>
void Wavefront::light_surfaces(Bounce& bounce, std::uint32_t surfaces, Streams& streams) {
  const bool keeps_geometry = bounce.depth == 1 && retained_.geometry;
  const bool keeps_surface = bounce.depth == 1 && retained_.surfaces;
  const bool keeps_secondary = bounce.depth > 1 && retained_.secondary;
  if (!scene_.lights_as_usual()) return light_by_effects<kInstanced, kCones>(bounce, surfaces, streams);
  if (!scene_.has_details) {
    if (keeps_geometry) return light_with<FetchLitGeometry<kInstanced, kCones>>(bounce, surfaces, streams, true);
    if (keeps_surface) return light_with<FetchLitKept<kInstanced, kCones>>(bounce, surfaces, streams, true);
    if (keeps_secondary) return light_with<FetchLitSecondary<kInstanced, kCones>>(bounce, surfaces, streams, true);
    return light_with<FetchLit<kInstanced, kCones>>(bounce, surfaces, streams, false);
  }
  fetch_surfaces<kInstanced, kCones>(bounce, surfaces, streams);
  if (keeps_geometry) return light_with<LightSurfaceGeometry<kInstanced>>(bounce, surfaces, streams, true);
  if (keeps_surface) return light_with<LightSurfaceKept<kInstanced>>(bounce, surfaces, streams, true);
  if (keeps_secondary) return light_with<LightSurfaceSecondary<kInstanced>>(bounce, surfaces, streams, true);
  light_with<LightSurface>(bounce, surfaces, streams, false);
}

/// Fetches surfaces that may have details, and these.
template <bool kInstanced, bool kCones>
void Wavefront::fetch_surfaces(Bounce& bounce, std::uint32_t surfaces, Streams& streams) {
  buffer_.hold_details(bounce.rays);
  typename FetchSurface<kInstanced, kCones>::template Ports<float> ports;
  ports.cone = cone_;
  const Node fetched = launch<FetchSurface<kInstanced, kCones>>(ports, surfaces, bounce.lanes);
  wait_for_bounce(fetched, bounce);
  bounce.inspector = fetched;
  shade_details(bounce, ports_of<ClassifyDetails>(ports), streams);
}

template <bool kInstanced, bool kCones>
void Wavefront::light_by_effects(Bounce& bounce, std::uint32_t surfaces, Streams& streams) {
  const auto with = [&]<class Details, class Plain>(std::type_identity<Details>, std::type_identity<Plain>) {
    if (!scene_.has_details) return light_with<Plain>(bounce, surfaces, streams, false);
    fetch_surfaces<kInstanced, kCones>(bounce, surfaces, streams);
    light_with<Details>(bounce, surfaces, streams, false);
  };
  using std::type_identity;
  if (scene_.occlusion_rays != 0) {
    with(type_identity<LightSurfaceOcclusion>{}, type_identity<FetchLitOcclusion<kInstanced, kCones>>{});
  } else if (scene_.shadow_rays == 0) {
    with(type_identity<LightSurfaceOpen>{}, type_identity<FetchLitOpen<kInstanced, kCones>>{});
  } else {
    with(type_identity<LightSurfaceSoft>{}, type_identity<FetchLitSoft<kInstanced, kCones>>{});
  }
}

/// Gives a fused kernel ambient light and the first light, or the first rays for them.
template <class P>
void Wavefront::bind_first_light(P& ports) const {
  const auto if_part = [&]<class K>(std::type_identity<K>, auto&& bind) {
    if constexpr (std::is_base_of_v<typename K::template Ports<float>, P>) bind(ports_of<K>(ports));
  };
  if_part(std::type_identity<ShadeAmbient>{}, [&](auto& part) { part.ambient = scene_.ambient; });
  if_part(std::type_identity<ShadeDiffuse>{}, [&](auto& part) {
    part.light = scene_.lights.front();
    part.epsilon = scene_.epsilon;
  });
  if_part(std::type_identity<ShadeOpen>{}, [&](auto& part) { part.light = scene_.lights.front(); });
  if_part(std::type_identity<ShadeSoft>{}, [&](auto& part) { bind_soft(part, 0, 0); });
  if_part(std::type_identity<CastOcclusion>{}, [&](auto& part) { bind_occlusion(part, 0); });
}

/// Lights surfaces with kernel K and the first light, and keeps them, unless K does.
template <class K>
void Wavefront::light_with(Bounce& bounce, std::uint32_t surfaces, Streams& streams, bool has_records) {
  buffer_.shadow.hold(std::size_t{surfaces} + 1);
  typename K::template Ports<float> ports;
  bind_first_light(ports);
  if constexpr (requires { ports.bounce; }) ports.bounce = uniforms_of(bounce);
  if constexpr (requires { ports.cone; }) ports.cone = cone_;
  const Node lit = launch<K>(ports, surfaces, bounce.lanes);
  wait_for_bounce(lit, bounce);
  buffer_.colour_nodes.push_back(lit);
  bounce.inspector = lit;
  streams.take_lit(ports);

  std::uint32_t rays = 0;
  if constexpr (requires { ports.emitted; }) rays = ports.emitted.value;
  Batch batch;
  if (rays != 0) batch = trace(RayKind::kShadow, buffer_.shadow, 0, rays, lit, true);
  if (has_records) {
    wait_all(lit, bounce.depth == 1 ? retained_.cleared : retained_.cleared_secondary);
    buffer_.record_nodes.push_back(lit);
    bounce.recorded = lit;
  } else {
    record_hits(bounce, surfaces);
  }
  if (rays == 0) return;
  scene_.occlusion_rays != 0 ? combine(bounce, batch, rays) : combine_shadows(bounce, 0, batch, rays);
}

/// Ambient light and the first light of listed surfaces.
void Wavefront::light_later(const Bounce& bounce, std::vector<std::uint32_t>& stream, std::uint32_t items) {
  buffer_.shadow.hold(std::size_t{items} + 1);
  LightLater::Ports<float> ports;
  bind_first_light(ports);
  ShadeDiffuse::Ports<float>& first_light = ports_of<ShadeDiffuse>(ports);
  first_light.diffuse.bind(stream.data());
  ports_of<ShadeAmbient>(ports).diffuse.bind(stream.data());
  const Node lit = launch<LightLater>(ports, items, bounce.lanes);
  wait_for_bounce(lit, bounce);
  buffer_.colour_nodes.push_back(lit);
  const std::uint32_t rays = first_light.emitted.value;
  if (rays != 0) combine_shadows(bounce, 0, trace(RayKind::kShadow, buffer_.shadow, 0, rays, lit, true), rays);
}

Wavefront::Node Wavefront::generate_fused(GenerateListedRays::Ports<float>& ports, std::vector<std::uint32_t>& list,
                                          std::uint32_t items, RetainedRecords& retained, std::uint32_t lanes) {
  const auto launch_with = [&]<class K, class... Clear>(std::type_identity<K>, std::type_identity<Clear>...) {
    typename K::template Ports<float> fused;
    ports_of<GenerateListedRays>(fused) = ports;
    (ports_of<Clear>(fused).samples.bind(list.data()), ...);
    if constexpr (std::is_same_v<K, GenerateTraits>) {
      ports_of<ClearTraits>(fused).secondary.bind(buffer_.secondary_traits.data());
    }
    return launch<K>(fused, items, lanes);
  };
  using std::type_identity;
  const type_identity<ClearGeometry> geometry;
  Node node = kNone;
  if (retained.traits) {
    node = launch_with(type_identity<GenerateTraits>{}, type_identity<ClearTraits>{});
  } else if (retained.surfaces) {
    node = launch_with(type_identity<GenerateSurface>{}, type_identity<ClearSurface>{});
  } else if (retained.secondary) {
    node = launch_with(type_identity<GenerateSecondary>{}, geometry, type_identity<ClearSecondary>{});
  } else {
    node = launch_with(type_identity<GenerateGeometry>{}, geometry);
  }
  retained.cleared = retained.cleared_secondary = node;
  return node;
}

template <class K>
void Wavefront::interpolate_lit(typename K::template Ports<float>& ports, std::uint32_t items, std::uint32_t lanes,
                                Node after) {
  Bounce bounce;
  bounce.lanes = std::max(items, lanes);
  ports_of<ShadeAmbient>(ports).ambient = scene_.ambient;
  ports_of<ShadeVisible>(ports).light = scene_.lights.front();
  ports_of<ShadeVisible>(ports).mark = 1;
  bounce.inspector = launch<K>(ports, items, lanes);
  wait_all(bounce.inspector, after);
  adds_records(bounce.inspector);
  adds_colours(bounce.inspector);
  Streams streams;
  streams.take_lit(ports);
  classify_occluded(bounce, items, streams);
  shade_sorted(bounce, streams);
}
template void Wavefront::interpolate_lit<InterpolateLit<false>>(InterpolateLit<false>::Ports<float>& ports,
                                                                std::uint32_t items, std::uint32_t lanes, Node after);
template void Wavefront::interpolate_lit<InterpolateLit<true>>(InterpolateLit<true>::Ports<float>& ports,
                                                               std::uint32_t items, std::uint32_t lanes, Node after);

}  // namespace kernels
