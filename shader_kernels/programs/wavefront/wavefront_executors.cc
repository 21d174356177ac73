#include "shader_kernels/programs/wavefront/wavefront.h"

namespace kernels {

using traces::RayKind;

void Wavefront::shade_background(const Bounce& bounce, std::uint32_t misses) {
  ShadeBackground::Ports<float> ports;
  ports.background = scene_.background;
  add_colours<ShadeBackground>(bounce, ports, misses);
}

Wavefront::Streams Wavefront::shade_surfaces(Bounce& bounce, std::uint32_t surfaces) {
  const Node fetched = scene_.image.has_levels() ? launch<ShadeSurface<true>>(surfaces, bounce.lanes)
                                                 : launch<ShadeSurface<false>>(surfaces, bounce.lanes);
  wait_for_bounce(fetched, bounce);

  Streams streams;
  if (scene_.has_details) {
    bounce.inspector = fetched;
    shade_details(bounce, surfaces, streams);
  }

  const Node before = bounce.inspector;
  classify_surfaces(bounce, surfaces, streams);
  scene_.has_details ? wait_all(bounce.inspector, before) : wait_each(bounce.inspector, fetched);
  return streams;
}

void Wavefront::classify_surfaces(Bounce& bounce, std::uint32_t surfaces, Streams& streams) {
  ClassifySurfaces::Ports<float> ports;
  bounce.inspector = launch<ClassifySurfaces>(ports, surfaces, bounce.lanes);
  streams.textured = ports.textured_count.value;
  streams.diffuse = ports.diffuse_count.value;
  streams.mirror = ports.mirror_count.value;
  streams.glass = ports.glass_count.value;
  streams.emissive = ports.emissive_count.value;
}

void Wavefront::shade_textured(Bounce& bounce, std::uint32_t items) {
  bounce.colours = launch<ShadeTextured>(items, bounce.lanes);
  wait_all(bounce.colours, bounce.inspector);
}

void Wavefront::shade_emission(const Bounce& bounce, std::uint32_t items) {
  ShadeEmission::Ports<float> ports;
  add_colours<ShadeEmission>(bounce, ports, items);
}

void Wavefront::shade_ambient(const Bounce& bounce, std::uint32_t items) {
  ShadeAmbient::Ports<float> ports;
  ports.ambient = scene_.ambient;
  add_colours<ShadeAmbient>(bounce, ports, items);
}

void Wavefront::shade_light(const Bounce& bounce, std::uint32_t light, std::uint32_t items) {
  buffer_.shadow.hold(std::size_t{items} + 1);
  ShadeDiffuse::Ports<float> ports;
  ports.light = scene_.lights[light];
  ports.epsilon = scene_.epsilon;
  const Node shaded = launch<ShadeDiffuse>(ports, items, bounce.lanes);
  wait_for_bounce(shaded, bounce);
  const std::uint32_t rays = ports.emitted.value;
  if (rays == 0) return;
  const Batch batch = trace(RayKind::kShadow, buffer_.shadow, 0, rays, shaded, true);

  const Node combined = launch<CombineShadow>(rays, bounce.lanes);
  wait_for_batch(combined, batch);
  buffer_.colour_nodes.push_back(combined);
  record_shadows(bounce, light, batch, rays);
}

}  // namespace kernels
