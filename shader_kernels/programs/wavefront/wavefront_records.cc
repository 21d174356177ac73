#include <algorithm>
#include <type_traits>

#include "shader_kernels/programs/wavefront/wavefront.h"

namespace kernels {

namespace {

/// Stands for a bounce's depth in a sum of hashes; the two lowest bits are left to what else is told apart.
std::uint32_t way_of(std::uint32_t depth) { return depth * 0x9e3779b9U; }

/// A light's bit; lights beyond 32 share them.
std::uint32_t bit_of(std::uint32_t light) { return 1U << (light % 32); }

/// Says in which pixels the primary rays of listed samples lie.
void place_listed(Wavefront& wave, const GridUniforms<float>& grid, std::span<const std::uint32_t> list) {
  if (!wave.counts_pixels()) return;
  const auto pitch = static_cast<std::uint32_t>(grid.pitch), side = static_cast<std::uint32_t>(grid.grid);
  const auto x0 = static_cast<std::int32_t>(grid.x0), y0 = static_cast<std::int32_t>(grid.y0);
  for (std::uint32_t i = 0; i < list.size(); ++i) {
    const auto column = static_cast<std::int32_t>(list[i] % pitch), row = static_cast<std::int32_t>(list[i] / pitch);
    wave.place_ray(i, static_cast<std::uint32_t>(x0 + column) / side, static_cast<std::uint32_t>(y0 + row) / side);
  }
}

}  // namespace

Wavefront::Node Wavefront::generate(GenerateListedRays::Ports<float>& ports, std::vector<std::uint32_t>& list,
                                    Node lister, std::uint32_t items, RetainedRecords& retained, std::uint32_t lanes) {
  const bool has_records = retained.geometry || retained.surfaces || retained.traits;
  ports.samples.bind(list.data());
  Node generated = kNone;
  if (scene_.fuses && has_records) {
    generated = generate_fused(ports, list, items, retained, lanes);
    place_listed(*this, ports.grid, std::span(list).first(items));
    wait_all(generated, lister);
    adds_records(generated);
    return generated;
  }
  generated = launch<GenerateListedRays>(ports, items, lanes);
  place_listed(*this, ports.grid, std::span(list).first(items));
  wait_all(generated, lister);
  const auto clear = [&]<class K>(std::type_identity<K>) {
    typename K::template Ports<float> cleared;
    cleared.samples.bind(list.data());
    if constexpr (std::is_same_v<K, ClearTraits>) cleared.secondary.bind(buffer_.secondary_traits.data());
    const Node node = launch<K>(cleared, items, lanes);
    wait_all(node, lister);
    adds_records(node);
    return node;
  };
  if (retained.surfaces) retained.cleared = clear(std::type_identity<ClearSurface>{});
  if (retained.geometry) retained.cleared = clear(std::type_identity<ClearGeometry>{});
  if (retained.traits) retained.cleared = clear(std::type_identity<ClearTraits>{});
  if (retained.secondary) retained.cleared_secondary = clear(std::type_identity<ClearSecondary>{});
  return generated;
}

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

BounceUniforms<float> Wavefront::uniforms_of(const Bounce& bounce) {
  return {way_of(bounce.depth), bounce.mirrored, bounce.refracted, bounce.depth == 2 ? 1.0F : 0.0F};
}

/// The launch that keeps what samples hit, if any is wanted.
template <bool kInstanced>
Wavefront::Node Wavefront::retain_hits(const Bounce& bounce, std::uint32_t surfaces) {
  if (retained_.visible.are_kept) return record_visible(bounce, surfaces);
  if (bounce.depth == 1 && retained_.geometry) return launch<RecordGeometry<kInstanced>>(surfaces, bounce.lanes);
  if (bounce.depth == 1 && retained_.surfaces) return launch<RecordSurface<kInstanced>>(surfaces, bounce.lanes);
  if (bounce.depth == 1 && retained_.traits) return launch<RecordTraits<kInstanced>>(surfaces, bounce.lanes);
  if (bounce.depth == 2 && retained_.traits) return record_branches<kInstanced>(bounce, surfaces);
  if (bounce.depth > 1 && retained_.secondary) {
    typename RecordSecondary<kInstanced>::template Ports<float> ports;
    ports.bounce = uniforms_of(bounce);
    return launch<RecordSecondary<kInstanced>>(ports, surfaces, bounce.lanes);
  }
  return StreamBuilder::kNone;
}

/// Adds the light of shadow rays to their samples alone.
void Wavefront::combine(const Bounce& bounce, const Batch& batch, std::uint32_t rays) {
  const Node combined = launch<CombineShadow>(rays, bounce.lanes);
  wait_for_batch(combined, batch);
  buffer_.colour_nodes.push_back(combined);
}

/// Keeps what shadow rays found with kernel K, of which Record is a part.
template <class Record, class K>
Wavefront::Node Wavefront::record_shadows(const Bounce& bounce, const Batch& batch, std::uint32_t rays, auto&& bind) {
  typename K::template Ports<float> ports;
  bind(ports_of<Record>(ports));
  const Node recorded = launch<K>(ports, rays, bounce.lanes);
  wait_for_batch(recorded, batch);
  wait_all(recorded, bounce.recorded);
  buffer_.record_nodes.push_back(recorded);
  return recorded;
}

template <class Record, class Both>
void Wavefront::combine_and_record(const Bounce& bounce, const Batch& batch, std::uint32_t rays, auto&& bind) {
  if (scene_.fuses) {
    buffer_.colour_nodes.push_back(record_shadows<Record, Both>(bounce, batch, rays, bind));
  } else {
    combine(bounce, batch, rays);
    record_shadows<Record>(bounce, batch, rays, bind);
  }
}

/// Adds the light of shadow rays to their samples, and to what these keep whether they were stopped.
void Wavefront::combine_shadows(const Bounce& bounce, std::uint32_t light, const Batch& batch, std::uint32_t rays) {
  const auto kept_as = [](auto* records, std::uint32_t mark) {
    return [=](auto& ports) {
      ports.records.bind(records);
      ports.mark = mark;
    };
  };
  const VisibleSamples& visible = retained_.visible;
  if (visible.are_kept && visible.have_shadows && (bounce.depth == 1 || visible.keeps_branch(bounce.depth))) {
    const auto bind = kept_as(buffer_.visible.data(), bit_of(light));
    visible.are_shaded ? combine_and_record<RecordVisibleShadow, CombineRecordVisibleShadow>(bounce, batch, rays, bind)
                       : void(record_shadows<RecordVisibleShadow>(bounce, batch, rays, bind));
  } else if (bounce.depth == 1 && (retained_.geometry || retained_.surfaces)) {
    const auto bind = kept_as(buffer_.geometry.data(), bit_of(light));
    combine_and_record<RecordShadow, CombineRecordShadow>(bounce, batch, rays, bind);
  } else if (bounce.depth == 1 && retained_.traits) {
    const auto bind = kept_as(buffer_.traits.data(), 1);
    combine_and_record<RecordTraitsShadow, CombineRecordTraitsShadow>(bounce, batch, rays, bind);
  } else if (bounce.depth == 2 && retained_.traits) {
    const auto bind = [&](auto& ports) { ports.traits.bind(buffer_.secondary_traits.data()); };
    combine_and_record<RecordBranchShadow, CombineRecordBranchShadow>(bounce, batch, rays, bind);
  } else if (bounce.depth > 1 && retained_.secondary) {
    const auto bind = kept_as(buffer_.secondary.data(), scrambled<float>(way_of(bounce.depth) ^ light));
    combine_and_record<RecordSecondaryShadow, CombineRecordSecondaryShadow>(bounce, batch, rays, bind);
  } else {
    combine(bounce, batch, rays);
  }
}

/// Either side of local shading. Later bounces must not add to a sample before its second side is kept.
template <bool kAfter>
Wavefront::Node Wavefront::record_local(const Bounce& bounce, std::vector<std::uint32_t>& stream, std::uint32_t items) {
  typename RecordLocal<kAfter>::template Ports<float> ports;
  ports.diffuse.bind(stream.data());
  const Node node = launch<RecordLocal<kAfter>>(ports, items, bounce.lanes);
  wait_for_bounce(node, bounce);
  wait_for_colours(node);
  if (!kAfter) wait_all(node, retained_.cleared);
  return node;
}
template Wavefront::Node Wavefront::record_local<false>(const Bounce& bounce, std::vector<std::uint32_t>& stream,
                                                        std::uint32_t items);
template Wavefront::Node Wavefront::record_local<true>(const Bounce& bounce, std::vector<std::uint32_t>& stream,
                                                       std::uint32_t items);

void Wavefront::shade_interpolated(Node maker, std::uint32_t items, std::uint32_t lanes) {
  Bounce bounce;
  bounce.lanes = std::max(items, lanes);
  Streams streams;
  classify_surfaces(bounce, items, streams);
  wait_all(bounce.inspector, maker);
  classify_occluded(bounce, items, streams);
  shade_sorted(bounce, streams);
}

/// Lists interpolated surfaces with occlusion textures, if the scene has any.
void Wavefront::classify_occluded(Bounce& bounce, std::uint32_t surfaces, Streams& streams) {
  if (!scene_.has_occlusion) return;
  buffer_.hold_details(surfaces);
  ClassifyOccluded::Ports<float> ports;
  const Node node = launch<ClassifyOccluded>(ports, surfaces, bounce.lanes);
  wait_all(node, bounce.inspector);
  bounce.inspector = node;
  streams.occluded = ports.occluded_count.value;
}

/// Shades interpolated surfaces that have been sorted into streams.
void Wavefront::shade_sorted(Bounce& bounce, const Streams& streams) {
  if (streams.textured != 0) shade_textured(bounce, streams.textured);
  const std::uint32_t items = streams.unlit();
  if (items != 0) shade_ambient(bounce, unlit_of(streams), items);
  if (streams.occluded != 0) shade_occluded(bounce, streams.occluded);
  for (std::uint32_t light = 0; light < scene_.lights.size(); ++light) {
    std::vector<std::uint32_t>& stream = light == 0 ? unlit_of(streams) : buffer_.diffuse;
    shade_visible(bounce, light, stream, light == 0 ? items : streams.diffuse);
  }
}

void Wavefront::shade_visible(const Bounce& bounce, std::uint32_t light, std::vector<std::uint32_t>& stream,
                              std::uint32_t items) {
  if (items == 0) return;
  ShadeVisible::Ports<float> ports;
  ports.diffuse.bind(stream.data());
  ports.light = scene_.lights[light];
  ports.mark = bit_of(light);
  add_colours<ShadeVisible>(bounce, ports, items);
}

}  // namespace kernels
