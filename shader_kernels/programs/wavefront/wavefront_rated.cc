#include "shader_kernels/programs/wavefront/wavefront.h"

namespace kernels {

using traces::RayKind;

/// Fetches first hits that have no details, and keeps their geometry.
Wavefront::Streams Wavefront::fetch_visible(Bounce& bounce, std::uint32_t surfaces) {
  Streams streams;
  const Node fetched = with_surfaces([&]<bool kInstanced, bool kCones> {
    typename FetchVisible<kInstanced, kCones>::template Ports<float> ports;
    ports.eye = retained_.visible.eye;
    ports.cone = cone_;
    const Node node = launch<FetchVisible<kInstanced, kCones>>(ports, surfaces, bounce.lanes);
    streams.take(ports_of<ClassifySurfaces>(ports));
    return node;
  });
  wait_for_bounce(fetched, bounce);
  wait_all(fetched, retained_.cleared);
  buffer_.record_nodes.push_back(fetched);
  bounce.inspector = fetched;
  return streams;
}

/// Lists first hits that have rays for effects.
Wavefront::Selected Wavefront::select_effects(const Bounce& bounce, std::uint32_t items) {
  const auto select = [&]<bool kCheckerboard> {
    typename SelectEffects<kCheckerboard>::template Ports<float> ports;
    ports.grid = retained_.rated.grid;
    const Node node = launch<SelectEffects<kCheckerboard>>(ports, items, bounce.lanes);
    wait_for_bounce(node, bounce);
    return Selected{node, ports.passed_count.value};
  };
  return scene_.is_checkerboard ? select.template operator()<true>() : select.template operator()<false>();
}

/// Adds light that would come unstopped to what samples keep, instead of to their colours.
template <class K>
void Wavefront::keep_light(const Bounce& bounce, typename K::template Ports<float>& ports, std::uint32_t layer,
                           std::uint32_t items) {
  ports.colours.bind(buffer_.lights.data() + std::size_t{layer} * retained_.rated.layer);
  const Node node = launch<K>(ports, items, bounce.lanes);
  wait_for_bounce(node, bounce);
  wait_all(node, retained_.cleared);
  buffer_.record_nodes.push_back(node);
}

/// Traces rays of kernel K and adds what they bring to the samples' shares.
template <class K>
void Wavefront::find_share(const Bounce& bounce, typename K::template Ports<float>& ports, float share,
                           std::uint32_t layer, const Selected& selected) {
  if (selected.items == 0) return;
  buffer_.shadow.hold(std::size_t{selected.items} + 1);
  ports.diffuse.bind(buffer_.passed.data());
  const Node cast = launch<K>(ports, selected.items, bounce.lanes);
  wait_for_bounce(cast, bounce);
  wait_all(cast, selected.node);
  const std::uint32_t rays = ports.emitted.value;
  if (rays == 0) return;
  const Batch batch = trace(RayKind::kShadow, buffer_.shadow, 0, rays, cast, true);
  CombineRatio::Ports<float> combine;
  combine.ratios.bind(buffer_.ratios.data() + std::size_t{layer} * retained_.rated.layer);
  combine.share = share;
  const Node combined = launch<CombineRatio>(combine, rays, bounce.lanes);
  wait_for_batch(combined, batch);
  wait_all(combined, retained_.cleared);
  buffer_.record_nodes.push_back(combined);
}

/// Lights first hits. Of lights whose effects have a lower rate samples keep what would come unstopped, and some of
/// them find out by rays how much of it does.
void Wavefront::shade_rated(const Bounce& bounce, const Streams& streams) {
  const std::uint32_t items = streams.diffuse;
  const Selected selected = select_effects(bounce, items);
  std::uint32_t layer = 0;
  if (scene_.occlusion_rays != 0) {
    ShadeAmbient::Ports<float> ports;
    ports.ambient = scene_.ambient;
    keep_light<ShadeAmbient>(bounce, ports, layer, items);
    const float share = 1.0F / static_cast<float>(scene_.occlusion_rays);
    for (std::uint32_t ray = 0; ray < scene_.occlusion_rays; ++ray) {
      CastOcclusionShare::Ports<float> cast;
      cast.share = share;
      bind_occlusion(cast, ray);
      find_share<CastOcclusionShare>(bounce, cast, share, layer, selected);
    }
    ++layer;
  } else {
    shade_ambient(bounce, buffer_.diffuse, items);
    if (streams.occluded != 0) shade_occluded(bounce, streams.occluded);
  }
  for (std::uint32_t light = 0; light < scene_.lights.size(); ++light) {
    if (scene_.discs.empty()) {
      shade_light(bounce, light, 0, buffer_.diffuse, items);
      continue;
    }
    ShadeOpen::Ports<float> ports;
    ports.light = scene_.lights[light];
    keep_light<ShadeOpen>(bounce, ports, layer, items);
    for (std::uint32_t ray = 0; ray < scene_.shadow_rays; ++ray) {
      ShadeSoftShare::Ports<float> cast;
      bind_soft(cast, light, ray);
      find_share<ShadeSoftShare>(bounce, cast, cast.disc.share, layer, selected);
    }
    ++layer;
  }
}

}  // namespace kernels
