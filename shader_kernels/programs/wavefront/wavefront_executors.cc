#include "shader_kernels/programs/wavefront/wavefront.h"

namespace kernels {

using traces::RayKind;

void Wavefront::shade_background(const Bounce& bounce, std::uint32_t misses) {
  ShadeBackground::Ports<float> ports;
  ports.background = scene_.background;
  add_colours<ShadeBackground>(bounce, ports, misses);
}

Wavefront::Streams Wavefront::shade_surfaces(Bounce& bounce, std::uint32_t surfaces) {
  const Node fetched = with_surfaces([&]<bool kInstanced, bool kCones> {
    typename ShadeSurface<kInstanced, kCones>::template Ports<float> ports;
    ports.cone = cone_;
    return launch<ShadeSurface<kInstanced, kCones>>(ports, surfaces, bounce.lanes);
  });
  wait_for_bounce(fetched, bounce);

  Streams streams;
  if (scene_.has_details) {
    buffer_.hold_details(bounce.rays);
    ClassifyDetails::Ports<float> ports;
    bounce.inspector = launch<ClassifyDetails>(ports, surfaces);
    wait_each(bounce.inspector, fetched);
    shade_details(bounce, ports, streams);
  }

  const Node before = bounce.inspector;
  classify_surfaces(bounce, surfaces, streams);
  scene_.has_details ? wait_all(bounce.inspector, before) : wait_each(bounce.inspector, fetched);
  record_hits(bounce, surfaces);
  return streams;
}

void Wavefront::classify_surfaces(Bounce& bounce, std::uint32_t surfaces, Streams& streams) {
  ClassifySurfaces::Ports<float> ports;
  bounce.inspector = launch<ClassifySurfaces>(ports, surfaces, bounce.lanes);
  streams.take(ports);
}

void WaveStreams::take(const ClassifySurfaces::Ports<float>& sorted) {
  textured = sorted.textured_count.value;
  diffuse = sorted.diffuse_count.value;
  mirror = sorted.mirror_count.value;
  glass = sorted.glass_count.value;
  emissive = sorted.emissive_count.value;
}

void Wavefront::shade_textured(Bounce& bounce, std::uint32_t items) {
  bounce.colours = with_mips([&]<MipFilter kMips> { return launch<ShadeTextured<kMips>>(items, bounce.lanes); });
  wait_all(bounce.colours, bounce.inspector);
}

void Wavefront::shade_emission(const Bounce& bounce, std::uint32_t items) {
  ShadeEmission::Ports<float> ports;
  add_colours<ShadeEmission>(bounce, ports, items);
}

/// Shades diffuse surfaces. What comes first, ambient light and the first light's first ray, or the first occlusion
/// ray, those that are lit at once have had.
void Wavefront::shade_local(Bounce& bounce, const Streams& streams) {
  std::vector<std::uint32_t>& unlit = unlit_of(streams);
  const std::uint32_t items = streams.unlit();
  const bool keeps_local = retained_.surfaces && bounce.depth == 1;
  const auto lights = static_cast<std::uint32_t>(scene_.lights.size());
  const bool is_occluded = scene_.occlusion_rays != 0;
  const bool is_fused = scene_.lights_as_usual() && scene_.fuses && lights != 0 && streams.occluded == 0;
  // Surfaces that are lit at once had no colour before.
  if (keeps_local && items != 0) bounce.colours = record_local<false>(bounce, unlit, items);
  if (is_occluded) {
    cast_occlusion(bounce, 0, unlit, items);
    for (std::uint32_t ray = 1; ray < scene_.occlusion_rays; ++ray) {
      cast_occlusion(bounce, ray, buffer_.diffuse, streams.diffuse);
    }
  } else if (is_fused) {
    if (items != 0) light_later(bounce, unlit, items);
  } else {
    if (items != 0) shade_ambient(bounce, unlit, items);
    if (streams.occluded != 0) shade_occluded(bounce, streams.occluded);
  }
  for (std::uint32_t light = 0; light < lights; ++light) {
    for (std::uint32_t ray = 0; ray < scene_.rays_to_light(); ++ray) {
      const bool is_first = !is_occluded && light == 0 && ray == 0;
      if (is_first && is_fused) continue;
      shade_light(bounce, light, ray, is_first ? unlit : buffer_.diffuse, is_first ? items : streams.diffuse);
    }
  }
  if (keeps_local) bounce.after = record_local<true>(bounce, buffer_.diffuse, streams.diffuse);
}

void Wavefront::shade_ambient(const Bounce& bounce, std::vector<std::uint32_t>& stream, std::uint32_t items) {
  ShadeAmbient::Ports<float> ports;
  ports.diffuse.bind(stream.data());
  ports.ambient = scene_.ambient;
  add_colours<ShadeAmbient>(bounce, ports, items);
}

void Wavefront::shade_light(const Bounce& bounce, std::uint32_t light, std::uint32_t ray,
                            std::vector<std::uint32_t>& stream, std::uint32_t items) {
  if (items == 0) return;
  if (scene_.shadow_rays == 0) return shade_open(bounce, light, stream, items);
  if (!scene_.discs.empty()) return shade_soft(bounce, light, ray, stream, items);
  buffer_.shadow.hold(std::size_t{items} + 1);
  ShadeDiffuse::Ports<float> ports;
  ports.diffuse.bind(stream.data());
  ports.light = scene_.lights[light];
  ports.epsilon = scene_.epsilon;
  const Node shaded = launch<ShadeDiffuse>(ports, items, bounce.lanes);
  wait_for_bounce(shaded, bounce);
  const std::uint32_t rays = ports.emitted.value;
  if (rays == 0) return;
  combine_shadows(bounce, light, trace(RayKind::kShadow, buffer_.shadow, 0, rays, shaded, true), rays);
}

}  // namespace kernels
