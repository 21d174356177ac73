#pragma once
#include <cstdint>
#include <span>

#include "shader_kernels/programs/wavefront/stages.h"

namespace kernels {

/// Traces and shades one tile's rays, one wave per bounce. Each bounce runs the rows of stage tables:
///
///   rays -> classify_hits -> shade_background
///                         -> surface stages -> textures, emission -> light -> shadow rays -> combine_shadow
///                                           -> shade_straight, shade_mirror, shade_glass -> rays of the next wave
///
/// The surface stages have three variants, a table each in wavefront.cc:
///
///   separate      shade_surface -> [details] -> classify_surfaces -> kernels that record samples
///   fused         fetch_lit, or fetch_surface -> [details] -> light_surface; these also add ambient light and the
///                 first light, and record samples
///   reduced rate  fetch_visible; only some samples emit rays for occlusion and soft shadows, the others interpolate
///                 the results
///
/// Scenes with detailed materials insert the stages [details]:
///
///   classify_details -> absorb -> fetch_vertices -> shade_base -> shade_physical -> shade_bump -> shade_blend
///
/// The order of rays and of additions to a sample depends only on the tile.
class Wavefront {
 public:
  using Node = TileGraph::Node;
  static constexpr Node kNone = TileGraph::kNone;

  Wavefront(const SceneTables& scene, const traces::Tracer& tracer, bool record, const ConeUniforms<float>& cone,
            TileResult& out);

  TileGraph& tile_graph() { return graph_; }
  WaveTracer& wave_tracer() { return tracer_; }
  /// Sets the ray cone that all later rays of the tile have.
  void set_cone(const ConeUniforms<float>& cone) { wave_.cone = cone; }

  /// Generates the primary rays of the samples in `list`, which launch `lister` filled. Clears the records that
  /// `retained` selects, and stores the nodes of the clearing launches in `retained`. The camera and grid of `ports`
  /// must be set.
  Node generate_listed_rays(GenerateListedRays::Ports<float>& ports, SampleQueue& list, Node lister,
                            std::uint32_t items, RetainedRecords& retained, std::uint32_t lanes = 0);
  /// Traces and shades primary rays and all later bounces. Launch `maker` wrote the primary rays to the first wave, one
  /// per item. `lanes` and `padding` are those of TileGraph::launch().
  void run(Node maker, std::uint32_t rays, const RetainedRecords& retained = {}, std::uint32_t lanes = 0,
           std::uint32_t padding = 0);
  /// Interpolates the surfaces of samples that passed the check `checked` (a launch), and adds local light with the
  /// known shadows.
  template <bool kAlongY>
  void shade_interpolated(const LineUniforms<float>& line, std::uint32_t items, std::uint32_t lanes, Node checked);
  void finish();

 private:
  // Stages that fetch and classify surfaces.
  void classify_hits(WaveBounce& bounce);
  void shade_surfaces(WaveBounce& bounce);
  void run_stage(const WaveStage& stage, WaveBounce& bounce, SlotQueue& queue, std::uint32_t light = 0,
                 std::uint32_t ray = 0);
  void run_stages(std::span<const WaveStage> stages, WaveBounce& bounce);
  void wait_for_bounce(Node node, const WaveBounce& bounce);
  void wait_for_batch(Node node, const TracedBatch& batch);

  // Stages that add light.
  void shade_local_lights(WaveBounce& bounce);
  void shade_light(WaveBounce& bounce, std::uint32_t light, SlotQueue& queue, std::uint32_t first_ray = 0,
                   std::uint32_t end_ray = ~0U);
  void combine_shadows(const WaveBounce& bounce, std::uint32_t light, const TracedBatch& batch, std::uint32_t rays,
                       bool is_recorded);
  SlotQueue& unlit_queue(const WaveBounce& bounce) {
    return bounce.has_lit ? wave_.buffer.queues.deferred : wave_.buffer.queues.diffuse;
  }

  // Stages of effects that are traced at only some pixels.
  bool uses_low_rate_effects(const WaveBounce& bounce) const {
    return wave_.retained.low_rate.are_low_rate && bounce.depth == 1;
  }
  void shade_low_rate_effects(WaveBounce& bounce);
  void launch_visibility_ratio(const WaveBounce& bounce, Launch cast, StageInput in, Node selected, float share,
                               std::uint32_t layer);

  // Stages that record what samples keep.
  bool is_shaded() const { return !wave_.retained.visible.are_kept || wave_.retained.visible.are_shaded; }
  const RecordStages* record_stages(const WaveBounce& bounce) const;
  void record_hits(WaveBounce& bounce);
  template <bool kAfter>
  Node record_local_colour(const WaveBounce& bounce, SlotQueue& queue);

  // Stages that emit the next wave.
  WaveBounce spawn_secondary_rays(const WaveBounce& bounce);
  void assign_branch_samples(WaveBounce& next, std::uint32_t rays, std::uint32_t apart, Node maker);

  TileResult& out_;
  TileGraph graph_;
  WaveTracer tracer_;
  WaveContext wave_;
};

}  // namespace kernels
