#include <algorithm>

#include "shader_kernels/programs/wavefront/wavefront.h"

namespace kernels {

namespace {

/// Stands for a bounce's depth in a sum of hashes; the two lowest bits are left to what else is told apart.
std::uint32_t way_of(std::uint32_t depth) { return depth * 0x9e3779b9U; }

/// A light's bit; lights beyond 32 share them.
std::uint32_t bit_of(std::uint32_t light) { return 1U << (light % 32); }

}  // namespace

template <bool kInstanced>
Wavefront::Node Wavefront::record_branches(const Bounce& bounce, std::uint32_t surfaces) {
  const Node weighed = launch<WeighBranch>(bounce.rays);
  wait_all(weighed, bounce.inspector);
  wait_all(weighed, retained_.cleared);
  typename RecordBranch<kInstanced>::template Ports<float> ports;
  ports.traits.bind(buffer_.secondary_traits.data());
  const Node recorded = launch<RecordBranch<kInstanced>>(ports, surfaces, bounce.lanes);
  wait_all(recorded, weighed);
  return recorded;
}

void Wavefront::record_hits(Bounce& bounce, std::uint32_t surfaces) {
  bounce.recorded =
      scene_.image.has_levels() ? retain_hits<true>(bounce, surfaces) : retain_hits<false>(bounce, surfaces);
  if (bounce.recorded == StreamBuilder::kNone) return;
  wait_for_bounce(bounce.recorded, bounce);
  wait_all(bounce.recorded, bounce.depth == 1 ? retained_.cleared : retained_.cleared_secondary);
  buffer_.record_nodes.push_back(bounce.recorded);
}

/// The launch that keeps what samples hit, if any is wanted.
template <bool kInstanced>
Wavefront::Node Wavefront::retain_hits(const Bounce& bounce, std::uint32_t surfaces) {
  if (bounce.depth == 1 && retained_.geometry) return launch<RecordGeometry<kInstanced>>(surfaces, bounce.lanes);
  if (bounce.depth == 1 && retained_.surfaces) return launch<RecordSurface<kInstanced>>(surfaces, bounce.lanes);
  if (bounce.depth == 1 && retained_.traits) return launch<RecordTraits<kInstanced>>(surfaces, bounce.lanes);
  if (bounce.depth == 2 && retained_.traits) return record_branches<kInstanced>(bounce, surfaces);
  if (bounce.depth > 1 && retained_.secondary) {
    typename RecordSecondary<kInstanced>::template Ports<float> ports;
    ports.way = way_of(bounce.depth);
    ports.mirrored = bounce.mirrored;
    ports.refracted = bounce.refracted;
    ports.first = bounce.depth == 2 ? 1.0F : 0.0F;
    return launch<RecordSecondary<kInstanced>>(ports, surfaces, bounce.lanes);
  }
  return StreamBuilder::kNone;
}

template <class K>
Wavefront::Node Wavefront::record_shadows(auto* records, std::uint32_t mark, std::uint32_t rays, std::uint32_t lanes) {
  typename K::template Ports<float> ports;
  ports.records.bind(records);
  ports.mark = mark;
  return launch<K>(ports, rays, lanes);
}

Wavefront::Node Wavefront::record_branch_shadows(std::uint32_t rays, std::uint32_t lanes) {
  RecordBranchShadow::Ports<float> ports;
  ports.traits.bind(buffer_.secondary_traits.data());
  return launch<RecordBranchShadow>(ports, rays, lanes);
}

void Wavefront::record_shadows(const Bounce& bounce, std::uint32_t light, const Batch& batch, std::uint32_t rays) {
  Node node = StreamBuilder::kNone;
  if (bounce.depth == 1 && (retained_.geometry || retained_.surfaces)) {
    node = record_shadows<RecordShadow>(buffer_.geometry.data(), bit_of(light), rays, bounce.lanes);
  } else if (bounce.depth == 1 && retained_.traits) {
    node = record_shadows<RecordTraitsShadow>(buffer_.traits.data(), 1, rays, bounce.lanes);
  } else if (bounce.depth == 2 && retained_.traits) {
    node = record_branch_shadows(rays, bounce.lanes);
  } else if (bounce.depth > 1 && retained_.secondary) {
    const std::uint32_t mark = scrambled<float>(way_of(bounce.depth) ^ light);
    node = record_shadows<RecordSecondaryShadow>(buffer_.secondary.data(), mark, rays, bounce.lanes);
  } else {
    return;
  }
  wait_for_batch(node, batch);
  wait_all(node, bounce.recorded);
  buffer_.record_nodes.push_back(node);
}

/// Either side of local shading. Later bounces must not add to a sample before its second side is kept.
template <bool kAfter>
Wavefront::Node Wavefront::record_local(const Bounce& bounce, std::uint32_t items) {
  const Node node = launch<RecordLocal<kAfter>>(items, bounce.lanes);
  wait_for_bounce(node, bounce);
  wait_for_colours(node);
  if (!kAfter) wait_all(node, retained_.cleared);
  return node;
}
template Wavefront::Node Wavefront::record_local<false>(const Bounce& bounce, std::uint32_t items);
template Wavefront::Node Wavefront::record_local<true>(const Bounce& bounce, std::uint32_t items);

void Wavefront::shade_interpolated(Node maker, std::uint32_t items, std::uint32_t lanes) {
  Bounce bounce;
  bounce.lanes = std::max(items, lanes);
  Streams streams;
  classify_surfaces(bounce, items, streams);
  wait_all(bounce.inspector, maker);
  if (streams.textured != 0) shade_textured(bounce, streams.textured);
  if (streams.diffuse == 0) return;
  shade_ambient(bounce, streams.diffuse);
  ShadeVisible::Ports<float> ports;
  for (std::uint32_t light = 0; light < scene_.lights.size(); ++light) {
    ports.light = scene_.lights[light];
    ports.mark = bit_of(light);
    add_colours<ShadeVisible>(bounce, ports, streams.diffuse);
  }
}

}  // namespace kernels
