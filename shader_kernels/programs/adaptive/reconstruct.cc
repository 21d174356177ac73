#include "shader_kernels/programs/adaptive/reconstruct.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace kernels {

namespace {

/// Returns the union of the flags of all materials.
std::uint32_t all_material_flags(const traces::MemoryImage& image) {
  std::uint32_t flags = 0;
  for (const traces::MaterialRecord& material : image.materials) flags |= material.flags;
  return flags;
}

}  // namespace

ReconstructProgram::ReconstructProgram(const traces::MemoryImage& image, const traces::Camera& camera,
                                       const RenderConfig& config, const ReconstructConfig& reconstruct,
                                       Filters filters, float scene_size, std::uint32_t frame)
    : FrameProgram(config.width, config.height),
      config_(config),
      reconstruct_(reconstruct),
      filters_(filters),
      scene_(image, config),
      camera_(camera_uniforms(camera, config.width, config.height)),
      tiles_(config.width, config.height, config.tile / 2,
             reconstruct.radius),  // pixels have four samples, two along a side
      order_(tiles_.sample_tiles().rendering_order(reconstruct.halo)),
      frame_(frame),
      depth_scale_(reconstruct.depth_scale(scene_size)),
      bend_(reconstruct.bend_factor()) {
  if (!filters_apart() || !has_geometry() || config.depth == 1) return;
  const std::uint32_t flags = all_material_flags(image);
  // Glass reflects too.
  const bool reflects = scene_.effects.has(Effect::kReflections), refracts = scene_.effects.has(Effect::kRefractions);
  if (reflects && (flags & (traces::kMirror | traces::kGlass | traces::kPhysical)) != 0) mirrors_ = layers_++;
  if ((flags & traces::kBlended) != 0 || (refracts && (flags & traces::kGlass) != 0)) glass_ = layers_++;
}

std::uint32_t ReconstructProgram::shaded_sample_bytes() const {
  return layers_ * static_cast<std::uint32_t>(sizeof(VisibleRecord<float>) + sizeof(ColourRecord<float>));
}
std::uint32_t ReconstructProgram::unshaded_sample_bytes() const {
  return kOtherSamples * layers_ * static_cast<std::uint32_t>(sizeof(VisibleRecord<float>));
}
std::uint32_t ReconstructProgram::attribute_bytes() const {
  return has_geometry() ? kGeometrySamples * layers_ * static_cast<std::uint32_t>(sizeof(VisibleRecord<float>)) : 0;
}

FrameRequirements ReconstructProgram::requirements() const {
  const std::uint32_t pixels = tiles_.tile_side() * tiles_.tile_side();
  FrameRequirements needs;
  needs.tile_samples = layers_ * pixels;
  needs.wave_samples = has_geometry() ? kOtherSamples * pixels : pixels;
  needs.attribute_bytes = reconstruct_.attributes == AttributeStorage::kTile ? pixels * attribute_bytes() : 0;
  needs.region_bytes = {std::uint64_t{tiles_.tile_count()} * tiles_.most_pixels() * kPixelBytes,
                        tiles_.tile_count() * stored_bytes_per_tile(), 0};
  return needs;
}

ReconstructProgram::Tile ReconstructProgram::make_tile(const SampleTile& at, Wavefront& wave, TileResult& out) const {
  return {at, tiles_.finished_uniforms(at, out), out.width * out.height, wave, wave.tile_graph(), out, out.buffer};
}

void ReconstructProgram::run_tile(std::uint32_t tile_index, const traces::Tracer& tracer, bool record,
                                  TileResult& out) const {
  const SampleTile at = tiles_.sample_tiles().sample_tile(order_[tile_index]);
  tiles_.set_finished_rect(at, out);
  out.sampling = {};
  out.marks.clear();
  out.work.frame = frame_;
  out.work.tile = at.index;
  out.work.samples = at.width * at.height;
  out.buffer.reserve_visible(std::size_t{layers_} * records_per_layer(), tiles_.most_pixels());
  Wavefront wave(scene_, tracer, record, cone_uniforms(camera_, 1), out);
  TileGraph& graph = wave.tile_graph();
  Tile tile = make_tile(at, wave, out);
  out.linear.resize(tile.pixels);
  out.packed.resize(tile.pixels);

  const PixelRect own{tiles_.halo_width(), tiles_.halo_width(), at.width, at.height};
  // Shade one sample of every pixel. Of the other three, find geometry and shadows.
  trace_pixels(tile, own, own, true);
  export_borders(tile);  // exported first, because borders need no halo
  fill_halo(tile);
  spill_attributes_to_dram(tile);
  // Filter the shaded samples around each sample by geometry. Where colours still differ, shade all four.
  Node made = has_geometry() ? filter_pixels(tile) : copy_shaded_colours(tile);
  if (tests_colours()) made = shade_contrast_pixels(tile, made);
  graph.write_pixels(made, std::uint64_t{at.index} * tiles_.most_pixels() * kPixelBytes);
  wave.finish();
  count_samples(tile);
}

VisibleSamples ReconstructProgram::records_to_keep(bool are_shaded) const {
  VisibleSamples records{.are_kept = has_geometry(), .are_shaded = are_shaded};
  records.have_shadows = filters_apart();
  records.mirrored = mirrors_ * records_per_layer();
  records.refracted = glass_ * records_per_layer();
  if (!are_shaded) records.depth = layers_ > 1 ? 2 : 1;
  records.eye = eye_uniforms(camera_, config_.width, config_.height, depth_scale_);
  records.depth_scale = depth_scale_;
  return records;
}

/// Traces the shaded samples in one rectangle of pixels, and the samples that are not shaded in another.
void ReconstructProgram::trace_pixels(Tile& tile, const PixelRect& shaded, const PixelRect& others, bool is_own) const {
  const Node cleared = clear_branches(tile, shaded);
  trace_shaded_samples(tile, shaded, cleared);
  if (has_geometry()) trace_unshaded_samples(tile, others, cleared);
  if (tile.graph.is_muted()) return;
  const std::uint32_t samples = shaded.pixel_count() + (has_geometry() ? kOtherSamples * others.pixel_count() : 0);
  tile.out.sampling.traced += samples;
  if (!is_own) tile.out.sampling.halo += samples;
}

ReconstructProgram::Node ReconstructProgram::clear_branches(Tile& tile, const PixelRect& part) const {
  Node last = Wavefront::kNone;
  for (std::uint32_t b = 1; b < layers_; ++b) {
    ClearBranch::Ports<float> ports;
    ports.lattice = tiles_.rect_sample_lattice(part.x, part.y, part.across);
    ports.lattice.first += static_cast<float>(b * records_per_layer());
    ports.apart = buffer_position_count();
    const Node cleared = tile.graph.launch<ClearBranch>(ports, part.pixel_count());
    tile.graph.wait_for_all(cleared, last);
    last = cleared;
  }
  if (last != Wavefront::kNone) tile.graph.register_record_writer(last);
  return last;
}

VisibleRayPorts<float>& ReconstructProgram::bind_rays(VisibleRayPorts<float>& ports, const Tile& tile,
                                                      const PixelRect& part) const {
  bind_pixels(ports, tile);
  ports.lattice = tiles_.rect_sample_lattice(part.x, part.y, part.across);
  return ports;
}

/// Records to which pixel each sample belongs, including the samples of mirrored and refracted rays.
void ReconstructProgram::assign_samples_to_pixels(Tile& tile, std::uint32_t rays) const {
  if (!tile.wave.wave_tracer().counts_pixels()) return;
  for (std::uint32_t i = 0; i < rays; ++i) {
    const std::uint32_t sample = tile.buffer.rays.wave.paths[i].sample, position = sample % buffer_position_count();
    const std::uint32_t x = tile.at.x + position % tiles_.row_pitch() - tiles_.halo_width();
    const std::uint32_t y = tile.at.y + position / tiles_.row_pitch() - tiles_.halo_width();
    for (std::uint32_t b = 0; b < layers_; ++b)
      tile.wave.wave_tracer().assign_sample_to_pixel(sample + b * records_per_layer(), x, y);
  }
}

void ReconstructProgram::trace_shaded_samples(Tile& tile, const PixelRect& part, Node cleared) const {
  Wavefront& wave = tile.wave;
  TileGraph& graph = tile.graph;
  tile.buffer.reserve_wave(part.pixel_count());
  GenerateShadedRays::Ports<float> ports;
  bind_rays(ports, tile, part);
  const Node generated = graph.launch<GenerateShadedRays>(ports, part.pixel_count());
  assign_samples_to_pixels(tile, part.pixel_count());
  graph.register_record_writer(generated);
  RetainedRecords retained;
  retained.visible = records_to_keep(true);
  retained.cleared = generated;
  retained.cleared_secondary = cleared;
  wave.run(generated, part.pixel_count(), retained);
  if (has_geometry()) clamp_colour_layers(tile, part);
}

void ReconstructProgram::trace_unshaded_samples(Tile& tile, const PixelRect& part, Node cleared) const {
  Wavefront& wave = tile.wave;
  TileGraph& graph = tile.graph;
  const std::uint32_t items = kOtherSamples * part.pixel_count();
  tile.buffer.reserve_wave(items);
  GenerateVisibleRays::Ports<float> ports;
  bind_rays(ports, tile, part);
  ports.apart = static_cast<float>(buffer_position_count());
  const Node generated = graph.launch<GenerateVisibleRays>(ports, items);
  assign_samples_to_pixels(tile, items);
  graph.register_record_writer(generated);
  RetainedRecords retained;
  retained.visible = records_to_keep(false);
  retained.cleared = generated;
  retained.cleared_secondary = cleared;
  wave.run(generated, items, retained);
}

void ReconstructProgram::clamp_colour_layers(Tile& tile, const PixelRect& part) const {
  const auto launch = [&]<std::uint32_t kBranches> {
    typename LimitColours<kBranches>::template Ports<float> ports;
    ports.lattice = tiles_.rect_sample_lattice(part.x, part.y, part.across);
    ports.branch = records_per_layer();
    const Node limited = tile.graph.launch<LimitColours<kBranches>>(ports, part.pixel_count());
    tile.graph.wait_for_colour_writers(limited);
    if (!tile.graph.is_muted()) tile.graph.replace_colour_writers(limited);
  };
  call_with_branch_count(launch);
}

/// Writes pixels with the colour of their own shaded sample. A filter with radius 0 does only this.
ReconstructProgram::Node ReconstructProgram::copy_shaded_colours(Tile& tile) const {
  AverageSamples::Ports<float> ports;
  ports.samples = ports.inverse_samples = 1;
  ports.width = tile.finished.width;
  ports.inverse_width = tile.finished.inverse_width;
  ports.grid = ports.inverse_grid = 1;
  ports.first = tile.finished.first;
  ports.pitch = tile.finished.pitch;
  const Node shown = tile.graph.launch<AverageSamples>(ports, tile.pixels);
  tile.graph.wait_for_colour_writers(shown);
  return shown;
}

ReconstructProgram::Node ReconstructProgram::filter_pixels(Tile& tile) const {
  return reconstruct_.radius == 1 ? launch_filter<1>(tile) : launch_filter<2>(tile);
}

template <class K>
void ReconstructProgram::bind_filter(typename K::template Ports<float>& ports, const Tile& tile) const {
  ports.finished = tile.finished;
  ports.bend = bend_;
  ports.apart = buffer_position_count();
}

template <std::uint32_t kRadius>
ReconstructProgram::Node ReconstructProgram::launch_filter(Tile& tile) const {
  TileGraph& graph = tile.graph;
  using Surfaces = Reconstruct<kRadius, false>;
  typename Surfaces::template Ports<float> ports;
  bind_filter<Surfaces>(ports, tile);
  Node last = graph.launch<Surfaces>(ports, tile.pixels);
  graph.wait_for_record_writers(last);
  graph.wait_for_colour_writers(last);
  for (std::uint32_t b = 1; b < layers_; ++b) {
    const auto layers_before = static_cast<float>(b * records_per_layer());
    ListBranches::Ports<float> list;
    list.finished = tile.finished;
    list.branch = layers_before;
    list.apart = buffer_position_count();
    const Node listed = graph.launch<ListBranches>(list, tile.pixels);
    graph.wait_for_all(listed, last);
    last = listed;
    const std::uint32_t items = list.masters_count.value;
    if (items == 0) continue;
    using Branch = Reconstruct<kRadius, true>;
    typename Branch::template Ports<float> branch;
    bind_filter<Branch>(branch, tile);
    branch.branch = layers_before;
    last = graph.launch<Branch>(branch, items, tile.pixels);
    graph.wait_for_all(last, listed);
  }
  return last;
}

/// Finds the pixels whose colour changes where the geometry does not, shades their other samples, and averages all
/// four. The primary rays of these samples are cast again, because before only their geometry was kept. In the tile
/// buffer the new colours replace the geometry, which the filters no longer need.
ReconstructProgram::Node ReconstructProgram::shade_contrast_pixels(Tile& tile, Node filtered) const {
  return call_with_branch_count(
      [&]<std::uint32_t kBranches> { return shade_contrast_pixels<kBranches>(tile, filtered); });
}

template <std::uint32_t kBranches>
ReconstructProgram::Node ReconstructProgram::shade_contrast_pixels(Tile& tile, Node filtered) const {
  Wavefront& wave = tile.wave;
  TileGraph& graph = tile.graph;
  typename ListContrasts<kBranches>::template Ports<float> list;
  list.finished = tile.finished;
  list.bend = bend_;
  list.threshold = static_cast<float>(reconstruct_.colour);
  list.branch = static_cast<float>(records_per_layer());
  const Node listed = graph.launch<ListContrasts<kBranches>>(list, tile.pixels);
  graph.wait_for_all(listed, filtered);
  const std::uint32_t pixels = list.masters_count.value;
  Sampling& sampling = tile.out.sampling;
  sampling.checked += tile.pixels;
  sampling.passed += tile.pixels - pixels;
  if (pixels == 0) return listed;

  const std::uint32_t rays = kOtherSamples * pixels, lanes = kOtherSamples * tile.pixels;
  tile.buffer.reserve_wave(rays);
  GenerateContrastRays::Ports<float> generate;
  bind_pixels(generate, tile);
  generate.finished = tile.finished;
  generate.apart = static_cast<float>(buffer_position_count());
  const Node generated = graph.launch<GenerateContrastRays>(generate, rays, lanes);
  graph.wait_for_all(generated, listed);
  assign_samples_to_pixels(tile, rays);
  wave.set_cone(cone_uniforms(camera_, 2));  // pixels have four samples, two along a side
  wave.run(generated, rays, {}, lanes);
  sampling.traced += rays;
  sampling.correction += rays;

  typename AverageContrasts<kBranches>::template Ports<float> average;
  average.finished = tile.finished;
  average.apart = buffer_position_count();
  average.branch = records_per_layer();
  const Node averaged = graph.launch<AverageContrasts<kBranches>>(average, pixels, tile.pixels);
  graph.wait_for_all(averaged, generated);
  graph.wait_for_colour_writers(averaged);
  return averaged;
}

using traces::Region;

/// Returns the mean bytes per pixel of a border. The outer half of the halo needs shaded samples only. The inner half,
/// whose final colours the neighbour computes, also needs the other samples.
std::uint32_t ReconstructProgram::exchanged_bytes_per_sample() const {
  return shaded_sample_bytes() + unshaded_sample_bytes() / 2;
}

// A tile stores its borders in memory (FinishedTiles), and all attributes if they are kept in DRAM.
std::uint64_t ReconstructProgram::stored_bytes_per_tile() const {
  const bool is_parked = reconstruct_.attributes == AttributeStorage::kDram;
  return tiles_.stored_samples() * exchanged_bytes_per_sample() +
         (is_parked ? std::uint64_t{buffer_position_count()} * attribute_bytes() : 0);
}

/// Fills the halo of a tile. The simulator always traces halo samples itself, so that pixels do not depend on tile
/// order. If the modelled tile reads these samples from memory, the recorded work is a transfer instead.
void ReconstructProgram::fill_halo(Tile& tile) const {
  tiles_.for_each_halo_part(tile.at, [&](const HaloPart& part) {
    const bool is_left = part.x < tiles_.halo_width(), is_above = part.y < tiles_.halo_width();
    const HaloPart inner =
        part.part_nearest_tile(is_left ? reconstruct_.radius : part.across, is_above ? reconstruct_.radius : part.down);
    if (reconstruct_.halo == Halo::kReload) {
      tile.graph.import_samples(part.border,
                                stored_bytes_per_tile() * part.border.tile + part.first * exchanged_bytes_per_sample(),
                                part.across * part.down * exchanged_bytes_per_sample());
      tile.graph.pause_recording();
    }
    trace_pixels(tile, {part.x, part.y, part.across, part.down}, {inner.x, inner.y, inner.across, inner.down}, false);
    tile.graph.resume_recording();
  });
}

void ReconstructProgram::export_borders(Tile& tile) const {
  if (reconstruct_.halo == Halo::kRetrace) return;
  const std::uint64_t store = stored_bytes_per_tile() * tile.at.index;
  tiles_.for_each_export_border(tile.at, [&](std::uint32_t border, std::uint64_t first, std::uint32_t samples) {
    tile.graph.export_samples(border, store + first * exchanged_bytes_per_sample(),
                              samples * exchanged_bytes_per_sample());
  });
}

/// Writes the attributes of all samples to DRAM and reads them back, if attributes are kept there.
void ReconstructProgram::spill_attributes_to_dram(Tile& tile) const {
  if (reconstruct_.attributes == AttributeStorage::kTile || !has_geometry()) return;
  const std::uint32_t across = tile.at.width + (tile.at.has_left ? tiles_.halo_width() : 0);
  const std::uint32_t down = tile.at.height + (tile.at.has_above ? tiles_.halo_width() : 0);
  const std::uint32_t bytes = across * down * attribute_bytes();
  const std::uint64_t store =
      stored_bytes_per_tile() * tile.at.index + tiles_.stored_samples() * exchanged_bytes_per_sample();
  const Node out = tile.graph.add_transfer(Region::kSamples, true, store, bytes);
  tile.graph.wait_for_record_writers(out);
  const Node in = tile.graph.add_transfer(Region::kSamples, false, store, bytes);
  tile.graph.wait_for_all(in, out);
  tile.graph.register_record_writer(in);
}

namespace {

constexpr std::uint32_t kWanted = 16;  ///< samples per pixel of the picture that reconstruct approximates

/// Bits of a debug mark for one layer of light (surface, mirrored or refracted). They show that the filter rejected a
/// sample by depth, normal or shadows.
struct EdgeBits {
  std::uint32_t depth, normal, shadow;
};
constexpr std::uint32_t edge_bit(FilterEdge edge) { return 1U << static_cast<std::uint32_t>(edge); }
constexpr EdgeBits kSurface{edge_bit(FilterEdge::kDepth), edge_bit(FilterEdge::kNormal), edge_bit(FilterEdge::kShadow)};
constexpr EdgeBits kMirror{edge_bit(FilterEdge::kReflection), edge_bit(FilterEdge::kReflection),
                           edge_bit(FilterEdge::kReflectedShadow)};
constexpr EdgeBits kGlass{edge_bit(FilterEdge::kRefraction), edge_bit(FilterEdge::kRefraction),
                          edge_bit(FilterEdge::kRefractedShadow)};

}  // namespace

void ReconstructProgram::count_samples(Tile& tile) const {
  Sampling& sampling = tile.out.sampling;
  sampling.wanted = std::uint64_t{kWanted} * tile.pixels;
  sampling.traced_background = tile.out.background.size();
  const std::uint32_t stands_for = has_geometry() ? kWanted / kGeometrySamples : kWanted;
  for (const std::uint32_t sample : tile.out.background) {
    const std::uint32_t position = sample % buffer_position_count();
    const bool is_own =
        position % tiles_.row_pitch() >= tiles_.halo_width() && position / tiles_.row_pitch() >= tiles_.halo_width();
    sampling.background += is_own ? stands_for : 0;
  }
  if (!stores_marks() || !has_geometry()) return;
  tile.out.marks.resize(tile.pixels);
  for (std::uint32_t pixel = 0; pixel < tile.pixels; ++pixel) tile.out.marks[pixel] = pixel_mark(tile, pixel);
}

/// Returns the debug mark of a pixel, from the comparisons that the filters of the program reconstruct make.
SampleMark ReconstructProgram::pixel_mark(const Tile& tile, std::uint32_t pixel) const {
  const FinishedUniforms<float>& of = tile.finished;
  const DivMod<float> at = row_and_column<float>(static_cast<float>(pixel), of);
  const auto centre = static_cast<std::uint32_t>(centre_sample<float>(at, of));
  const auto radius = static_cast<float>(reconstruct_.radius);
  std::uint32_t edges = 0;
  float left = 0, all = 0;
  const auto compare = [&](std::uint32_t layer_number, const EdgeBits& bits, std::uint32_t shaded, std::uint32_t k) {
    const std::uint32_t first = layer_number * records_per_layer();
    const VisibleRecord<float>& own = tile.buffer.filters.visible[first + k * buffer_position_count() + centre];
    if (!has_path_branch<float>(own)) return;
    const Similarity<float> similar(own, tile.buffer.filters.visible[first + shaded], bend_);
    edges |= (similar.depth > kHalved ? bits.depth : 0) | (similar.normal > kHalved ? bits.normal : 0) |
             (similar.same_shadows ? 0 : bits.shadow);
    if (layer_number != 0) return;
    left += similar.filter_weight();
    all += 1;
  };
  for (float y = std::max(of.low_y, at.quotient - radius); y <= std::min(of.high_y, at.quotient + radius); ++y) {
    for (float x = std::max(of.low_x, at.remainder - radius); x <= std::min(of.high_x, at.remainder + radius); ++x) {
      const auto shaded = static_cast<std::uint32_t>(of.first + y * of.pitch + x);
      for (std::uint32_t k = 0; k < kGeometrySamples; ++k) {
        compare(0, kSurface, shaded, k);
        if (mirrors_ != 0) compare(mirrors_, kMirror, shaded, k);
        if (glass_ != 0) compare(glass_, kGlass, shaded, k);
      }
    }
  }
  const auto share = static_cast<std::uint32_t>(std::lround(255 * left / all));
  return static_cast<SampleMark>(edges | share << kWeightShift);
}

}  // namespace kernels
