#pragma once
#include <cstddef>
#include <cstdint>
#include <span>

#include "shader_kernels/programs/wavefront/tile_graph.h"
#include "traces/ray.h"

namespace kernels {

/// Result of tracing a batch of rays.
struct TracedBatch {
  TileGraph::Node rays = TileGraph::kNone;
  /// The launch that wrote the last hits, if rays continued after a hole or tinted glass.
  TileGraph::Node settled = TileGraph::kNone;
};

/// Traces a tile's rays. In scenes with holes or tinted glass, rays continue in rounds until all hits are solid:
///
///   rays -> classify_layers -> [ test_alpha or test_shadow -> rays -> scatter_layers ] ...
class WaveTracer {
 public:
  using Node = TileGraph::Node;

  WaveTracer(const SceneTables& scene, const traces::Tracer& tracer, TileGraph& graph, TileResult& out);

  /// Traces the rays in `ray_count` slots from `first`, which launch `maker` emitted. `is_mapped`: only some items of
  /// that launch emitted rays.
  TracedBatch trace(traces::RayKind kind, RaySlots& slots, std::uint32_t first, std::uint32_t ray_count, Node maker,
                    bool is_mapped);
  /// Finds the hits of a wave's primary rays, which launch `maker` generated. If the frame has a rasteriser,
  /// rasterisation is recorded instead of rays.
  TracedBatch find_primary_hits(std::uint32_t ray_count, Node maker);

  /// True if the work of each pixel's rays is counted. Programs must then call assign_sample_to_pixel().
  bool counts_pixels() const { return out_.wants_pixel_work && graph_.is_recording(); }
  /// Records that a primary ray of the first wave belongs to a sample of pixel (x, y).
  void assign_ray_to_pixel(std::uint32_t ray, std::uint32_t x, std::uint32_t y) {
    assign_sample_to_pixel(buffer_.rays.wave.paths[ray].sample, x, y);
  }
  /// Records that a sample belongs to pixel (x, y), for counting its work.
  void assign_sample_to_pixel(std::uint32_t sample, std::uint32_t x, std::uint32_t y);
  /// Moves the work counted for all pixels to the tile's result.
  void finish();

 private:
  Node trace_rays_once(traces::RayKind kind, RaySlots& slots, std::uint32_t first, std::uint32_t ray_count, Node maker,
                       bool is_mapped);
  void count_traversal_steps(std::size_t first_ray, std::span<const PathRecord<float>> paths);
  Node continue_through_layers(traces::RayKind kind, RaySlots& slots, std::uint32_t first, std::uint32_t ray_count,
                               Node batch);
  template <bool kColoured, bool kInstanced>
  std::uint32_t test_layers(traces::RayKind kind, RaySlots& slots, std::uint32_t first, std::uint32_t items,
                            std::uint32_t lanes, Node& tested);

  const SceneTables& scene_;
  const traces::Tracer& tracer_;
  TileGraph& graph_;
  TileResult& out_;
  TileBuffer& buffer_;
  std::uint32_t rays_traced_ = 0;
};

}  // namespace kernels
