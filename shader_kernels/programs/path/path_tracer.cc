#include "shader_kernels/programs/path/path_tracer.h"

#include <algorithm>
#include <array>
#include <tuple>
#include <utility>

#include "shader_kernels/kernels/path.h"
#include "shader_kernels/programs/wavefront/guides.h"

namespace kernels {
namespace {

using Q = StageQueues;
using Node = Wavefront::Node;
using traces::RayKind;

/// Binds the ports of path kernel K and launches it.
template <class K>
LaunchResult launch_path(const WaveContext& wave, const WaveBounce& bounce, const StageInput& in) {
  typename K::template Ports<float> ports;
  bind_stage<K>(ports, wave, bounce, in);
  if constexpr (requires { ports.step; }) ports.step = bounce.depth * 0x9e3779b9U;
  if constexpr (requires { ports.light_count; }) ports.light_count = static_cast<float>(wave.scene.lights.size());
  const Node node = wave.graph.launch<K>(ports, in.items, in.lanes);
  std::uint32_t rays = 0;
  if constexpr (requires { ports.emitted; }) rays = ports.emitted.value;
  return {node, rays};
}

/// Launches the variant of a kernel for images with GGX roughness or for those without.
template <template <bool> class K>
LaunchResult launch_by_roughness(const WaveContext& wave, const WaveBounce& bounce, const StageInput& in) {
  return wave.scene.image.has_roughness ? launch_path<K<true>>(wave, bounce, in)
                                        : launch_path<K<false>>(wave, bounce, in);
}

/// Launches the variant of a kernel for lights that are discs or points.
template <template <bool> class K>
LaunchResult launch_by_discs(const WaveContext& wave, const WaveBounce& bounce, const StageInput& in) {
  return wave.scene.discs.empty() ? launch_path<K<false>>(wave, bounce, in) : launch_path<K<true>>(wave, bounce, in);
}

constexpr WaveStage kPathBackground{&Q::misses, launch<ShadeBackground>, WaitsFor::kBounce, kAddsColours};
constexpr WaveStage kPathTextures{&Q::textured, launch_by_mips<ShadeTextured>, WaitsFor::kInspector, kBaseColours};
constexpr auto kPathEmission = std::to_array<WaveStage>({
    {&Q::emissive, launch<ShadeEmission>, WaitsFor::kBounce, kAddsColours},
    {&Q::glowing, launch_by_mips<ShadeGlow>, WaitsFor::kBounce, kAddsColours},
});
constexpr WaveStage kSortLit{&Q::surfaces, launch_path<ClassifyLit>, WaitsFor::kInspector, kFillsQueues};
constexpr auto kLights = std::to_array<WaveStage>({
    {&Q::diffuse, launch_by_discs<SampleLight>, WaitsFor::kBounce, kCastsRays},
    {&Q::rough, launch_by_discs<SampleLightRough>, WaitsFor::kBounce, kCastsRays},
});

/// Which of a kernel's next rays are scattered: their hits on lamps would count light of light sources twice.
enum class Scatters : std::uint8_t {
  kNone,
  kContinued,       ///< those that continue a scattered ray, because shadow rays pass the surface too
  kContinuedGlass,  ///< as kContinued, if shadow rays pass glass
  kAll              ///< all, because light sources illuminate the surface
};

/// Row of the table of kernels that emit the next rays of paths.
struct ScatterStage {
  SlotQueue StageQueues::*queue;
  Launch launch;
  RayKind kind;
  Scatters scatters;
};
constexpr auto kScatter = std::to_array<ScatterStage>({
    {&Q::blended, launch<ShadeStraight>, RayKind::kRefraction, Scatters::kContinued},
    {&Q::mirror, launch<ShadeMirror>, RayKind::kReflection, Scatters::kNone},
    {&Q::glass, launch<ShadeGlass>, RayKind::kRefraction, Scatters::kContinuedGlass},
    {&Q::rough, launch_path<ScatterRough>, RayKind::kReflection, Scatters::kAll},
    {&Q::diffuse, launch_by_roughness<ScatterDiffuse>, RayKind::kReflection, Scatters::kAll},
});
/// Launches of one bounce that emit rays: blended surfaces and glass may need two.
constexpr std::size_t kMostBatches = kScatter.size() + 2;
static_assert(kMostBatches <= std::tuple_size_v<decltype(WaveBounce::batches)>);

}  // namespace

void PathTracer::run(const GeneratePorts<float>& ports, Node maker, std::uint32_t samples, RetainedRecords retained) {
  retained.is_path = true;
  const SceneTables& scene = wave_.wave_.scene;
  const auto is_lamp = [](const traces::MaterialRecord& material) {
    return (material.flags & (traces::kEmissive | traces::kGlowing)) != 0;
  };
  counts_all_ = config_.emission == PathEmission::kAll || scene.lights.empty() ||
                std::ranges::none_of(scene.image.materials, is_lamp);
  wave_.wave_.retained = retained;
  TileBuffer& buffer = wave_.wave_.buffer;
  buffer.reserve_paths(samples);
  seeded_ = seed_samples(ports, samples);
  WaveBounce bounce;
  bounce.rays = bounce.lanes = scattered_ = samples;
  buffer.reserve_wave(samples);
  bounce.batches[bounce.batch_count++] = wave_.tracer_.find_primary_hits(samples, maker);
  while (bounce.rays != 0) {
    readers_.clear();
    wave_.classify_hits(bounce);
    wave_.run_stage(kPathBackground, bounce, buffer.queues.misses);
    if (buffer.queues.surfaces.items == 0) return;
    wave_.shade_surfaces(bounce);
    wave_.run_stage(kPathTextures, bounce, buffer.queues.textured);
    if (retained.guides != nullptr && bounce.depth == 1) wave_.run_stage(kGuides, bounce, buffer.queues.surfaces);
    shade_emission(bounce);
    sample_lights(bounce);
    if (bounce.depth == scene.depth) return;
    choose_lobes(bounce);
    bounce = scatter(bounce);
  }
}

Node PathTracer::seed_samples(const GeneratePorts<float>& ports, std::uint32_t samples) {
  SeedPaths::Ports<float> seed;
  seed.tile = ports.tile;
  seed.image_width = ports.image_width;
  seed.seed = ports.seed;
  return wave_.graph_.launch<SeedPaths>(seed, samples);
}

void PathTracer::shade_emission(WaveBounce& bounce) {
  if (!counts_all_ && scattered_ == 0) return;
  for (const WaveStage& stage : kPathEmission) {
    SlotQueue& queue = wave_.wave_.buffer.queues.*stage.queue;
    if (!counts_all_ && scattered_ < bounce.rays) keep_visible(bounce, queue);
    add_reader(wave_.run_stage(stage, bounce, queue));
  }
}

/// Removes the surfaces from a queue of emissive ones that scattered rays have hit.
void PathTracer::keep_visible(WaveBounce& bounce, SlotQueue& queue) {
  if (queue.items == 0) return;
  KeepVisible::Ports<float> ports;
  ports.stream.bind(queue.entries.data());
  ports.kept.bind(queue.entries.data());
  ports.scattered = scattered_;
  const Node kept = wave_.graph_.launch<KeepVisible>(ports, queue.items, bounce.lanes);
  wave_.graph_.wait_for_all(kept, bounce.colours != Wavefront::kNone ? bounce.colours : bounce.inspector);
  bounce.colours = kept;
  queue.items = ports.kept_count.value;
}

/// Emits one shadow ray from each surface that light sources illuminate, and adds the light.
void PathTracer::sample_lights(WaveBounce& bounce) {
  StageQueues& queues = wave_.wave_.buffer.queues;
  const SceneTables& scene = wave_.wave_.scene;
  if (scene.lights.empty()) return;
  if (scene.image.has_roughness) {
    const Node colours = bounce.colours;
    const Node sorted = wave_.run_stage(kSortLit, bounce, queues.surfaces);
    wave_.graph_.wait_for_all(sorted, colours);  // later stages wait only for `sorted`
    bounce.colours = Wavefront::kNone;
  }
  for (const WaveStage& stage : kLights) {
    const Node node = wave_.run_stage(stage, bounce, queues.*stage.queue);
    wave_.graph_.wait_for_all(node, seeded_);
    add_reader(node);
  }
}

/// Decides how each path continues, and fills the queues of the kernels that emit its next ray.
void PathTracer::choose_lobes(WaveBounce& bounce) {
  const WaveContext& context = wave_.wave_;
  const auto choose = [&]<bool kRough> {
    typename ChooseLobe<kRough>::template Ports<float> ports;
    bind_stage<ChooseLobe<kRough>>(ports, context, bounce, {});
    ports.step = bounce.depth * 0x9e3779b9U;
    ports.least_survival = bounce.depth < config_.roulette_start ? 1.0F : static_cast<float>(config_.roulette_least);
    return context.graph.launch<ChooseLobe<kRough>>(ports, context.buffer.queues.surfaces.items, bounce.lanes);
  };
  const Node chosen =
      context.scene.image.has_roughness ? choose.template operator()<true>() : choose.template operator()<false>();
  wave_.wait_for_bounce(chosen, bounce);
  wave_.graph_.wait_for_all(chosen, seeded_);
  for (const Node reader : readers_) wave_.graph_.wait_for_all(chosen, reader);
  bounce.inspector = chosen;
  bounce.colours = Wavefront::kNone;
}

/// Counts the surfaces of a queue that rays with lower slots than scattered ones have hit. They are at its front,
/// because queues are in the order of ray slots.
PathTracer::KeptSurfaces PathTracer::count_visible(const WaveBounce& bounce, SlotQueue& queue) {
  if (counts_all_ || scattered_ >= bounce.rays) return {Wavefront::kNone, queue.items};
  if (queue.items == 0 || scattered_ == 0) return {};
  KeepVisible::Ports<float> ports;
  ports.stream.bind(queue.entries.data());
  ports.kept.bind(wave_.wave_.buffer.queues.emissive.entries.data());  // no later launch of the bounce reads it
  ports.scattered = scattered_;
  const Node counted = wave_.graph_.launch<KeepVisible>(ports, queue.items, bounce.lanes);
  wave_.graph_.wait_for_all(counted, bounce.inspector);
  return {counted, ports.kept_count.value};
}

/// Emits and traces the next rays of all paths. Scattered rays are last.
WaveBounce PathTracer::scatter(const WaveBounce& bounce) {
  TileBuffer& buffer = wave_.wave_.buffer;
  RaySlots& slots = buffer.rays.next_wave;
  slots.reserve_slots(std::size_t{bounce.rays} + 1);
  WaveBounce next;
  next.depth = bounce.depth + 1;
  next.lanes = bounce.lanes;
  const bool passes_glass = wave_.wave_.scene.solid_shadow == traces::kTriangleMask;
  std::array<KeptSurfaces, kScatter.size()> visible;
  for (std::size_t row = 0; row < kScatter.size(); ++row) {
    SlotQueue& queue = buffer.queues.*kScatter[row].queue;
    const Scatters scatters = kScatter[row].scatters;
    if (scatters == Scatters::kContinued || (scatters == Scatters::kContinuedGlass && passes_glass)) {
      visible[row] = count_visible(bounce, queue);
    } else if (scatters != Scatters::kAll) {
      visible[row].items = queue.items;
    }
  }
  const auto emit = [&](std::size_t row, std::uint32_t first, std::uint32_t end) {
    if (first == end) return;
    const ScatterStage& stage = kScatter[row];
    const auto [maker, rays] = stage.launch(wave_.wave_, bounce,
                                            {.entries = (buffer.queues.*stage.queue).entries.data() + first,
                                             .items = end - first,
                                             .lanes = bounce.lanes,
                                             .next_ray = next.rays});
    wave_.wait_for_bounce(maker, bounce);
    wave_.graph_.wait_for_all(maker, visible[row].node);
    if (rays == 0) return;
    next.batches[next.batch_count++] = wave_.tracer_.trace(stage.kind, slots, next.rays, rays, maker, true);
    next.rays += rays;
  };
  for (std::size_t row = 0; row < kScatter.size(); ++row) emit(row, 0, visible[row].items);
  scattered_ = next.rays;
  for (std::size_t row = 0; row < kScatter.size(); ++row) {
    emit(row, visible[row].items, (buffer.queues.*kScatter[row].queue).items);
  }
  std::swap(buffer.rays.wave, buffer.rays.next_wave);
  buffer.reserve_wave(next.rays);
  return next;
}

}  // namespace kernels
