#include "shader_kernels/programs/wavefront.h"

#include <span>
#include <utility>

#include "traces/walk.h"

namespace kernels {

using traces::RayKind;

Wavefront::Wavefront(const SceneTables& scene, const traces::Tracer& tracer, bool record, TileResult& out)
    : scene_(scene), tracer_(tracer), out_(out), buffer_(out.buffer), stream_(out.work, record) {
  out.rays = {};
  out.traversal_steps = 0;
  buffer_.colour_nodes.clear();
}

void Wavefront::run(Node maker, std::uint32_t rays) {
  Bounce bounce{.rays = rays};
  buffer_.hold_wave(rays);
  bounce.batches[0] = trace(RayKind::kPrimary, buffer_.wave, 0, rays, maker, false);
  for (std::uint32_t depth = 1; bounce.rays != 0; ++depth) {
    const std::uint32_t surfaces = classify(bounce);
    if (surfaces < bounce.rays) shade_background(bounce, bounce.rays - surfaces);
    if (surfaces == 0) return;
    const Streams streams = shade_surfaces(bounce, surfaces);
    if (streams.textured != 0) shade_textured(bounce, streams.textured);
    if (streams.emissive != 0) shade_emission(bounce, streams.emissive);
    if (streams.diffuse != 0) {
      shade_ambient(bounce, streams.diffuse);
      for (const LightUniforms<float>& light : scene_.lights) shade_light(bounce, light, streams.diffuse);
    }
    if (depth == scene_.depth) return;
    bounce = send_on(bounce, streams);
  }
}

Wavefront::Node Wavefront::trace(RayKind kind, RaySlots& slots, std::uint32_t first, std::uint32_t count, Node maker,
                                 bool is_mapped) {
  if (count == 0) return StreamBuilder::kNone;
  const std::span<const traces::Ray> rays(slots.rays.data() + first, count);
  const std::span<traces::Hit> hits(slots.hits.data() + first, count);
  const std::size_t from_word = out_.work.walk.size();
  traces::WalkSink sink{out_.work.walk, out_.work.ray_begin};
  tracer_.trace(rays, kind, hits, stream_.is_on() ? &sink : nullptr);
  count_steps(from_word);
  const Node node = stream_.rays(kind, count, rays_traced_, maker, is_mapped);
  rays_traced_ += count;
  out_.rays[static_cast<std::size_t>(kind)] += count;
  return node;
}

void Wavefront::count_steps(std::size_t from_word) {
  const std::vector<std::uint32_t>& walk = out_.work.walk;
  for (std::size_t i = from_word; i < walk.size(); ++i) {
    const traces::StepKind step = traces::kind_of(walk[i]);
    if (step == traces::StepKind::kVisit) {
      ++out_.traversal_steps;
    } else if (step == traces::StepKind::kLeaf) {
      for (std::uint32_t phases = walk[++i]; phases != 0; phases >>= 4) ++out_.traversal_steps;
    }
  }
}

void Wavefront::wait_for_bounce(Node node, const Bounce& bounce) {
  wait_all(node, bounce.colours != StreamBuilder::kNone ? bounce.colours : bounce.inspector);
  // The rays are back long since; the edges say that their slots are still read.
  for (const Node batch : bounce.batches) wait_all(node, batch);
}

std::uint32_t Wavefront::classify(Bounce& bounce) {
  ClassifyHits::Ports<float> ports;
  ports.hits.bind(buffer_.wave.hits.data());
  ports.misses.bind(buffer_.misses.data());
  ports.surfaces.bind(buffer_.surfaces.data());
  bounce.inspector = launch<ClassifyHits>(ports, bounce.rays);
  bounce.colours = StreamBuilder::kNone;
  if (bounce.batches[1] == StreamBuilder::kNone) {
    wait_each(bounce.inspector, bounce.batches[0]);
  } else {
    for (const Node batch : bounce.batches) wait_all(bounce.inspector, batch);
  }
  return ports.surface_count.value;
}

void Wavefront::shade_background(const Bounce& bounce, std::uint32_t misses) {
  ShadeBackground::Ports<float> ports;
  ports.misses.bind(buffer_.misses.data());
  ports.paths.bind(buffer_.wave.paths.data());
  ports.colours.bind(buffer_.colours.data());
  ports.background = scene_.background;
  const Node node = launch<ShadeBackground>(ports, misses);
  wait_for_bounce(node, bounce);
  buffer_.colour_nodes.push_back(node);
}

Wavefront::Streams Wavefront::shade_surfaces(Bounce& bounce, std::uint32_t surfaces) {
  ShadeSurface::Ports<float> surface;
  surface.surfaces.bind(buffer_.surfaces.data());
  surface.rays.bind(buffer_.wave.rays.data());
  surface.hits.bind(buffer_.wave.hits.data());
  surface.attributes.bind(scene_.image.attributes.data(), accesses());
  surface.materials.bind(scene_.image.materials.data(), accesses());
  surface.places.bind(buffer_.places.data());
  surface.mattes.bind(buffer_.mattes.data());
  surface.texcoords.bind(buffer_.texcoords.data());
  const Node fetched = launch<ShadeSurface>(surface, surfaces);
  wait_for_bounce(fetched, bounce);

  ClassifySurfaces::Ports<float> ports;
  ports.surfaces.bind(buffer_.surfaces.data());
  ports.mattes.bind(buffer_.mattes.data());
  ports.textured.bind(buffer_.textured.data());
  ports.diffuse.bind(buffer_.diffuse.data());
  ports.mirror.bind(buffer_.mirror.data());
  ports.glass.bind(buffer_.glass.data());
  ports.emissive.bind(buffer_.emissive.data());
  bounce.inspector = launch<ClassifySurfaces>(ports, surfaces);
  wait_each(bounce.inspector, fetched);
  return {ports.textured_count.value, ports.diffuse_count.value, ports.mirror_count.value, ports.glass_count.value,
          ports.emissive_count.value};
}

void Wavefront::shade_textured(Bounce& bounce, std::uint32_t items) {
  ShadeTextured::Ports<float> ports;
  ports.textured.bind(buffer_.textured.data());
  ports.texcoords.bind(buffer_.texcoords.data());
  ports.mattes.bind(buffer_.mattes.data());
  ports.axes.bind(scene_.axes.data());
  ports.texels.bind(scene_.image.textures.data(), accesses());
  bounce.colours = launch<ShadeTextured>(ports, items);
  wait_all(bounce.colours, bounce.inspector);
}

void Wavefront::shade_emission(const Bounce& bounce, std::uint32_t items) {
  ShadeEmission::Ports<float> ports;
  ports.emissive.bind(buffer_.emissive.data());
  ports.places.bind(buffer_.places.data());
  ports.paths.bind(buffer_.wave.paths.data());
  ports.materials.bind(scene_.image.materials.data(), accesses());
  ports.colours.bind(buffer_.colours.data());
  const Node node = launch<ShadeEmission>(ports, items);
  wait_for_bounce(node, bounce);
  buffer_.colour_nodes.push_back(node);
}

void Wavefront::shade_ambient(const Bounce& bounce, std::uint32_t items) {
  ShadeAmbient::Ports<float> ports;
  ports.diffuse.bind(buffer_.diffuse.data());
  ports.paths.bind(buffer_.wave.paths.data());
  ports.mattes.bind(buffer_.mattes.data());
  ports.colours.bind(buffer_.colours.data());
  ports.ambient = scene_.ambient;
  const Node node = launch<ShadeAmbient>(ports, items);
  wait_for_bounce(node, bounce);
  buffer_.colour_nodes.push_back(node);
}

void Wavefront::shade_light(const Bounce& bounce, const LightUniforms<float>& light, std::uint32_t items) {
  buffer_.shadow.hold(std::size_t{items} + 1);
  ShadeDiffuse::Ports<float> ports;
  ports.diffuse.bind(buffer_.diffuse.data());
  ports.places.bind(buffer_.places.data());
  ports.paths.bind(buffer_.wave.paths.data());
  ports.mattes.bind(buffer_.mattes.data());
  ports.shadow_rays.bind(buffer_.shadow.rays.data());
  ports.shadow_paths.bind(buffer_.shadow.paths.data());
  ports.light = light;
  ports.epsilon = scene_.epsilon;
  const Node shaded = launch<ShadeDiffuse>(ports, items);
  wait_for_bounce(shaded, bounce);
  const std::uint32_t rays = ports.emitted.value;
  if (rays == 0) return;
  const Node batch = trace(RayKind::kShadow, buffer_.shadow, 0, rays, shaded, true);

  CombineShadow::Ports<float> combine;
  combine.shadow_hits.bind(buffer_.shadow.hits.data());
  combine.shadow_paths.bind(buffer_.shadow.paths.data());
  combine.colours.bind(buffer_.colours.data());
  const Node combined = launch<CombineShadow>(combine, rays);
  wait_each(combined, batch);
  buffer_.colour_nodes.push_back(combined);
}

template <class K>
std::uint32_t Wavefront::send(const Bounce& bounce, RayKind kind, std::vector<std::uint32_t>& stream,
                              std::uint32_t items, std::uint32_t first, Node& batch) {
  if (items == 0) return 0;
  RaySlots& next = buffer_.next_wave;
  typename K::template Ports<float> ports;
  ports.stream.bind(stream.data());
  ports.places.bind(buffer_.places.data());
  ports.rays.bind(buffer_.wave.rays.data());
  ports.paths.bind(buffer_.wave.paths.data());
  ports.materials.bind(scene_.image.materials.data(), accesses());
  ports.next_rays.bind(next.rays.data() + first);
  ports.next_paths.bind(next.paths.data() + first);
  ports.epsilon = scene_.epsilon;
  ports.min_weight = scene_.min_weight;
  const Node maker = launch<K>(ports, items);
  wait_for_bounce(maker, bounce);
  batch = trace(kind, next, first, ports.emitted.value, maker, true);
  return ports.emitted.value;
}

Wavefront::Bounce Wavefront::send_on(const Bounce& bounce, const Streams& streams) {
  buffer_.next_wave.hold(std::size_t{streams.mirror} + streams.glass + 1);
  Bounce from = bounce;
  from.colours = StreamBuilder::kNone;  // mirrors and glass do not look at base colours
  Bounce next;
  next.rays = send<ShadeMirror>(from, RayKind::kReflection, buffer_.mirror, streams.mirror, 0, next.batches[0]);
  Node& refraction = next.batches[next.batches[0] == StreamBuilder::kNone ? 0 : 1];
  next.rays += send<ShadeGlass>(from, RayKind::kRefraction, buffer_.glass, streams.glass, next.rays, refraction);
  std::swap(buffer_.wave, buffer_.next_wave);
  buffer_.hold_wave(next.rays);
  return next;
}

void Wavefront::wait_for_colours(Node node) {
  for (const Node adder : buffer_.colour_nodes) wait_all(node, adder);
}

void Wavefront::transfer(std::uint32_t bytes, Node maker) {
  const Node node = stream_.transfer(bytes);
  wait_all(node, maker);
}

}  // namespace kernels
