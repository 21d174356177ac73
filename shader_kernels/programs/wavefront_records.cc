#include "shader_kernels/programs/wavefront.h"

namespace kernels {

namespace {

/// Stands for a bounce's depth in a sum of hashes; the two lowest bits are left to what else is told apart.
std::uint32_t way_of(std::uint32_t depth) { return depth * 0x9e3779b9U; }

/// A light's bit; lights beyond 32 share them.
std::uint32_t bit_of(std::uint32_t light) { return 1U << (light % 32); }

}  // namespace

template <class K>
Wavefront::Node Wavefront::record_surfaces(typename K::template Ports<float>& ports, std::uint32_t surfaces) {
  ports.surfaces.bind(buffer_.surfaces.data());
  ports.hits.bind(buffer_.wave.hits.data());
  ports.places.bind(buffer_.places.data());
  ports.paths.bind(buffer_.wave.paths.data());
  ports.triangles.bind(scene_.image.triangles.data(), accesses());
  return launch<K>(ports, surfaces);
}

void Wavefront::record_hits(Bounce& bounce, std::uint32_t surfaces) {
  if (bounce.depth == 1 && keep_.geometry) {
    RecordGeometry::Ports<float> ports;
    ports.mattes.bind(buffer_.mattes.data());
    ports.geometry.bind(buffer_.geometry.data());
    bounce.recorded = record_surfaces<RecordGeometry>(ports, surfaces);
  } else if (bounce.depth == 1 && keep_.surfaces) {
    RecordSurface::Ports<float> ports;
    ports.mattes.bind(buffer_.mattes.data());
    ports.geometry.bind(buffer_.geometry.data());
    ports.texcoords.bind(buffer_.texcoords.data());
    ports.kept.bind(buffer_.kept.data());
    bounce.recorded = record_surfaces<RecordSurface>(ports, surfaces);
  } else if (bounce.depth > 1 && keep_.secondary) {
    RecordSecondary::Ports<float> ports;
    ports.secondary.bind(buffer_.secondary.data());
    ports.way = way_of(bounce.depth);
    ports.mirrored = bounce.mirrored;
    ports.refracted = bounce.refracted;
    ports.first = bounce.depth == 2 ? 1.0F : 0.0F;
    bounce.recorded = record_surfaces<RecordSecondary>(ports, surfaces);
  } else {
    return;
  }
  wait_for_bounce(bounce.recorded, bounce);
  wait_all(bounce.recorded, bounce.depth == 1 ? keep_.cleared : keep_.cleared_secondary);
  buffer_.record_nodes.push_back(bounce.recorded);
}

template <class K>
Wavefront::Node Wavefront::record_shadows(auto* records, std::uint32_t mark, std::uint32_t rays, std::uint32_t lanes) {
  typename K::template Ports<float> ports;
  ports.shadow_hits.bind(buffer_.shadow.hits.data());
  ports.shadow_paths.bind(buffer_.shadow.paths.data());
  ports.records.bind(records);
  ports.mark = mark;
  return launch<K>(ports, rays, lanes);
}

void Wavefront::record_shadows(const Bounce& bounce, std::uint32_t light, const Batch& batch, std::uint32_t rays) {
  Node node = StreamBuilder::kNone;
  if (bounce.depth == 1 && (keep_.geometry || keep_.surfaces)) {
    const std::uint32_t mark = keep_.counted_shadows ? 1 : bit_of(light);
    node = record_shadows<RecordShadow>(buffer_.geometry.data(), mark, rays, bounce.lanes);
  } else if (bounce.depth > 1 && keep_.secondary) {
    const std::uint32_t mark = scrambled<float>(way_of(bounce.depth) ^ light);
    node = record_shadows<RecordSecondaryShadow>(buffer_.secondary.data(), mark, rays, bounce.lanes);
  } else {
    return;
  }
  wait_for_batch(node, batch);
  wait_all(node, bounce.recorded);
  buffer_.record_nodes.push_back(node);
}

}  // namespace kernels
