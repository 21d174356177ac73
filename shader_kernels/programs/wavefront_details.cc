#include "shader_kernels/programs/wavefront.h"

namespace kernels {

/// What only some scenes have, before surfaces are sorted: the steps change places, base colours, optics and classes of
/// the surfaces in their streams. Each waits for the one before; `bounce.inspector` is the last.
void Wavefront::shade_details(Bounce& bounce, std::uint32_t surfaces, Streams& streams) {
  buffer_.hold_details(bounce.rays);
  ClassifyDetails::Ports<float> ports;
  ports.surfaces.bind(buffer_.surfaces.data());
  ports.mattes.bind(buffer_.mattes.data());
  ports.absorbing.bind(buffer_.absorbing.data());
  ports.vertexed.bind(buffer_.vertexed.data());
  ports.based.bind(buffer_.based.data());
  ports.physical.bind(buffer_.physical.data());
  ports.bumped.bind(buffer_.bumped.data());
  ports.blended.bind(buffer_.blended.data());
  ports.glowing.bind(buffer_.glowing.data());
  ports.occluded.bind(buffer_.occluded.data());
  const Node fetched = bounce.inspector;
  bounce.inspector = launch<ClassifyDetails>(ports, surfaces);
  wait_each(bounce.inspector, fetched);
  if (ports.absorbing_count.value != 0) absorb(bounce, ports.absorbing_count.value);
  if (ports.vertexed_count.value != 0) {
    scene_.image.has_levels() ? fetch_vertices<true>(bounce, ports.vertexed_count.value)
                              : fetch_vertices<false>(bounce, ports.vertexed_count.value);
  }
  if (ports.based_count.value != 0) shade_base(bounce, ports.based_count.value);
  if (ports.physical_count.value != 0) shade_physical(bounce, ports.physical_count.value);
  if (ports.bumped_count.value != 0) shade_bump(bounce, ports.bumped_count.value);
  if (ports.blended_count.value != 0) shade_blend(bounce, ports.blended_count.value);
  streams.blended = ports.blended_count.value;
  streams.glowing = ports.glowing_count.value;
  streams.occluded = ports.occluded_count.value;
}

void Wavefront::bind_details(DetailPorts<float>& ports, std::vector<std::uint32_t>& stream) {
  ports.stream.bind(stream.data());
  ports.mattes.bind(buffer_.mattes.data());
  ports.texcoords.bind(buffer_.texcoords.data());
  ports.tangents.bind(buffer_.tangents.data());
  ports.axes.bind(scene_.axes.data());
  ports.texels.bind(scene_.image.textures.data(), accesses());
}

void Wavefront::absorb(Bounce& bounce, std::uint32_t items) {
  Absorb::Ports<float> ports;
  ports.absorbing.bind(buffer_.absorbing.data());
  ports.places.bind(buffer_.places.data());
  ports.hits.bind(buffer_.wave.hits.data());
  ports.paths.bind(buffer_.wave.paths.data());
  ports.details.bind(scene_.image.details.data(), accesses());
  step<Absorb>(bounce, ports, items);
}

template <bool kInstanced>
void Wavefront::fetch_vertices(Bounce& bounce, std::uint32_t items) {
  typename FetchVertices<kInstanced>::template Ports<float> ports;
  ports.vertexed.bind(buffer_.vertexed.data());
  ports.hits.bind(buffer_.wave.hits.data());
  ports.mattes.bind(buffer_.mattes.data());
  ports.optics.bind(buffer_.optics.data());
  ports.tangents.bind(buffer_.tangents.data());
  ports.vertices.bind(scene_.image.vertices.data(), accesses());
  ports.instances.bind(scene_.image.instances.data(), accesses());
  step<FetchVertices<kInstanced>>(bounce, ports, items);
}

void Wavefront::shade_base(Bounce& bounce, std::uint32_t items) {
  ShadeBase::Ports<float> ports;
  bind_details(ports, buffer_.based);
  ports.optics.bind(buffer_.optics.data());
  step<ShadeBase>(bounce, ports, items);
}

void Wavefront::shade_physical(Bounce& bounce, std::uint32_t items) {
  ShadePhysical::Ports<float> ports;
  bind_details(ports, buffer_.physical);
  ports.places.bind(buffer_.places.data());
  ports.optics.bind(buffer_.optics.data());
  ports.details.bind(scene_.image.details.data(), accesses());
  step<ShadePhysical>(bounce, ports, items);
}

void Wavefront::shade_bump(Bounce& bounce, std::uint32_t items) {
  ShadeBump::Ports<float> ports;
  bind_details(ports, buffer_.bumped);
  ports.rays.bind(buffer_.wave.rays.data());
  ports.places.bind(buffer_.places.data());
  ports.details.bind(scene_.image.details.data(), accesses());
  step<ShadeBump>(bounce, ports, items);
}

void Wavefront::shade_blend(Bounce& bounce, std::uint32_t items) {
  ShadeBlend::Ports<float> ports;
  ports.blended.bind(buffer_.blended.data());
  ports.mattes.bind(buffer_.mattes.data());
  ports.optics.bind(buffer_.optics.data());
  step<ShadeBlend>(bounce, ports, items);
}

void Wavefront::shade_glow(const Bounce& bounce, std::uint32_t items) {
  ShadeGlow::Ports<float> ports;
  bind_details(ports, buffer_.glowing);
  ports.places.bind(buffer_.places.data());
  ports.paths.bind(buffer_.wave.paths.data());
  ports.optics.bind(buffer_.optics.data());
  ports.details.bind(scene_.image.details.data(), accesses());
  ports.colours.bind(buffer_.colours.data());
  add_colours<ShadeGlow>(bounce, ports, items);
}

void Wavefront::shade_occluded(const Bounce& bounce, std::uint32_t items) {
  ShadeOccluded::Ports<float> ports;
  bind_details(ports, buffer_.occluded);
  ports.places.bind(buffer_.places.data());
  ports.paths.bind(buffer_.wave.paths.data());
  ports.details.bind(scene_.image.details.data(), accesses());
  ports.colours.bind(buffer_.colours.data());
  ports.ambient = scene_.ambient;
  add_colours<ShadeOccluded>(bounce, ports, items);
}

}  // namespace kernels
