#include "shader_kernels/programs/wavefront.h"

#include <span>
#include <utility>

#include "traces/walk.h"

namespace kernels {

using traces::RayKind;

Wavefront::Wavefront(const SceneTables& scene, const traces::Tracer& tracer, bool record, TileResult& out)
    : scene_(scene),
      tracer_(tracer),
      out_(out),
      buffer_(out.buffer),
      stream_(out.work, out.buffer.spare_nodes, record) {
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
