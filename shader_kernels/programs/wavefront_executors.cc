#include "shader_kernels/programs/wavefront.h"

namespace kernels {

using traces::RayKind;

void Wavefront::shade_background(const Bounce& bounce, std::uint32_t misses) {
  ShadeBackground::Ports<float> ports;
  ports.misses.bind(buffer_.misses.data());
  ports.paths.bind(buffer_.wave.paths.data());
  ports.colours.bind(buffer_.colours.data());
  ports.background = scene_.background;
  add_colours<ShadeBackground>(bounce, ports, misses);
}

template <bool kInstanced>
Wavefront::Node Wavefront::fetch_surfaces(const Bounce& bounce, std::uint32_t surfaces) {
  typename ShadeSurface<kInstanced>::template Ports<float> surface;
  surface.surfaces.bind(buffer_.surfaces.data());
  surface.rays.bind(buffer_.wave.rays.data());
  surface.hits.bind(buffer_.wave.hits.data());
  surface.attributes.bind(scene_.image.attributes.data(), accesses());
  surface.instances.bind(scene_.image.instances.data(), accesses());
  surface.materials.bind(scene_.image.materials.data(), accesses());
  surface.places.bind(buffer_.places.data());
  surface.mattes.bind(buffer_.mattes.data());
  surface.texcoords.bind(buffer_.texcoords.data());
  surface.optics.bind(buffer_.optics.data());
  return launch<ShadeSurface<kInstanced>>(surface, surfaces, bounce.lanes);
}

Wavefront::Streams Wavefront::shade_surfaces(Bounce& bounce, std::uint32_t surfaces) {
  const Node fetched =
      scene_.image.has_levels() ? fetch_surfaces<true>(bounce, surfaces) : fetch_surfaces<false>(bounce, surfaces);
  wait_for_bounce(fetched, bounce);

  Streams streams;
  if (scene_.has_details) {
    bounce.inspector = fetched;
    shade_details(bounce, surfaces, streams);
  }

  const Node before = bounce.inspector;
  const Streams classified = classify_surfaces(bounce, surfaces);
  scene_.has_details ? wait_all(bounce.inspector, before) : wait_each(bounce.inspector, fetched);
  streams.textured = classified.textured;
  streams.diffuse = classified.diffuse;
  streams.mirror = classified.mirror;
  streams.glass = classified.glass;
  streams.emissive = classified.emissive;
  return streams;
}

Wavefront::Streams Wavefront::classify_surfaces(Bounce& bounce, std::uint32_t surfaces) {
  ClassifySurfaces::Ports<float> ports;
  ports.surfaces.bind(buffer_.surfaces.data());
  ports.mattes.bind(buffer_.mattes.data());
  ports.textured.bind(buffer_.textured.data());
  ports.diffuse.bind(buffer_.diffuse.data());
  ports.mirror.bind(buffer_.mirror.data());
  ports.glass.bind(buffer_.glass.data());
  ports.emissive.bind(buffer_.emissive.data());
  bounce.inspector = launch<ClassifySurfaces>(ports, surfaces, bounce.lanes);
  Streams streams;
  streams.textured = ports.textured_count.value;
  streams.diffuse = ports.diffuse_count.value;
  streams.mirror = ports.mirror_count.value;
  streams.glass = ports.glass_count.value;
  streams.emissive = ports.emissive_count.value;
  return streams;
}

void Wavefront::shade_textured(Bounce& bounce, std::uint32_t items) {
  ShadeTextured::Ports<float> ports;
  ports.textured.bind(buffer_.textured.data());
  ports.texcoords.bind(buffer_.texcoords.data());
  ports.mattes.bind(buffer_.mattes.data());
  ports.axes.bind(scene_.axes.data());
  ports.texels.bind(scene_.image.textures.data(), accesses());
  bounce.colours = launch<ShadeTextured>(ports, items, bounce.lanes);
  wait_all(bounce.colours, bounce.inspector);
}

void Wavefront::shade_emission(const Bounce& bounce, std::uint32_t items) {
  ShadeEmission::Ports<float> ports;
  ports.emissive.bind(buffer_.emissive.data());
  ports.places.bind(buffer_.places.data());
  ports.paths.bind(buffer_.wave.paths.data());
  ports.optics.bind(buffer_.optics.data());
  ports.materials.bind(scene_.image.materials.data(), accesses());
  ports.colours.bind(buffer_.colours.data());
  add_colours<ShadeEmission>(bounce, ports, items);
}

void Wavefront::shade_ambient(const Bounce& bounce, std::uint32_t items) {
  ShadeAmbient::Ports<float> ports;
  ports.diffuse.bind(buffer_.diffuse.data());
  ports.paths.bind(buffer_.wave.paths.data());
  ports.mattes.bind(buffer_.mattes.data());
  ports.colours.bind(buffer_.colours.data());
  ports.ambient = scene_.ambient;
  add_colours<ShadeAmbient>(bounce, ports, items);
}

void Wavefront::shade_light(const Bounce& bounce, std::uint32_t light, std::uint32_t items) {
  buffer_.shadow.hold(std::size_t{items} + 1);
  ShadeDiffuse::Ports<float> ports;
  ports.diffuse.bind(buffer_.diffuse.data());
  ports.places.bind(buffer_.places.data());
  ports.paths.bind(buffer_.wave.paths.data());
  ports.mattes.bind(buffer_.mattes.data());
  ports.shadow_rays.bind(buffer_.shadow.rays.data());
  ports.shadow_paths.bind(buffer_.shadow.paths.data());
  ports.light = scene_.lights[light];
  ports.epsilon = scene_.epsilon;
  const Node shaded = launch<ShadeDiffuse>(ports, items, bounce.lanes);
  wait_for_bounce(shaded, bounce);
  const std::uint32_t rays = ports.emitted.value;
  if (rays == 0) return;
  const Batch batch = trace(RayKind::kShadow, buffer_.shadow, 0, rays, shaded, true);

  CombineShadow::Ports<float> combine;
  combine.shadow_hits.bind(buffer_.shadow.hits.data());
  combine.shadow_paths.bind(buffer_.shadow.paths.data());
  combine.colours.bind(buffer_.colours.data());
  const Node combined = launch<CombineShadow>(combine, rays, bounce.lanes);
  wait_for_batch(combined, batch);
  buffer_.colour_nodes.push_back(combined);
  record_shadows(bounce, light, batch, rays);
}

}  // namespace kernels
