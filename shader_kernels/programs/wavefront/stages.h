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

/// Which records of hits a wave keeps for its samples, in addition to the colours.
struct RetainedRecords {
  bool geometry = false, surfaces = false;  ///< keep the geometry of the first hit, or all its data that shading needs
  bool secondary = false;
  bool traits = false;  ///< keep the traits of the first hit and of the secondary hit with the largest weight
  VisibleSamples visible{};
  LowRateEffects low_rate{};
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
  std::array<TracedBatch, 3> batches{};
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
struct Launched {
  TileGraph::Node node = TileGraph::kNone;
  std::uint32_t rays = 0;
};
using Launch = Launched (*)(const WaveContext& wave, const WaveBounce& bounce, const StageInput& in);

/// Which nodes of the work graph a stage waits for.
enum class Waits : std::uint8_t {
  kItem,       ///< waits item by item for the launch that fetched the surfaces
  kInspector,  ///< waits for the launch that filled the queues
  kBounce,     ///< waits for queues or base colours, all rays of the bounce, and the previous bounce
};

/// How a shading stage affects later stages and for which nodes they wait; one bit per effect.
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
  Waits waits;
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

/// True if kernel K records the shadows of the secondary hit with the largest weight (supersample).
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
Launched launch_by_mips(const WaveContext& wave, const WaveBounce& bounce, const StageInput& in) {
  if (wave.scene.mips == MipFilter::kNone) return launch<K<MipFilter::kNone>>(wave, bounce, in);
  if (wave.scene.mips == MipFilter::kNearest) return launch<K<MipFilter::kNearest>>(wave, bounce, in);
  return launch<K<MipFilter::kLinear>>(wave, bounce, in);
}

/// Launches the variant of kernel K for scenes with instances or for those without.
template <template <bool> class K>
Launched launch_by_instances(const WaveContext& wave, const WaveBounce& bounce, const StageInput& in) {
  return wave.scene.image.has_two_levels() ? launch<K<true>>(wave, bounce, in) : launch<K<false>>(wave, bounce, in);
}

/// Launches the variant of kernel K for scenes with or without instances, and with or without ray cones (mip maps).
template <template <bool, bool> class K>
Launched launch_by_surface_variant(const WaveContext& wave, const WaveBounce& bounce, const StageInput& in) {
  const bool has_cones = wave.scene.mips != MipFilter::kNone;
  if (wave.scene.image.has_two_levels()) {
    return has_cones ? launch<K<true, true>>(wave, bounce, in) : launch<K<true, false>>(wave, bounce, in);
  }
  return has_cones ? launch<K<false, true>>(wave, bounce, in) : launch<K<false, false>>(wave, bounce, in);
}

}  // namespace kernels
