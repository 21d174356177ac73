#pragma once
#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <type_traits>

#include "shader_kernels/kernels/reconstruct.h"
#include "shader_kernels/programs/wavefront/tile_graph.h"
#include "shader_kernels/programs/wavefront/wave_tracer.h"
#include "traces/ray.h"

namespace kernels {

/// Geometry that samples of reconstruct keep, and the rays that it comes from.
struct VisibleSamples {
  bool are_kept = false;
  bool are_shaded = true;                                           ///< false: hits are found but not shaded
  bool have_shadows = true;                                         ///< shadow rays are cast, and blocked ones recorded
  std::uint32_t depth = std::numeric_limits<std::uint32_t>::max();  ///< longest path from the eye
  std::uint32_t mirrored = 0, refracted = 0;  ///< offset from a surface's sample to those of mirrored and refracted
                                              ///< rays; 0: not kept
  EyeUniforms<float> eye{};
  float depth_scale = 0;
  bool keeps_branch(std::uint32_t bounce) const { return are_kept && bounce == 2 && (mirrored | refracted) != 0; }
  std::uint32_t branch_offset(traces::RayKind kind) const {
    return kind == traces::RayKind::kReflection ? mirrored : refracted;
  }
};

/// Effects of first hits that only some samples trace rays for (kernels/effects.h).
struct RatedEffects {
  bool are_rated = false;
  std::uint32_t layer = 0;     ///< offset between a sample's data of one light and the next
  GridUniforms<float> grid{};  ///< pixels of the tile buffer
};

/// Records that samples keep of their hits, next to their colour.
struct RetainedRecords {
  bool geometry = false, surfaces = false;  ///< of the first hit: geometry, or all that shading needs
  bool secondary = false;
  bool traits = false;  ///< of the first hit and of the heaviest secondary one
  VisibleSamples visible{};
  RatedEffects rated{};
  StreamBuilder::Node cleared = StreamBuilder::kNone,
                      cleared_secondary = StreamBuilder::kNone;  ///< launches that cleared them
};

// Rows of the stage tables of a wave (wavefront.cc), and the launch of a row's kernel.

/// A bounce in progress: its rays, and the nodes that its stages wait for.
struct WaveBounce {
  using Node = TileGraph::Node;
  std::uint32_t rays = 0;
  std::uint32_t depth = 1;
  std::uint32_t lanes = 0, padding = 0;                     ///< as for TileGraph::launch()
  std::uint32_t straight = 0, mirrored = 0, refracted = 0;  ///< first slots of each kind of rays
  std::array<TracedBatch, 3> batches{};
  std::uint32_t batch_count = 0;
  bool is_single = true;              ///< no sample has two rays in the bounce
  bool has_lit = false;               ///< diffuse surfaces have ambient and first light, except those in `deferred`
  Node begun = TileGraph::kNone;      ///< node that gave its rays samples of their own
  Node after = TileGraph::kNone;      ///< last node of the previous bounce that changes colours
  Node fetched = TileGraph::kNone;    ///< node that wrote its surfaces; the next stage waits for it item by item
  Node inspector = TileGraph::kNone;  ///< node that filled the queues that its stages read
  Node colours = TileGraph::kNone;    ///< node that wrote base colours, if textures did so after the inspector
  Node recorded = TileGraph::kNone;   ///< node that recorded its hits
};

/// State of a wave that launches read.
struct WaveContext {
  const SceneTables& scene;
  TileGraph& graph;
  const TileResult& out;
  TileBuffer& buffer;
  ConeUniforms<float> cone;
  RetainedRecords retained{};
};

/// Input of a launch.
struct StageInput {
  std::uint32_t* entries = nullptr;  ///< entries of the queue; null for kernels that run over all rays
  std::uint32_t items = 0, lanes = 0;
  std::uint32_t light = 0, ray = 0;           ///< index of the light and ray that it casts
  std::uint32_t next_ray = 0;                 ///< slot of its first ray in the next wave
  const LineUniforms<float>* line = nullptr;  ///< lines of interpolated samples
  ColourRecord<float>* colours = nullptr;     ///< if not null, receives light instead of the samples' colours
};

/// Result of a launch: its node, and the number of rays that it emitted.
struct Launched {
  TileGraph::Node node = TileGraph::kNone;
  std::uint32_t rays = 0;
};
using Launch = Launched (*)(const WaveContext& wave, const WaveBounce& bounce, const StageInput& in);

/// Nodes that a stage waits for.
enum class Waits : std::uint8_t {
  kItem,       ///< item by item: the launch that fetched the surfaces
  kInspector,  ///< the launch that filled the queues
  kBounce,     ///< inspector or base colours, rays of all batches, and the previous bounce
};

/// Effect of a stage on the waiting of later ones, as bits.
enum StageEffect : std::uint32_t {
  kFetches = 1,      ///< writes surfaces; the next stage waits for it item by item
  kFillsQueues = 2,  ///< later stages wait for it
  kBaseColours = 4,  ///< stages that read base colours wait for it
  kAddsColours = 8,
  kCastsRays = 16,          ///< its rays are shadow or occlusion rays
  kEndsSurfaces = 32,       ///< all surfaces are known, so that hits are recorded next
  kRecordsHits = 64,        ///< records hits itself
  kCastsAmbientRays = 128,  ///< its rays bring ambient light, so that no shadow is recorded
  kOwnItemsOnly = 256       ///< runs only over its queue, even if kernels diverge
};

/// A row of a stage table. A stage with an empty queue is skipped.
struct WaveStage {
  SlotQueue StageQueues::*queue;
  Launch launch;
  Waits waits;
  std::uint32_t effects = 0;
  constexpr bool has(StageEffect effect) const { return (effects & effect) != 0; }
};

/// A row of the table of kernels that emit the rays of the next wave.
struct SpawnStage {
  SlotQueue StageQueues::*queue;
  Launch launch;
  traces::RayKind kind;
  std::uint32_t WaveBounce::*first;  ///< slot of its first ray
  std::optional<Effect> effect;      ///< effect to which the rays belong
};

/// Kernels that record a bounce's hits and shadow rays. `combine_shadows` also adds the rays' light to samples.
struct RecordStages {
  Launch hits, shadows, combine_shadows;
};

/// Returns a light's bit; lights from 32 on share bits.
inline std::uint32_t bit_of(std::uint32_t light) { return 1U << (light % 32); }

BounceUniforms<float> bounce_uniforms(const WaveBounce& bounce);
/// Returns a hash of a light and a bounce; secondary shadow records sum them.
std::uint32_t secondary_mark(const WaveBounce& bounce, std::uint32_t light);
DrawUniforms<float> occlusion_draw(const WaveContext& wave, std::uint32_t ray);
DrawUniforms<float> soft_shadow_draw(const WaveContext& wave, std::uint32_t light, std::uint32_t ray);

/// The kernel that a part of a fused kernel runs.
template <class Part>
struct KernelOf {
  using Type = Part;
};
template <class K>
struct KernelOf<ImmediateLit<K>> {
  using Type = K;
};

/// True if kernel K records the heaviest secondary hit (supersample).
template <class K>
inline constexpr bool kRecordsBranch = std::is_same_v<K, RecordBranchShadow>;
template <bool kInstanced>
inline constexpr bool kRecordsBranch<RecordBranch<kInstanced>> = true;

/// Sets the uniforms of kernel K, and the ports whose array depends on the stage.
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
    p.draw = soft_shadow_draw(wave, in.light, in.ray);
  }
  if constexpr (requires { p.distance; }) {
    p.ambient = scene.ambient * scene.occlusion_share();
    p.distance = scene.occlusion_distance;
    p.draw = occlusion_draw(wave, in.ray);
  } else if constexpr (requires { p.ambient; }) {
    p.ambient = scene.ambient;
  }
  if constexpr (requires { p.share; }) p.share = scene.occlusion_share();
  if constexpr (requires { p.next_rays; }) {
    p.next_rays.bind(wave.buffer.rays.next_wave.rays.data() + in.next_ray);
    p.next_paths.bind(wave.buffer.rays.next_wave.paths.data() + in.next_ray);
  }
  if constexpr (requires { p.colours; }) {
    if (in.colours != nullptr) p.colours.bind(in.colours);
  }
  if constexpr (std::is_same_v<K, ShadeVisible>) p.mark = bit_of(in.light);
  if constexpr (std::is_same_v<K, RecordShadow>) {
    p.records.bind(wave.buffer.samples.geometry.data());
    p.mark = bit_of(in.light);
  }
  if constexpr (std::is_same_v<K, RecordVisibleShadow>) {
    p.records.bind(wave.buffer.filters.visible.data());
    p.mark = bit_of(in.light);
  }
  if constexpr (std::is_same_v<K, RecordTraitsShadow>) {
    p.records.bind(wave.buffer.subpixels.traits.data());
    p.mark = 1;
  }
  if constexpr (std::is_same_v<K, RecordSecondaryShadow>) {
    p.records.bind(wave.buffer.samples.secondary.data());
    p.mark = secondary_mark(bounce, in.light);
  }
  if constexpr (kRecordsBranch<K>) p.traits.bind(wave.buffer.subpixels.secondary_traits.data());
}

/// Launches kernel K. A fused kernel's parts are bound one by one.
template <class K>
Launched launch(const WaveContext& wave, const WaveBounce& bounce, const StageInput& in) {
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
Launched by_mips(const WaveContext& wave, const WaveBounce& bounce, const StageInput& in) {
  if (wave.scene.mips == MipFilter::kNone) return launch<K<MipFilter::kNone>>(wave, bounce, in);
  if (wave.scene.mips == MipFilter::kNearest) return launch<K<MipFilter::kNearest>>(wave, bounce, in);
  return launch<K<MipFilter::kLinear>>(wave, bounce, in);
}

/// Launches the variant of kernel K with or without instances.
template <template <bool> class K>
Launched by_instances(const WaveContext& wave, const WaveBounce& bounce, const StageInput& in) {
  return wave.scene.image.has_levels() ? launch<K<true>>(wave, bounce, in) : launch<K<false>>(wave, bounce, in);
}

/// Launches the variant of kernel K with or without instances, and with or without ray cones (mip maps).
template <template <bool, bool> class K>
Launched by_surfaces(const WaveContext& wave, const WaveBounce& bounce, const StageInput& in) {
  const bool has_cones = wave.scene.mips != MipFilter::kNone;
  if (wave.scene.image.has_levels()) {
    return has_cones ? launch<K<true, true>>(wave, bounce, in) : launch<K<true, false>>(wave, bounce, in);
  }
  return has_cones ? launch<K<false, true>>(wave, bounce, in) : launch<K<false, false>>(wave, bounce, in);
}

}  // namespace kernels
