#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <type_traits>

#include "shader_kernels/kernels/reconstruct.h"
#include "shader_kernels/programs/wavefront/tile_graph.h"
#include "traces/ray.h"
#include "traces/ray_key.h"

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
  const traces::RayKeyGrid key_grid_;
  std::uint32_t rays_traced_ = 0;
};

/// Which geometry the program reconstruct keeps of a wave's samples, and which rays find this geometry.
struct VisibleSamples {
  bool are_kept = false;
  bool are_shaded = true;    ///< hits of these samples are shaded, not only found
  bool have_shadows = true;  ///< shadow rays are cast, and blocked ones recorded
  std::uint32_t depth = std::numeric_limits<std::uint32_t>::max();  ///< largest number of rays in a path from the eye
  std::uint32_t mirrored = 0, refracted = 0;  ///< offset of the samples of mirrored and refracted rays; 0: none
  EyeUniforms<float> eye{};
  float depth_scale = 0;
  bool keeps_branch(std::uint32_t bounce) const { return are_kept && bounce == 2 && (mirrored | refracted) != 0; }
  std::uint32_t branch_offset(traces::RayKind kind) const {
    return kind == traces::RayKind::kReflection ? mirrored : refracted;
  }
};

/// How a wave treats effects for which only some samples emit rays (kernels/effects.h).
struct LowRateEffects {
  bool are_low_rate = false;
  std::uint32_t layer = 0;     ///< index offset from the data of one light to the data of the next
  GridUniforms<float> grid{};  ///< layout of the pixels in the tile buffer
};

struct GuideUniforms;  // programs/wavefront/guides.h

/// Which records of hits a wave keeps for its samples, in addition to the colours.
struct RetainedRecords {
  bool geometry = false, surfaces = false;  ///< keep the geometry of the first hit, or all its data that shading needs
  bool secondary = false;
  bool is_path = false;  ///< surfaces are lit by the program path:N (path/path_tracer.h)
  bool traits = false;   ///< keep the traits of the first hit and of the secondary hit with the largest weight
  VisibleSamples visible{};
  LowRateEffects low_rate{};
  const GuideUniforms* guides = nullptr;  ///< records the denoiser's guides of first hits; null: none
  StreamBuilder::Node cleared = StreamBuilder::kNone,
                      cleared_secondary = StreamBuilder::kNone;  ///< launches that cleared the records
};

// Rows of the tables of shading stages (wavefront.cc), and how a row's kernel is launched.

/// One bounce of a wave while it is shaded: its rays, and the nodes of the work graph that its stages wait for.
struct WaveBounce {
  using Node = TileGraph::Node;
  std::uint32_t rays = 0;
  std::uint32_t depth = 1;
  std::uint32_t lanes = 0, padding = 0;  ///< values of TileGraph::launch()'s arguments with these names
  std::uint32_t straight = 0, mirrored = 0, refracted = 0;  ///< first ray slots of straight, mirrored and refracted
                                                            ///< rays
  std::array<TracedBatch, 7> batches{};                     ///< one for each launch that emits rays of the bounce
  std::uint32_t batch_count = 0;
  bool is_single = true;              ///< no sample has two rays in this bounce
  bool has_lit = false;               ///< diffuse surfaces not in `deferred` already have ambient and first light
  Node begun = TileGraph::kNone;      ///< node that gave mirrored and refracted rays samples of their own
  Node after = TileGraph::kNone;      ///< last node of the previous bounce that changes colours
  Node fetched = TileGraph::kNone;    ///< node that wrote the surfaces; the next stage waits for it item by item
  Node inspector = TileGraph::kNone;  ///< node that filled the queues that the stages read
  Node colours = TileGraph::kNone;    ///< node that changed base colours by textures, if any
  Node recorded = TileGraph::kNone;   ///< node that recorded the hits of the bounce
};

/// State of a wave that the launches of its stages read.
struct WaveContext {
  const SceneTables& scene;
  TileGraph& graph;
  const TileResult& out;
  TileBuffer& buffer;
  ConeUniforms<float> cone;
  RetainedRecords retained{};
};

/// Arguments of the launch of a shading stage.
struct StageInput {
  std::uint32_t* entries = nullptr;  ///< entries of the stage's queue; null for kernels that run over all rays
  std::uint32_t items = 0, lanes = 0;
  std::uint32_t light = 0, ray = 0;           ///< index of the light, and of the ray that the launch casts towards it
  std::uint32_t next_ray = 0;                 ///< slot in the next wave of the first ray that the launch emits
  const LineUniforms<float>* line = nullptr;  ///< for interpolated samples, the lines that contain them
  ColourRecord<float>* colours = nullptr;     ///< array to which light is added; null: the samples' colours
};

/// Result of a stage's launch: its node in the work graph, and the number of rays that it emitted.
struct LaunchResult {
  TileGraph::Node node = TileGraph::kNone;
  std::uint32_t rays = 0;
};
using Launch = LaunchResult (*)(const WaveContext& wave, const WaveBounce& bounce, const StageInput& in);

/// Which nodes of the work graph a stage waits for.
enum class WaitsFor : std::uint8_t {
  kItem,       ///< waits item by item for the launch that fetched the surfaces
  kInspector,  ///< waits for the launch that filled the queues
  kBounce,     ///< waits for queues or base colours, all rays of the bounce, and the previous bounce
};

/// Properties of a shading stage, one bit each. They determine what later stages wait for.
enum StageEffect : std::uint32_t {
  kFetches = 1,      ///< the stage writes surfaces; the next stage waits for it item by item
  kFillsQueues = 2,  ///< the stage fills queues; later stages wait for it
  kBaseColours = 4,  ///< the stage writes base colours; stages that read them wait for it
  kAddsColours = 8,
  kCastsRays = 16,          ///< the stage emits shadow or occlusion rays
  kEndsSurfaces = 32,       ///< after the stage all surfaces are known, so that hits are recorded next
  kRecordsHits = 64,        ///< the stage itself records hits, so that no later one does
  kCastsAmbientRays = 128,  ///< the stage's rays carry ambient light, so that no shadow is recorded
  kOwnItemsOnly = 256       ///< the stage runs only over its queue, even if divergent kernels run over all items
};

/// A shading stage: the queue that it processes, its launch, and its dependences. A stage with an empty queue is
/// skipped.
struct WaveStage {
  SlotQueue StageQueues::*queue;
  Launch launch;
  WaitsFor waits;
  std::uint32_t effects = 0;
  constexpr bool has(StageEffect effect) const { return (effects & effect) != 0; }
};

/// Row of the table of kernels that emit rays of the next wave.
struct SpawnStage {
  SlotQueue StageQueues::*queue;
  Launch launch;
  traces::RayKind kind;
  std::uint32_t WaveBounce::*first;  ///< ray slot of the first ray that the kernel emits
  std::optional<Effect> effect;      ///< effect that must be enabled for these rays
};

/// The kernels that record a bounce's hits and shadow rays. `combine_shadows` also adds the rays' light to the samples.
struct RecordStages {
  Launch hits, shadows, combine_shadows;
};

/// Returns the bit of light number `light` in records of shadows. Lights from 32 on share bits.
inline std::uint32_t light_bit(std::uint32_t light) { return 1U << (light % 32); }

BounceUniforms<float> bounce_uniforms(const WaveBounce& bounce);
/// Returns a hash of a light and a bounce. The record of a sample's secondary shadows is a sum of such hashes.
std::uint32_t secondary_shadow_hash(const WaveBounce& bounce, std::uint32_t light);
RandomPointUniforms<float> occlusion_points(const WaveContext& wave, std::uint32_t ray);
/// Returns the frame's random numbers from which each hit of a rough mirror samples its microfacet.
inline RandomPointUniforms<float> facet_points(const WaveContext& wave) {
  constexpr std::uint32_t kFacetSeed = 0x85ebca77U;
  return {0.5F, 0.5F, scramble_bits<float>(jitter_seed(wave.out.work.frame) ^ kFacetSeed)};
}
RandomPointUniforms<float> soft_shadow_points(const WaveContext& wave, std::uint32_t light, std::uint32_t ray);

/// The type of the kernel that `Part`, a part of a fused kernel, runs.
template <class Part>
struct KernelOf {
  using Type = Part;
};
template <class K>
struct KernelOf<LightImmediately<K>> {
  using Type = K;
};

/// True if kernel K records the shadows of the secondary hit with the largest weight (program supersample).
template <class K>
inline constexpr bool kRecordsBranch = std::is_same_v<K, RecordBranchShadow>;
template <bool kInstanced>
inline constexpr bool kRecordsBranch<RecordBranch<kInstanced>> = true;

/// Sets the uniforms of kernel K, and those ports that are bound to different arrays in different stages.
template <class K, class P>
void bind_stage(P& p, const WaveContext& wave, const WaveBounce& bounce, const StageInput& in) {
  const SceneTables& scene = wave.scene;
  if constexpr (requires { p.stream; }) p.stream.bind(in.entries);
  if constexpr (
      requires { p.diffuse; } && !requires { p.diffuse_count; })
    p.diffuse.bind(in.entries);
  if constexpr (requires { p.background; }) p.background = scene.background;
  if constexpr (requires { p.epsilon; }) p.epsilon = scene.epsilon;
  if constexpr (requires { p.min_weight; }) p.min_weight = scene.min_weight;
  if constexpr (requires { p.cone; }) p.cone = wave.cone;
  if constexpr (requires { p.eye; }) p.eye = wave.retained.visible.eye;
  if constexpr (requires { p.depth_scale; }) p.depth_scale = wave.retained.visible.depth_scale;
  if constexpr (requires { p.bounce; }) p.bounce = bounce_uniforms(bounce);
  if constexpr (requires { p.line; }) p.line = *in.line;
  if constexpr (requires { p.light; }) p.light = scene.lights[in.light];
  if constexpr (requires { p.disc; }) {
    p.disc = scene.discs[in.light];
    p.draw = soft_shadow_points(wave, in.light, in.ray);
  }
  if constexpr (requires { p.distance; }) {
    p.ambient = scene.ambient * scene.occlusion_share();
    p.distance = scene.occlusion_distance;
    p.draw = occlusion_points(wave, in.ray);
  } else if constexpr (requires { p.ambient; }) {
    p.ambient = scene.ambient;
  }
  if constexpr (requires { p.share; }) p.share = scene.occlusion_share();
  if constexpr (std::is_same_v<K, ReflectRough>) p.draw = facet_points(wave);
  if constexpr (requires { p.next_rays; }) {
    p.next_rays.bind(wave.buffer.rays.next_wave.rays.data() + in.next_ray);
    p.next_paths.bind(wave.buffer.rays.next_wave.paths.data() + in.next_ray);
  }
  if constexpr (requires { p.colours; }) {
    if (in.colours != nullptr) p.colours.bind(in.colours);
  }
  if constexpr (std::is_same_v<K, ShadeVisible>) p.mark = light_bit(in.light);
  if constexpr (std::is_same_v<K, RecordShadow>) {
    p.records.bind(wave.buffer.samples.geometry.data());
    p.mark = light_bit(in.light);
  }
  if constexpr (std::is_same_v<K, RecordVisibleShadow>) {
    p.records.bind(wave.buffer.filters.visible.data());
    p.mark = light_bit(in.light);
  }
  if constexpr (std::is_same_v<K, RecordTraitsShadow>) {
    p.records.bind(wave.buffer.subpixels.traits.data());
    p.mark = 1;
  }
  if constexpr (std::is_same_v<K, RecordSecondaryShadow>) {
    p.records.bind(wave.buffer.samples.secondary.data());
    p.mark = secondary_shadow_hash(bounce, in.light);
  }
  if constexpr (kRecordsBranch<K>) p.traits.bind(wave.buffer.subpixels.secondary_traits.data());
}

/// Binds the ports of kernel K, or of each part of a fused kernel, and launches it.
template <class K>
LaunchResult launch(const WaveContext& wave, const WaveBounce& bounce, const StageInput& in) {
  typename K::template Ports<float> ports;
  if constexpr (requires { K::for_each_part([]<class> {}); }) {
    K::for_each_part(
        [&]<class Part> { bind_stage<typename KernelOf<Part>::Type>(ports_of<Part>(ports), wave, bounce, in); });
  } else {
    bind_stage<K>(ports, wave, bounce, in);
  }
  const TileGraph::Node node = wave.graph.launch<K>(ports, in.items, in.lanes);
  std::uint32_t rays = 0;
  if constexpr (requires { ports.emitted; }) rays = ports.emitted.value;
  return {node, rays};
}

/// Launches the variant of kernel K for the scene's mip filter.
template <template <MipFilter> class K>
LaunchResult launch_by_mips(const WaveContext& wave, const WaveBounce& bounce, const StageInput& in) {
  if (wave.scene.mips == MipFilter::kNone) return launch<K<MipFilter::kNone>>(wave, bounce, in);
  if (wave.scene.mips == MipFilter::kNearest) return launch<K<MipFilter::kNearest>>(wave, bounce, in);
  return launch<K<MipFilter::kLinear>>(wave, bounce, in);
}

/// Launches the variant of kernel K for scenes with instances or for those without.
template <template <bool> class K>
LaunchResult launch_by_instances(const WaveContext& wave, const WaveBounce& bounce, const StageInput& in) {
  return wave.scene.image.has_two_levels() ? launch<K<true>>(wave, bounce, in) : launch<K<false>>(wave, bounce, in);
}

/// Launches the variant of kernel K for scenes with or without instances, and with or without ray cones (mip maps).
template <template <bool, bool> class K>
LaunchResult launch_by_instances_and_cones(const WaveContext& wave, const WaveBounce& bounce, const StageInput& in) {
  const bool has_cones = wave.scene.mips != MipFilter::kNone;
  if (wave.scene.image.has_two_levels()) {
    return has_cones ? launch<K<true, true>>(wave, bounce, in) : launch<K<true, false>>(wave, bounce, in);
  }
  return has_cones ? launch<K<false, true>>(wave, bounce, in) : launch<K<false, false>>(wave, bounce, in);
}

/// Launches the kernel that applies metal-roughness textures, for images with or without GGX roughness.
template <MipFilter kMips>
using ShadePhysicalRough = ShadePhysical<kMips, true>;
template <MipFilter kMips>
using ShadePhysicalSmooth = ShadePhysical<kMips, false>;
inline LaunchResult launch_physical(const WaveContext& wave, const WaveBounce& bounce, const StageInput& in) {
  return wave.scene.image.has_roughness ? launch_by_mips<ShadePhysicalRough>(wave, bounce, in)
                                        : launch_by_mips<ShadePhysicalSmooth>(wave, bounce, in);
}
/// Launches the kernel that emits mirrored rays, for images with or without GGX roughness.
inline LaunchResult launch_mirror(const WaveContext& wave, const WaveBounce& bounce, const StageInput& in) {
  return wave.scene.image.has_roughness ? launch<ReflectRough>(wave, bounce, in)
                                        : launch<ShadeMirror>(wave, bounce, in);
}

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
  friend class PathTracer;
  // Stages that fetch and classify surfaces.
  void classify_hits(WaveBounce& bounce);
  void shade_surfaces(WaveBounce& bounce);
  Node run_stage(const WaveStage& stage, WaveBounce& bounce, SlotQueue& queue, std::uint32_t light = 0,
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
  void spawn_bounce_rays(const WaveBounce& bounce, WaveBounce& next);
  void trace_visible_fractions(const WaveBounce& bounce, Launch cast, StageInput in, Node selected, float share,
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
  Node selected_ = kNone;  ///< launch that selected the samples that emit effect rays
};

}  // namespace kernels
