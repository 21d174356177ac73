#include "shader_kernels/programs/wavefront/wavefront.h"

#include <algorithm>
#include <iterator>
#include <span>
#include <utility>

#include "traces/walk_steps.h"

namespace kernels {

using traces::RayKind;

Wavefront::Wavefront(const SceneTables& scene, const traces::Tracer& tracer, bool record,
                     const ConeUniforms<float>& cone, TileResult& out)
    : scene_(scene),
      tracer_(tracer),
      out_(out),
      buffer_(out.buffer),
      sources_(scene, out),
      stream_(out.work, out.buffer.spare_nodes, record),
      cone_(cone) {
  out.rays = {};
  out.continued = 0;
  out.traversal_steps = out.triangle_tests = 0;
  out.pixel_work.clear();
  buffer_.pixel_work.clear();
  out.background.clear();
  buffer_.colour_nodes.clear();
  buffer_.record_nodes.clear();
}

void Wavefront::run(Node maker, std::uint32_t rays, const RetainedRecords& retained, std::uint32_t lanes,
                    std::uint32_t padding) {
  retained_ = retained;
  Bounce bounce;
  bounce.rays = rays;
  bounce.lanes = std::max(rays, lanes);
  bounce.padding = padding;
  buffer_.hold_wave(rays);
  bounce.batches[bounce.batch_count++] = see(rays, maker);
  while (bounce.rays != 0) {
    const std::uint32_t surfaces = classify(bounce);
    if (surfaces < bounce.rays && is_shaded()) shade_background(bounce, bounce.rays - surfaces);
    if (surfaces == 0) return;
    const Streams streams = lights_at_once(bounce)                                 ? light_surfaces(bounce, surfaces)
                            : rates(bounce) && scene_.fuses && !scene_.has_details ? fetch_visible(bounce, surfaces)
                                                                                   : shade_surfaces(bounce, surfaces);
    is_shaded() ? shade(bounce, streams) : cast_shadows(bounce, streams);
    if (bounce.depth == std::min(scene_.depth, retained_.visible.depth)) return;
    bounce = send_on(bounce, streams);
  }
}

void Wavefront::shade(Bounce& bounce, const Streams& streams) {
  if (streams.textured != 0) shade_textured(bounce, streams.textured);
  if (streams.emissive != 0) shade_emission(bounce, streams.emissive);
  if (streams.glowing != 0) shade_glow(bounce, streams.glowing);
  if (streams.diffuse != 0) rates(bounce) ? shade_rated(bounce, streams) : shade_local(bounce, streams);
}

Wavefront::Batch Wavefront::trace(RayKind kind, RaySlots& slots, std::uint32_t first, std::uint32_t count, Node maker,
                                  bool is_mapped) {
  Batch batch{trace_once(kind, slots, first, count, maker, is_mapped)};
  if (kind == RayKind::kShadow ? scene_.has_shades : scene_.has_alpha) {
    batch.settled = settle(kind, slots, first, count, batch.rays);
  }
  return batch;
}

Wavefront::Batch Wavefront::see(std::uint32_t count, Node maker) {
  RaySlots& wave = buffer_.wave;
  if (out_.rasteriser == nullptr) return trace(RayKind::kPrimary, wave, 0, count, maker, false);
  // Whoever makes the work, hits are the tracer's.
  tracer_.trace({wave.rays.data(), count}, RayKind::kPrimary, {wave.hits.data(), count}, nullptr);
  Batch batch;
  if (stream_.is_on()) {
    out_.rasteriser->cover({wave.rays.data(), count}, buffer_.coverage, &out_.work);
    batch.rays = stream_.raster(count, maker);
  }
  if (scene_.has_alpha) batch.settled = settle(RayKind::kPrimary, wave, 0, count, batch.rays);
  return batch;
}

Wavefront::Node Wavefront::trace_once(RayKind kind, RaySlots& slots, std::uint32_t first, std::uint32_t count,
                                      Node maker, bool is_mapped) {
  const std::size_t first_ray = out_.work.ray_begin.size();
  traces::WalkSink sink{out_.work.walk, out_.work.ray_begin};
  tracer_.trace(std::span(slots.rays).subspan(first, count), kind, std::span(slots.hits).subspan(first, count),
                stream_.is_on() ? &sink : nullptr);
  if (stream_.is_muted()) return StreamBuilder::kNone;
  count_walks(first_ray, std::span(slots.paths).subspan(first, count));
  const Node node = stream_.rays(kind, count, rays_traced_, maker, is_mapped);
  rays_traced_ += count;
  out_.rays[static_cast<std::size_t>(kind)] += count;
  return node;
}

/// Counts the steps of the tile's last rays, for the samples that they belong to, too.
void Wavefront::count_walks(std::size_t first_ray, std::span<const PathRecord<float>> paths) {
  const std::span walk(out_.work.walk);
  const std::vector<std::uint32_t>& begin = out_.work.ray_begin;
  if (first_ray == begin.size()) return;  // a tracer without walks
  if (!counts_pixels()) {
    const traces::WalkSteps steps = traces::count_steps(walk.subspan(begin[first_ray]));
    out_.traversal_steps += steps.all();
    out_.triangle_tests += steps.tests;
    return;
  }
  for (std::size_t ray = first_ray; ray < begin.size(); ++ray) {
    const std::size_t end = ray + 1 == begin.size() ? walk.size() : begin[ray + 1];
    const traces::WalkSteps steps = traces::count_steps(walk.subspan(begin[ray], end - begin[ray]));
    PixelWork& work = buffer_.pixel_work[paths[ray - first_ray].sample];
    work.rays += 1;
    work.steps += static_cast<std::uint32_t>(steps.all());
    work.tests += static_cast<std::uint32_t>(steps.tests);
    out_.traversal_steps += steps.all();
    out_.triangle_tests += steps.tests;
  }
}

/// Numbers of samples are used again by those of other pixels.
void Wavefront::place(std::uint32_t sample, std::uint32_t x, std::uint32_t y) {
  if (buffer_.pixel_work.size() <= sample) buffer_.pixel_work.resize(std::size_t{sample} + 1);
  PixelWork& work = buffer_.pixel_work[sample];
  if (work.rays != 0) out_.pixel_work.push_back(work);
  work = {.pixel = y * scene_.width + x};
}

void Wavefront::finish() {
  stream_.finish();
  std::ranges::copy_if(buffer_.pixel_work, std::back_inserter(out_.pixel_work),
                       [](const PixelWork& work) { return work.rays != 0; });
}

void Wavefront::wait_for_bounce(Node node, const Bounce& bounce) {
  wait_all(node, bounce.colours != StreamBuilder::kNone ? bounce.colours : bounce.inspector);
  // The rays are back long since; the edges say that their slots are still read.
  for (const Batch& batch : bounce.batches) wait_all(node, batch.rays);
  if (bounce.depth > 1) wait_all(node, bounce.after);
}

void Wavefront::wait_for_batch(Node node, const Batch& batch) {
  if (batch.settled == StreamBuilder::kNone) {
    wait_each(node, batch.rays);
  } else {
    wait_all(node, batch.rays);
    wait_all(node, batch.settled);
  }
}

std::uint32_t Wavefront::classify(Bounce& bounce) {
  ClassifyHits::Ports<float> ports;
  bounce.inspector = launch<ClassifyHits>(ports, bounce.rays, bounce.lanes, bounce.padding);
  bounce.colours = StreamBuilder::kNone;
  wait_all(bounce.inspector, bounce.begun);
  if (bounce.batch_count == 1 && bounce.batches[0].settled == StreamBuilder::kNone) {
    wait_each(bounce.inspector, bounce.batches[0].rays);
  } else {
    for (const Batch& batch : bounce.batches) {
      wait_all(bounce.inspector, batch.rays);
      wait_all(bounce.inspector, batch.settled);
    }
  }
  if (bounce.depth == 1 && !stream_.is_muted()) {
    for (std::uint32_t i = 0; i < ports.miss_count.value; ++i) {
      out_.background.push_back(buffer_.wave.paths[buffer_.misses[i]].sample);
    }
  }
  return ports.surface_count.value;
}

template <class K>
void Wavefront::send(const Bounce& bounce, RayKind kind, std::vector<std::uint32_t>& stream, std::uint32_t items,
                     Bounce& next) {
  if (items == 0) return;
  RaySlots& slots = buffer_.next_wave;
  typename K::template Ports<float> ports;
  ports.stream.bind(stream.data());
  ports.next_rays.bind(slots.rays.data() + next.rays);
  ports.next_paths.bind(slots.paths.data() + next.rays);
  ports.epsilon = scene_.epsilon;
  ports.min_weight = scene_.min_weight;
  const Node maker = launch<K>(ports, items, bounce.lanes);
  wait_for_bounce(maker, bounce);
  const std::uint32_t rays = ports.emitted.value;
  if (rays == 0) return;
  next.batches[next.batch_count++] = trace(kind, slots, next.rays, rays, maker, true);  // right behind its maker
  const std::uint32_t apart = bounce.depth == 1 ? retained_.visible.apart(kind) : 0;
  if (apart != 0) begin_branch(next, rays, apart, maker);
  next.rays += rays;
  next.lanes += bounce.lanes;
}

Wavefront::Bounce Wavefront::send_on(const Bounce& bounce, const Streams& streams) {
  buffer_.next_wave.hold(std::size_t{streams.blended} + streams.mirror + streams.glass + 1);
  Bounce from = bounce;
  from.colours = StreamBuilder::kNone;  // what is sent on does not look at base colours
  Bounce next;
  next.depth = bounce.depth + 1;
  next.after = bounce.after;
  send<ShadeStraight>(from, RayKind::kRefraction, buffer_.blended, streams.blended, next);
  next.mirrored = next.rays;
  if (scene_.effects.has(Effect::kReflections)) {
    send<ShadeMirror>(from, RayKind::kReflection, buffer_.mirror, streams.mirror, next);
  }
  next.refracted = next.rays;
  if (scene_.effects.has(Effect::kRefractions)) {
    send<ShadeGlass>(from, RayKind::kRefraction, buffer_.glass, streams.glass, next);
  }
  next.is_single = bounce.is_single && next.batch_count < 2;
  std::swap(buffer_.wave, buffer_.next_wave);
  buffer_.hold_wave(next.rays);
  return next;
}

void Wavefront::wait_for_colours(Node node) {
  for (const Node adder : buffer_.colour_nodes) wait_all(node, adder);
}

void Wavefront::wait_for_records(Node node) {
  for (const Node adder : buffer_.record_nodes) wait_all(node, adder);
}

Wavefront::Node Wavefront::put_linear(std::uint64_t offset) {
  const auto pixels = static_cast<std::uint32_t>(out_.linear.size());
  PackColour::Ports<float> ports;
  sources_.bind<PackColour>(ports, nullptr);
  for (std::uint32_t i = 0; i < pixels; ++i) PackColour::body<float>(i, ports);
  return transfer(traces::Region::kPicture, true, offset, pixels * kPixelBytes);
}

void Wavefront::put_out(Node averaged, std::uint64_t offset) {
  if (scene_.dma_encodes) return wait_all(put_linear(offset), averaged);
  const auto pixels = static_cast<std::uint32_t>(out_.linear.size());
  const Node packed = launch<PackColour>(pixels);
  wait_all(packed, averaged);
  put_packed(packed, offset);
}

void Wavefront::put_packed(Node packed, std::uint64_t offset) {
  const auto bytes = static_cast<std::uint32_t>(out_.linear.size()) * kPixelBytes;
  wait_all(transfer(traces::Region::kPicture, true, offset, bytes), packed);
}

Wavefront::Node Wavefront::transfer(traces::Region region, bool to_memory, std::uint64_t offset, std::uint32_t bytes) {
  return stream_.transfer(region, to_memory, offset, bytes);
}

Wavefront::Node Wavefront::export_border(std::uint32_t number, std::uint64_t offset, std::uint32_t bytes) {
  return stream_.export_border(number, offset, bytes);
}

void Wavefront::export_samples(std::uint32_t number, std::uint64_t offset, std::uint32_t bytes) {
  const Node node = export_border(number, offset, bytes);
  wait_for_records(node);
  wait_for_colours(node);
}

void Wavefront::import_samples(traces::Border border, std::uint64_t offset, std::uint32_t bytes) {
  const Node node = import_border(border, offset, bytes);
  adds_records(node);
  adds_colours(node);
}

}  // namespace kernels
