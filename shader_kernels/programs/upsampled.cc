#include "shader_kernels/programs/upsampled.h"

namespace kernels {

UpsampledProgram::UpsampledProgram(const traces::MemoryImage& image, const traces::Camera& camera,
                                   const RenderConfig& config, const ReconstructConfig& filter, float scene_size,
                                   std::uint32_t frame, const PixelSink* sink)
    : FrameProgram(config.width, config.height),
      config_(config),
      scene_(image, config),
      camera_(camera_uniforms(camera, config.width, config.height)),
      tiles_(tiles_of(config)),
      order_(tiles_.sample_tiles().rendering_order(Halo::kReload)),
      frame_(frame),
      layers_(scene_.low_rate_light_count()),
      bend_(filter.bend_factor()),
      eye_(eye_uniforms(camera_, config.width, config.height, filter.depth_scale(scene_size))),
      sink_(sink) {}

std::uint32_t UpsampledProgram::light_bytes_per_sample() const {
  const auto collected = static_cast<std::uint32_t>(scene_.has_bounce ? sizeof(ColourRecord<float>) : 0);
  return layers_ * static_cast<std::uint32_t>(sizeof(ColourRecord<float>) + sizeof(RatioRecord<float>)) + collected;
}

/// Returns the mean bytes per sample of a border. The outer half of the halo needs only visible fractions and geometry.
/// The inner half, whose final colours the neighbour computes, needs all data, for a denoiser also its guides.
std::uint32_t UpsampledProgram::exchanged_bytes_per_sample() const {
  const auto shares = static_cast<std::uint32_t>(sizeof(VisibleRecord<float>) + layers_ * sizeof(RatioRecord<float>));
  const auto guides = static_cast<std::uint32_t>(sink_ != nullptr ? sizeof(GuideRecord<float>) : 0);
  return shares + ((1 + layers_) * static_cast<std::uint32_t>(sizeof(ColourRecord<float>)) + guides) / 2;
}

FrameRequirements UpsampledProgram::requirements() const {
  const std::uint32_t pixels = tiles_.tile_side() * tiles_.tile_side();
  FrameRequirements needs;
  needs.tile_samples = pixels;
  needs.attribute_bytes =
      pixels * (static_cast<std::uint32_t>(sizeof(VisibleRecord<float>)) + light_bytes_per_sample());
  needs.region_bytes = {std::uint64_t{tiles_.tile_count()} * tiles_.most_pixels() * kPixelBytes,
                        tiles_.tile_count() * stored_bytes_per_tile(), 0};
  return needs;
}

void UpsampledProgram::run_tile(std::uint32_t tile_index, const traces::Tracer& tracer, bool record,
                                TileResult& out) const {
  const SampleTile at = tiles_.sample_tiles().sample_tile(order_[tile_index]);
  tiles_.set_finished_rect(at, out);
  out.sampling = {};
  out.work.frame = frame_;
  out.work.tile = at.index;
  out.work.samples = at.width * at.height;
  out.buffer.reserve_low_rate(buffer_position_count(), layers_);
  const float halo = static_cast<float>(tiles_.halo_width()), pitch = static_cast<float>(tiles_.row_pitch());
  Wavefront wave(scene_, tracer, record, cone_uniforms(camera_, 1), out);
  TileGraph& graph = wave.tile_graph();
  Tile tile{at,
            tiles_.finished_uniforms(at, out),
            {static_cast<float>(at.x) - halo, static_cast<float>(at.y) - halo, pitch, 1.0F / pitch, 1, 1},
            out.width * out.height,
            wave,
            graph,
            out};
  out.linear.resize(tile.pixels);
  out.packed.resize(tile.pixels);
  trace_pixels(tile, tiles_.halo_width(), tiles_.halo_width(), at.width, at.height);
  export_borders(tile);  // exported first: a border needs no halo, so no chain of tiles waits
  fill_halo(tile);
  upsample_effects(tile);
  write_finished(tile);
  wave.finish();
  out.sampling.wanted = out.sampling.traced = out.work.samples;
  out.sampling.background = out.sampling.traced_background = out.background.size();
}

/// Traces the samples in a rectangle of the tile buffer.
void UpsampledProgram::trace_pixels(Tile& tile, std::uint32_t x, std::uint32_t y, std::uint32_t across,
                                    std::uint32_t down) const {
  Wavefront& wave = tile.wave;
  TileGraph& graph = tile.graph;
  const std::uint32_t pixels = across * down;
  tile.out.buffer.reserve_wave(pixels);
  const LatticeUniforms<float> lattice = tiles_.rect_sample_lattice(x, y, across);
  Node cleared = Wavefront::kNone;
  for (std::uint32_t layer = 0; layer < layers_; ++layer) {
    ClearEffects::Ports<float> ports;
    ports.lattice = lattice;
    ports.lattice.first += static_cast<float>(layer * buffer_position_count());
    const Node next = graph.launch<ClearEffects>(ports, pixels);
    graph.wait_for_all(next, cleared);
    cleared = next;
  }
  GenerateCentredRays::Ports<float> ports;
  ports.camera = camera_;
  ports.grid = tile.grid;
  ports.lattice = lattice;
  const Node generated = graph.launch<GenerateCentredRays>(ports, pixels);
  graph.wait_for_all(generated, cleared);
  graph.register_record_writer(generated);
  for (std::uint32_t i = 0; wave.wave_tracer().counts_pixels() && i < pixels; ++i) {
    const std::uint32_t column = tile.at.x + x + i % across - tiles_.halo_width();
    const std::uint32_t row = tile.at.y + y + i / across - tiles_.halo_width();
    wave.wave_tracer().assign_ray_to_pixel(i, column, row);
    if (!scene_.has_bounce) continue;
    const std::uint32_t sample = tile.out.buffer.rays.wave.paths[i].sample;
    wave.wave_tracer().assign_sample_to_pixel(sample + buffer_position_count(), column, row);
  }
  RetainedRecords retained;
  retained.visible = {.are_kept = true, .have_shadows = false, .eye = eye_};
  retained.low_rate = {.are_low_rate = true, .layer = buffer_position_count(), .grid = tile.grid};
  retained.cleared = generated;
  if (sink_ != nullptr) {
    sink_->begin_rays(graph, generated, pixels, buffer_position_count(), tile.out, retained);
  }
  wave.run(generated, pixels, retained);
  if (scene_.has_bounce) take_bounce(tile, lattice, pixels);
}

/// Moves the light of diffuse rays from the colours that collected it to the visible fractions.
void UpsampledProgram::take_bounce(Tile& tile, const LatticeUniforms<float>& lattice, std::uint32_t pixels) const {
  TakeBounce::Ports<float> ports;
  ports.lattice = lattice;
  ports.apart = buffer_position_count();
  const Node taken = tile.graph.launch<TakeBounce>(ports, pixels);
  tile.graph.wait_for_record_writers(taken);
  tile.graph.wait_for_colour_writers(taken);
  tile.graph.register_record_writer(taken);
}

/// Fills the halo of a tile. The simulator always traces halo samples itself, so that pixels do not depend on tile
/// order. If the modelled tile reads these samples from memory, the recorded work is a transfer instead.
void UpsampledProgram::fill_halo(Tile& tile) const {
  tiles_.for_each_halo_part(tile.at, [&](const HaloPart& part) {
    tile.graph.import_samples(part.border, stored_address(part.border.tile) + part.first * exchanged_bytes_per_sample(),
                              part.across * part.down * exchanged_bytes_per_sample());
    tile.graph.pause_recording();
    trace_pixels(tile, part.x, part.y, part.across, part.down);
    tile.graph.resume_recording();
  });
}

void UpsampledProgram::export_borders(Tile& tile) const {
  const std::uint64_t store = stored_address(tile.at.index);
  tiles_.for_each_export_border(tile.at, [&](std::uint32_t border, std::uint64_t first, std::uint32_t samples) {
    tile.graph.export_samples(border, store + first * exchanged_bytes_per_sample(),
                              samples * exchanged_bytes_per_sample());
  });
}

void UpsampledProgram::upsample_effects(Tile& tile) const {
  config_.effect_rate == EffectRate::kCheckerboard ? upsample_effects<true>(tile) : upsample_effects<false>(tile);
}

template <bool kCheckerboard>
void UpsampledProgram::upsample_effects(Tile& tile) const {
  Node last = Wavefront::kNone;
  for (std::uint32_t layer = 0; layer < layers_; ++layer) {
    typename UpsampleEffects<kCheckerboard>::template Ports<float> ports;
    ports.finished = tile.finished;
    ports.x0 = static_cast<float>(tile.out.x);
    ports.y0 = static_cast<float>(tile.out.y);
    ports.bend = bend_;
    ports.apart = layer * buffer_position_count();
    const Node next = tile.graph.launch<UpsampleEffects<kCheckerboard>>(ports, tile.pixels);
    if (layer == 0) {
      tile.graph.wait_for_record_writers(next);
      tile.graph.wait_for_colour_writers(next);
    }
    tile.graph.wait_for_all(next, last);
    last = next;
  }
  if (layers_ != 0) tile.graph.replace_colour_writers(last);
}

void UpsampledProgram::write_finished(Tile& tile) const {
  TileGraph& graph = tile.graph;
  const FinishedUniforms<float>& finished = tile.finished;
  const LatticeUniforms<float> lattice{finished.first, finished.width, finished.inverse_width, 1, finished.pitch};
  if (sink_ != nullptr) return sink_->write_grid(graph, lattice, tile.out);
  const std::uint64_t offset = std::uint64_t{tile.at.index} * tiles_.most_pixels() * kPixelBytes;
  if (scene_.fuses && !scene_.dma_encodes) {
    PackGridSample::Ports<float> ports;
    ports.lattice = lattice;
    const Node packed = graph.launch<PackGridSample>(ports, tile.pixels);
    graph.wait_for_colour_writers(packed);
    graph.write_packed_pixels(packed, offset);
    return;
  }
  AverageSamples::Ports<float> ports;
  ports.samples = ports.inverse_samples = 1;
  ports.width = finished.width;
  ports.inverse_width = finished.inverse_width;
  ports.grid = ports.inverse_grid = 1;
  ports.first = finished.first;
  ports.pitch = finished.pitch;
  const Node shown = graph.launch<AverageSamples>(ports, tile.pixels);
  graph.wait_for_colour_writers(shown);
  graph.write_pixels(shown, offset);
}

}  // namespace kernels
