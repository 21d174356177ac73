#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "shader_kernels/catalogue.h"
#include "shader_kernels/programs/wavefront/port_sources.h"
#include "shader_kernels/programs/wavefront/retained_records.h"
#include "shader_kernels/programs/wavefront/scene_tables.h"
#include "shader_kernels/programs/wavefront/stream_builder.h"
#include "shader_kernels/programs/wavefront/tile_result.h"
#include "shader_kernels/programs/wavefront/wave_bounce.h"
#include "traces/tracer.h"

namespace kernels {

/// Carries one tile's rays through tracing and shading, a wave per bounce, and writes down the work as it is done:
///
///   rays -> classify_hits -> shade_background
///                         -> shade_surface -> classify_surfaces -> shade_textured -> shade_ambient
///                                                                                 -> shade_diffuse (per light)
///                                          -> shade_emission                          -> shadow rays -> combine_shadow
///                                          -> shade_mirror, shade_glass -> rays of the next wave
///
/// Scenes with more to them (wavefront_details.cc) have, between shade_surface and classify_surfaces, steps each over a
/// stream of its own, and only if that stream has items:
///
///   classify_details -> absorb -> fetch_vertices -> shade_base -> shade_physical -> shade_bump -> shade_blend
///
/// and shade_glow beside shade_emission, shade_occluded behind shade_ambient, shade_straight before shade_mirror.
///
/// Triangles that are not solid add rounds behind a batch of rays (wavefront_layers.cc), until no ray goes on:
///
///   classify_layers -> [ test_alpha or test_shadow -> rays -> scatter_layers ] ...
///
/// Where a rasteriser makes primary hits (TileResult::rasteriser), the first batch of rays is a raster node. Other
/// effects than hard shadows (wavefront_effects.cc) have shade_open, or rays of shade_soft, in place of shade_diffuse,
/// and rays of cast_occlusion in place of shade_ambient.
///
/// For adaptive sampling it also keeps what samples hit (wavefront_records.cc):
///
///   surfaces of the first wave -> record_geometry or record_surface, of later ones -> record_secondary
///   shadow rays -> record_shadow, record_secondary_shadow
///   or: surfaces of the first wave -> record_traits, shadow rays -> record_traits_shadow
///       rays of the second -> weigh_branch, their surfaces -> record_branch, shadow rays -> record_branch_shadow
///   or (wavefront_visible.cc): begin_branch, record_visible, record_branch_visible, record_visible_shadow
///
/// With RenderConfig::fusion several of these are one launch (wavefront_fused.cc).
///
/// All orders (of rays, of additions to a sample) follow from the tile alone.
class Wavefront {
 public:
  using Node = StreamBuilder::Node;
  static constexpr Node kNone = StreamBuilder::kNone;

  using RetainedRecords = kernels::RetainedRecords;

  Wavefront(const SceneTables& scene, const traces::Tracer& tracer, bool record, const ConeUniforms<float>& cone,
            TileResult& out);

  /// From here on rays have that cone.
  void set_cone(const ConeUniforms<float>& cone) { cone_ = cone; }

  /// From here on work is done but not written down, nor are its rays counted: another tile's.
  void mute() { stream_.mute(true); }
  void unmute() { stream_.mute(false); }
  bool is_muted() const { return stream_.is_muted(); }

  /// Runs kernel K over `items` items and notes the launch. Ports that are not bound are bound by name. `lanes`: items
  /// of the stream that the inspector split; where kernels diverge (RenderConfig::streams) all of them go through K.
  /// `padding`: slots of K's stream that hold no item; they always go through K.
  template <class K>
  Node launch(typename K::template Ports<float>& ports, std::uint32_t items, std::uint32_t lanes = 0,
              std::uint32_t padding = 0);
  template <class K>
  Node launch(std::uint32_t items, std::uint32_t lanes = 0) {
    typename K::template Ports<float> ports;
    return launch<K>(ports, items, lanes);
  }
  /// Notes a launch of a kernel without accesses whose work has been done elsewhere.
  template <class K>
  Node note(std::uint32_t items) {
    return stream_.launch(kKernelId<K>, items, false);
  }
  void wait_all(Node node, Node for_node) { stream_.wait(node, for_node, traces::Edge::Kind::kAll); }
  void wait_each(Node node, Node for_node) { stream_.wait(node, for_node, traces::Edge::Kind::kEach); }

  /// Makes primary rays of the samples in `list`, which `lister` has filled, and what these are to keep that of a miss;
  /// notes the launches that did in `retained`. `ports` has camera and grid.
  Node generate(GenerateListedRays::Ports<float>& ports, std::vector<std::uint32_t>& list, Node lister,
                std::uint32_t items, RetainedRecords& retained, std::uint32_t lanes = 0);
  /// Traces and shades the primary rays that `maker` has put into the first wave, one per item, and all that follows.
  /// `lanes` and `padding` as for launch().
  void run(Node maker, std::uint32_t rays, const RetainedRecords& retained, std::uint32_t lanes = 0,
           std::uint32_t padding = 0);
  void run(Node maker, std::uint32_t rays) { run(maker, rays, {}); }
  /// Shades interpolated surfaces, which `maker` has put into the wave's first slots: local light alone, with shadows
  /// that are known. Their colours so far are global ones.
  void shade_interpolated(Node maker, std::uint32_t items, std::uint32_t lanes);
  /// The same, with kernel K = InterpolateLit making the surfaces.
  template <class K>
  void interpolate_lit(typename K::template Ports<float>& ports, std::uint32_t items, std::uint32_t lanes, Node after);
  /// Whether fused kernels are launched.
  bool fuses() const { return scene_.fuses; }
  bool has_lights() const { return !scene_.lights.empty(); }
  /// Makes `node` wait for all launches that add to the samples' colours.
  void wait_for_colours(Node node);
  /// Makes `node` wait for all that adds to what samples keep.
  void wait_for_records(Node node);
  /// All later wait_for_colours(), wait_for_records() wait for `node` too.
  void adds_colours(Node node) { buffer_.colour_nodes.push_back(node); }
  void adds_records(Node node) { buffer_.record_nodes.push_back(node); }
  /// `node` has waited for all launches so far: later wait_for_colours() wait for it instead.
  void colours_are_in(Node node) { buffer_.colour_nodes.assign(1, node); }
  Node transfer(traces::Region region, bool to_memory, std::uint64_t offset, std::uint32_t bytes);
  Node export_border(std::uint32_t number, std::uint64_t offset, std::uint32_t bytes);
  Node import_border(traces::Border border, std::uint64_t offset, std::uint32_t bytes) {
    return stream_.import_border(border, offset, bytes);
  }
  /// Exports samples: the transfer waits for all records and colours so far.
  void export_samples(std::uint32_t number, std::uint64_t offset, std::uint32_t bytes);
  /// Imports samples: what waits for records or colours from then on waits for the transfer.
  void import_samples(traces::Border border, std::uint64_t offset, std::uint32_t bytes);
  /// Whether it is the DMA that encodes pixels.
  bool dma_encodes() const { return scene_.dma_encodes; }
  /// Moves the tile's pixels, which the DMA encodes as pack_colour would, to byte `offset` of the picture.
  Node put_linear(std::uint64_t offset);
  /// Encodes the tile's pixels, once `averaged` is done, and moves them to byte `offset` of the picture.
  void put_out(Node averaged, std::uint64_t offset);
  /// Moves them once `packed` has encoded them.
  void put_packed(Node packed, std::uint64_t offset);
  /// Whether the rays of each pixel are counted; then place_ray() says where each primary ray of the first wave lies.
  bool counts_pixels() const { return out_.wants_pixel_work && stream_.is_on(); }
  void place_ray(std::uint32_t ray, std::uint32_t x, std::uint32_t y) { place(buffer_.wave.paths[ray].sample, x, y); }
  /// The same of a sample that rays will have.
  void place(std::uint32_t sample, std::uint32_t x, std::uint32_t y);
  void finish();

 private:
  using Batch = TracedBatch;
  using Bounce = WaveBounce;
  using Streams = WaveStreams;
  /// First hits that have rays for effects, and the launch that lists them.
  struct Selected {
    Node node = StreamBuilder::kNone;
    std::uint32_t items = 0;
  };

  /// Traces rays and those that go on behind what turns out not to be solid.
  Batch trace(traces::RayKind kind, RaySlots& slots, std::uint32_t first, std::uint32_t count, Node maker,
              bool is_mapped);
  /// Finds what the first wave's rays meet, as trace() does; but the work of that is a rasteriser's, if there is one.
  Batch see(std::uint32_t count, Node maker);
  Node trace_once(traces::RayKind, RaySlots& slots, std::uint32_t first, std::uint32_t count, Node maker, bool mapped);
  void count_walks(std::size_t first_ray, std::span<const PathRecord<float>> paths);

  Node settle(traces::RayKind kind, RaySlots& slots, std::uint32_t first, std::uint32_t count, Node batch);
  template <bool kColoured, bool kInstanced>
  std::uint32_t test_layers(traces::RayKind kind, RaySlots& slots, std::uint32_t first, std::uint32_t items,
                            std::uint32_t lanes, Node& tested);
  std::uint32_t classify(Bounce& bounce);
  void shade(Bounce& bounce, const Streams& streams);
  Streams shade_surfaces(Bounce& bounce, std::uint32_t surfaces);
  void shade_details(Bounce& bounce, const ClassifyDetails::Ports<float>& sorted, Streams& streams);
  template <class K>
  void step(Bounce& bounce, std::uint32_t items, std::vector<std::uint32_t>* stream = nullptr);
  /// Calls f<MipFilter>() for textures as they are.
  template <class Function>
  auto with_mips(Function&& f) const {
    if (scene_.mips == MipFilter::kNone) return f.template operator()<MipFilter::kNone>();
    if (scene_.mips == MipFilter::kNearest) return f.template operator()<MipFilter::kNearest>();
    return f.template operator()<MipFilter::kLinear>();
  }
  /// Calls f<kInstanced, kCones>() for surfaces as they are.
  template <class Function>
  auto with_surfaces(Function&& f) const {
    if (scene_.mips == MipFilter::kNone) {
      return scene_.image.has_levels() ? f.template operator()<true, false>() : f.template operator()<false, false>();
    }
    return scene_.image.has_levels() ? f.template operator()<true, true>() : f.template operator()<false, true>();
  }
  void shade_glow(const Bounce& bounce, std::uint32_t items);
  void shade_occluded(const Bounce& bounce, std::uint32_t items);
  /// Launches what adds to the samples' colours.
  template <class K>
  void add_colours(const Bounce& bounce, typename K::template Ports<float>& ports, std::uint32_t items) {
    const Node node = launch<K>(ports, items, bounce.lanes);
    wait_for_bounce(node, bounce);
    buffer_.colour_nodes.push_back(node);
  }
  void shade_background(const Bounce& bounce, std::uint32_t misses);
  void shade_textured(Bounce& bounce, std::uint32_t items);
  void shade_emission(const Bounce& bounce, std::uint32_t items);
  void shade_local(Bounce& bounce, const Streams& streams);
  void shade_ambient(const Bounce& bounce, std::vector<std::uint32_t>& stream, std::uint32_t items);
  void shade_light(const Bounce& bounce, std::uint32_t light, std::uint32_t ray, std::vector<std::uint32_t>& stream,
                   std::uint32_t items);
  // wavefront_effects.cc
  void bind_occlusion(CastAmbientPorts<float>& ports, std::uint32_t ray) const;
  void bind_soft(ShadeSoft::Ports<float>& ports, std::uint32_t light, std::uint32_t ray) const;
  void cast_occlusion(const Bounce& bounce, std::uint32_t ray, std::vector<std::uint32_t>& stream, std::uint32_t items);
  void shade_open(const Bounce& bounce, std::uint32_t light, std::vector<std::uint32_t>& stream, std::uint32_t items);
  void shade_soft(const Bounce& bounce, std::uint32_t light, std::uint32_t ray, std::vector<std::uint32_t>& stream,
                  std::uint32_t items);
  void shade_visible(const Bounce& bounce, std::uint32_t light, std::vector<std::uint32_t>& stream,
                     std::uint32_t items);
  void combine_shadows(const Bounce& bounce, std::uint32_t light, const Batch& batch, std::uint32_t rays);
  void classify_surfaces(Bounce& bounce, std::uint32_t surfaces, Streams& streams);
  void record_hits(Bounce& bounce, std::uint32_t surfaces);
  template <bool kAfter>
  Node record_local(const Bounce& bounce, std::vector<std::uint32_t>& stream, std::uint32_t items);
  // wavefront_rated.cc
  /// Whether occlusion and soft shadows of the bounce's surfaces have a rate of their own.
  bool rates(const Bounce& bounce) const { return retained_.rated.are_rated && bounce.depth == 1; }
  Streams fetch_visible(Bounce& bounce, std::uint32_t surfaces);
  Selected select_effects(const Bounce& bounce, std::uint32_t items);
  template <class K>
  void keep_light(const Bounce& bounce, typename K::template Ports<float>& ports, std::uint32_t layer,
                  std::uint32_t items);
  template <class K>
  void find_share(const Bounce& bounce, typename K::template Ports<float>& ports, float share, std::uint32_t layer,
                  const Selected& selected);
  void shade_rated(const Bounce& bounce, const Streams& streams);
  // wavefront_fused.cc
  bool lights_at_once(const Bounce& bounce) const;
  Streams light_surfaces(Bounce& bounce, std::uint32_t surfaces);
  template <bool kInstanced, bool kCones>
  void light_surfaces(Bounce& bounce, std::uint32_t surfaces, Streams& streams);
  template <bool kInstanced, bool kCones>
  void fetch_surfaces(Bounce& bounce, std::uint32_t surfaces, Streams& streams);
  template <bool kInstanced, bool kCones>
  void light_by_effects(Bounce& bounce, std::uint32_t surfaces, Streams& streams);
  template <class P>
  void bind_first_light(P& ports) const;
  template <class K>
  void light_with(Bounce& bounce, std::uint32_t surfaces, Streams& streams, bool has_records);
  std::vector<std::uint32_t>& unlit_of(const Streams& streams) {
    return streams.has_lit ? buffer_.later : buffer_.diffuse;
  }
  void light_later(const Bounce& bounce, std::vector<std::uint32_t>& stream, std::uint32_t items);
  Node generate_fused(GenerateListedRays::Ports<float>& ports, std::vector<std::uint32_t>& list, std::uint32_t items,
                      RetainedRecords& retained, std::uint32_t lanes);
  void classify_occluded(Bounce& bounce, std::uint32_t surfaces, Streams& streams);
  void shade_sorted(Bounce& bounce, const Streams& streams);
  static BounceUniforms<float> uniforms_of(const Bounce& bounce);
  template <bool kInstanced>
  Node retain_hits(const Bounce& bounce, std::uint32_t surfaces);
  template <bool kInstanced>
  Node record_branches(const Bounce& bounce, std::uint32_t surfaces);
  // wavefront_visible.cc
  bool is_shaded() const { return !retained_.visible.are_kept || retained_.visible.are_shaded; }
  void begin_branch(Bounce& next, std::uint32_t rays, std::uint32_t apart, Node maker);
  Node record_visible(const Bounce& bounce, std::uint32_t surfaces);
  void cast_shadows(const Bounce& bounce, const Streams& streams);
  void combine(const Bounce& bounce, const Batch& batch, std::uint32_t rays);
  template <class Record, class K = Record>
  Node record_shadows(const Bounce& bounce, const Batch& batch, std::uint32_t rays, auto&& bind);
  /// Combines shadow rays and keeps what they found with kernel Record, whose ports `bind` binds; or both with kernel
  /// Both.
  template <class Record, class Both>
  void combine_and_record(const Bounce& bounce, const Batch& batch, std::uint32_t rays, auto&& bind);
  Bounce send_on(const Bounce& bounce, const Streams& streams);
  template <class K>
  void send(const Bounce& bounce, traces::RayKind kind, std::vector<std::uint32_t>& stream, std::uint32_t items,
            Bounce& next);
  void wait_for_bounce(Node node, const Bounce& bounce);
  /// Item by item, unless rays went on.
  void wait_for_batch(Node node, const Batch& batch);
  std::vector<traces::Access>* accesses() { return stream_.is_on() ? &out_.work.accesses : nullptr; }

  const SceneTables& scene_;
  const traces::Tracer& tracer_;
  TileResult& out_;
  TileBuffer& buffer_;
  const PortSources sources_;
  StreamBuilder stream_;
  RetainedRecords retained_;
  ConeUniforms<float> cone_;
  std::uint32_t rays_traced_ = 0;
};

}  // namespace kernels

#include "shader_kernels/programs/wavefront/wavefront_launch.h"
