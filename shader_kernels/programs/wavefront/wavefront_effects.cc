#include "shader_kernels/programs/wavefront/wavefront.h"

namespace kernels {

using traces::RayKind;

namespace {

/// Tells rays that occlude ambient light from those to a light, in seeds.
constexpr std::uint32_t kAmbientSeed = 0x9e3779b9U;

/// The n-th of `count` points that lie evenly in the unit square (Hammersley).
DrawUniforms<float> draw(std::uint32_t n, std::uint32_t count, std::uint32_t seed) {
  std::uint32_t mirrored = 0;
  for (std::uint32_t bit = 0; bit < 32; ++bit) mirrored |= (n >> bit & 1U) << (31 - bit);
  return {(static_cast<float>(n) + 0.5F) / static_cast<float>(count), unit_float<float>(mirrored), seed};
}

}  // namespace

void Wavefront::bind_occlusion(CastAmbientPorts<float>& ports, std::uint32_t ray) const {
  ports.ambient = scene_.ambient * (1.0F / static_cast<float>(scene_.occlusion_rays));
  ports.epsilon = scene_.epsilon;
  ports.distance = scene_.occlusion_distance;
  ports.draw = draw(ray, scene_.occlusion_rays, scrambled<float>(jitter_seed(out_.work.frame) ^ kAmbientSeed));
}

void Wavefront::bind_soft(ShadeSoft::Ports<float>& ports, std::uint32_t light, std::uint32_t ray) const {
  ports.light = scene_.lights[light];
  ports.epsilon = scene_.epsilon;
  ports.disc = scene_.discs[light];
  ports.draw = draw(ray, scene_.shadow_rays, scrambled<float>(jitter_seed(out_.work.frame) + light));
}

/// Ambient light by rays, each of which brings its share if nothing is near.
void Wavefront::cast_occlusion(const Bounce& bounce, std::uint32_t ray, std::vector<std::uint32_t>& stream,
                               std::uint32_t items) {
  if (items == 0) return;
  buffer_.shadow.hold(std::size_t{items} + 1);
  CastOcclusion::Ports<float> ports;
  ports.diffuse.bind(stream.data());
  bind_occlusion(ports, ray);
  const Node cast = launch<CastOcclusion>(ports, items, bounce.lanes);
  wait_for_bounce(cast, bounce);
  const std::uint32_t rays = ports.emitted.value;
  if (rays != 0) combine(bounce, trace(RayKind::kShadow, buffer_.shadow, 0, rays, cast, true), rays);
}

void Wavefront::shade_open(const Bounce& bounce, std::uint32_t light, std::vector<std::uint32_t>& stream,
                           std::uint32_t items) {
  ShadeOpen::Ports<float> ports;
  ports.diffuse.bind(stream.data());
  ports.light = scene_.lights[light];
  add_colours<ShadeOpen>(bounce, ports, items);
}

void Wavefront::shade_soft(const Bounce& bounce, std::uint32_t light, std::uint32_t ray,
                           std::vector<std::uint32_t>& stream, std::uint32_t items) {
  buffer_.shadow.hold(std::size_t{items} + 1);
  ShadeSoft::Ports<float> ports;
  ports.diffuse.bind(stream.data());
  bind_soft(ports, light, ray);
  const Node shaded = launch<ShadeSoft>(ports, items, bounce.lanes);
  wait_for_bounce(shaded, bounce);
  const std::uint32_t rays = ports.emitted.value;
  if (rays != 0) combine_shadows(bounce, light, trace(RayKind::kShadow, buffer_.shadow, 0, rays, shaded, true), rays);
}

}  // namespace kernels
