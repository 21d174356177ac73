#include "shader_kernels/programs/adaptive/supersample.h"

#include <algorithm>
#include <bit>
#include <numeric>

#include "shader_kernels/kernels/subpixels.h"
#include "sim/hash.h"

namespace kernels {

SupersampleProgram::SupersampleProgram(const traces::MemoryImage& image, const traces::Camera& camera,
                                       const RenderConfig& config, const SupersampleConfig& supersample,
                                       std::uint32_t frame)
    : FrameProgram(config.width, config.height),
      config_(config),
      supersample_(supersample),
      scene_(image, config),
      camera_(camera_uniforms(camera, config.width, config.height)),
      tiles_(config.width, config.height, config.tile / 2, 1),  // in sub-pixels, two along a pixel's side
      order_(tiles_.sample_tiles().rendering_order(supersample.halo)),
      frame_(frame),
      shown_(supersample.propagate == 0 ? 0 : config.width, supersample.propagate == 0 ? 0 : config.height,
             tiles_.tile_count()) {}

FrameRequirements SupersampleProgram::requirements() const {
  const std::uint32_t samples = tiles_.tile_side() * tiles_.tile_side();
  FrameRequirements needs;
  needs.tile_samples = std::max(samples, kChunk * kExtra);
  needs.attribute_bytes = supersample_.attributes == AttributeStorage::kTile ? samples * kAttributeBytes : 0;
  if (supersample_.propagate != 0) needs.attribute_bytes += dma_waiting_bytes();
  needs.region_bytes = {std::uint64_t{tiles_.tile_count()} * tile_pixels() * kPixelBytes,
                        supersample_.propagate == 0 ? tiles_.tile_count() * stored_bytes_per_tile()
                                                    : newly_active_flag_address(tiles_.tile_count(), 1),
                        0};
  return needs;
}

void SupersampleProgram::begin_tile(const SampleTile& at, TileResult& out) const {
  tiles_.set_finished_rect(at, out);
  out.sampling = {};
  out.marks.clear();
  out.subpixels.clear();
  out.corrected.clear();
  out.buffer.reserve_samples(centre_samples() + std::size_t{kWhole} * tile_pixels());
  // A block that extends beyond the tile reads verdicts after the last one.
  out.buffer.reserve_subpixels(centre_samples(), tile_pixels() + kBlockHeight * tiles_.row_pitch() + kBlockWidth);
  out.work.frame = frame_;
  out.work.tile = at.index;
  out.work.samples = at.width * at.height;
}

SupersampleProgram::Tile SupersampleProgram::make_tile(const SampleTile& at, Wavefront& wave, TileResult& out) const {
  return {at, tiles_.finished_uniforms(at, out), out.width * out.height, wave, wave.tile_graph(), out, out.buffer};
}

void SupersampleProgram::run_tile(std::uint32_t tile_index, const traces::Tracer& tracer, bool record,
                                  TileResult& out) const {
  if (tile_index >= tiles_.tile_count()) return run_round(tile_index, tracer, record, out);
  const SampleTile at = tiles_.sample_tiles().sample_tile(order_[tile_index]);
  begin_tile(at, out);
  Wavefront wave(scene_, tracer, record, cone_uniforms(camera_, 1), out);
  TileGraph& graph = wave.tile_graph();
  Tile tile = make_tile(at, wave, out);
  out.linear.resize(tile.pixels);
  out.packed.resize(tile.pixels);
  out.marks.assign(tile.pixels, 0);

  // Trace one sample at the centre of every pixel. Borders need no halo, so they are exported before it is filled.
  trace_centres(tile, tiles_.halo_width(), tiles_.halo_width(), at.width, at.height, true);
  export_borders(tile);
  fill_halo(tile);
  spill_attributes_to_dram(tile);
  // Compare each sub-pixel with the three pixels around its corner. Sum the centre colours of the inactive sub-pixels.
  const Node tested = test_pixels(tile);
  const Node weighing = add_inactive_subpixels(tile, tested);
  // Trace four samples in every active sub-pixel, chunk by chunk, and add them to their pixels.
  if (supersample_.propagate != 0) store_inactive_subpixels(tile);
  const Node averaged = sample_active_subpixels(tile, tested, weighing);
  graph.write_pixels(averaged, std::uint64_t{at.index} * tile_pixels() * kPixelBytes);
  if (supersample_.propagate != 0) write_subpixels(tile);
  wave.finish();
  count_samples(tile);
}

/// Traces a sample at the centre of each pixel of a rectangle. (x, y) is the position of the rectangle's first pixel in
/// the tile buffer.
void SupersampleProgram::trace_centres(Tile& tile, std::uint32_t x, std::uint32_t y, std::uint32_t across,
                                       std::uint32_t down, bool is_own) const {
  Wavefront& wave = tile.wave;
  TileGraph& graph = tile.graph;
  TileBuffer& buffer = tile.buffer;
  const std::uint32_t items = across * down;
  ListSamples::Ports<float> list;
  list.lattice = tiles_.rect_sample_lattice(x, y, across);
  const Node listed = graph.launch<ListSamples>(list, items);

  buffer.reserve_wave(items);
  GenerateListedRays::Ports<float> generate;
  generate.camera = camera_;
  generate.grid = {.x0 = static_cast<float>(tile.at.x) - static_cast<float>(tiles_.halo_width()),
                   .y0 = static_cast<float>(tile.at.y) - static_cast<float>(tiles_.halo_width()),
                   .pitch = static_cast<float>(tiles_.row_pitch()),
                   .inverse_pitch = 1.0F / static_cast<float>(tiles_.row_pitch()),
                   .grid = 1,
                   .inverse_grid = 1};
  RetainedRecords retained;
  retained.traits = true;
  const Node generated = wave.generate_listed_rays(generate, buffer.checks.samples, listed, items, retained);
  wave.run(generated, items, retained);
  if (graph.is_muted()) return;
  tile.out.sampling.traced += items;
  if (!is_own) tile.out.sampling.halo += items;
}

/// Returns the contrast thresholds of all attributes. An attribute that is excluded from the comparison gets a
/// threshold that is never reached.
std::array<float, kAttributes> SupersampleProgram::attribute_thresholds() const {
  const SupersampleConfig& c = supersample_;
  const std::array<double, kAttributes> all{c.colour,           c.object,           c.normal,
                                            c.shadow,           c.texture,          c.secondary_object,
                                            c.secondary_normal, c.secondary_shadow, c.secondary_texture};
  std::array<float, kAttributes> reached{};
  std::ranges::transform(all, reached.begin(), [](double t) { return t < 0 ? kNever : static_cast<float>(t); });
  return reached;
}

/// Returns the index of the sample at the centre of a pixel that the tile finishes.
std::size_t SupersampleProgram::centre_sample_index(const Tile& tile, std::uint32_t pixel) {
  const DivMod<float> row = row_and_column<float>(static_cast<float>(pixel), tile.finished);
  return static_cast<std::size_t>(centre_sample<float>(row, tile.finished));
}

SupersampleProgram::Node SupersampleProgram::test_pixels(Tile& tile) const {
  TestSubpixels::Ports<float> ports;
  ports.finished = tile.finished;
  ports.secondary.bind(tile.buffer.subpixels.secondary_traits.data());
  ports.verdicts.bind(tile.buffer.subpixels.verdicts.data());
  ports.thresholds = attribute_thresholds();
  ports.compared = 0;
  for (std::size_t i = 0; i < kAttributes; ++i) {
    if (ports.thresholds[i] < kNever) ports.compared |= 1U << i;
  }
  ports.same_normal = static_cast<float>(supersample_.same_normal);
  ports.focus = supersample_.focus ? traces::kFocusObject : 0;
  ports.textured = ports.focus | kTexturedObject;
  const Node node = tile.graph.launch<TestSubpixels>(ports, 4 * tile.pixels);
  tile.graph.wait_for_record_writers(node);
  tile.graph.wait_for_colour_writers(node);
  return node;
}

SupersampleProgram::Node SupersampleProgram::add_inactive_subpixels(Tile& tile, Node tested) const {
  return supersample_.filter == SubpixelFilter::kBilinear ? launch_weighing<true>(tile, tested)
                                                          : launch_weighing<false>(tile, tested);
}

template <bool kBilinear>
SupersampleProgram::Node SupersampleProgram::launch_weighing(Tile& tile, Node tested) const {
  typename WeighCentres<kBilinear>::template Ports<float> ports;
  ports.finished = tile.finished;
  ports.verdicts.bind(tile.buffer.subpixels.verdicts.data());
  const Node node = tile.graph.launch<WeighCentres<kBilinear>>(ports, tile.pixels);
  tile.graph.wait_for_all(node, tested);
  return node;
}

void SupersampleProgram::count_samples(Tile& tile) const {
  TileResult& out = tile.out;
  Sampling& sampling = out.sampling;
  sampling.wanted = std::uint64_t{kWhole} * tile.pixels;
  sampling.traced_background = out.background.size();
  for (const std::uint32_t sample : out.background) sampling.background += sample >= centre_samples() ? 1 : 0;
  for (std::uint32_t pixel = 0; pixel < tile.pixels; ++pixel) {
    std::uint32_t active = 0, reasons = 0;
    for (std::uint32_t i = 0; i < 4; ++i) {
      const std::uint32_t verdict = tile.buffer.subpixels.verdicts[4 * pixel + i];
      if (active_bit<float>(verdict) == 0) continue;
      active += 1;
      reasons |= verdict & ((1U << kAttributes) - 1);
      for (std::size_t a = 0; a < kAttributes; ++a) sampling.reasons[a] += verdict >> a & 1U;
      sampling.first_reasons[static_cast<std::size_t>(std::countr_zero(verdict))] += 1;
    }
    out.marks[pixel] = static_cast<SampleMark>(reasons | active << kActiveCountShift);
    sampling.active[active] += 1;
    if (tile.buffer.subpixels.traits[centre_sample_index(tile, pixel)].object == kNoObject)
      sampling.background += kExtra * (4 - active);
  }
}

namespace {

using traces::Region;

/// Bytes that a neighbouring tile reads of each border sample.
constexpr std::uint32_t kExchangedBytes = 2 * sizeof(TraitsRecord<float>) + sizeof(ColourRecord<float>);

}  // namespace

// A tile stores in memory its last two columns, row by row, and its last two rows. If attributes are kept in DRAM, it
// also stores all attributes. With packing `atomic` it also stores the samples of active sub-pixels, because all must
// be traced before they are summed.
std::uint64_t SupersampleProgram::stored_bytes_per_tile() const {
  const bool is_parked = supersample_.attributes == AttributeStorage::kDram;
  const bool is_spilt = supersample_.packing == Packing::kAtomic;
  return tiles_.stored_samples() * kExchangedBytes +
         (is_parked ? std::uint64_t{centre_samples()} * kAttributeBytes : 0) +
         (is_spilt ? std::uint64_t{tile_pixels()} * kWhole * sizeof(ColourRecord<float>) : 0);
}

/// Fills the halo of a tile. The simulator always traces halo samples itself, so that pixels do not depend on tile
/// order. If the modelled tile reads these samples from memory, the recorded work is a transfer instead.
void SupersampleProgram::fill_halo(Tile& tile) const {
  tiles_.for_each_halo_part(tile.at, [&](const HaloPart& part) {
    if (supersample_.halo == Halo::kReload) {
      tile.graph.import_samples(part.border, stored_bytes_per_tile() * part.border.tile + part.first * kExchangedBytes,
                                part.across * part.down * kExchangedBytes);
      tile.graph.pause_recording();
    }
    trace_centres(tile, part.x, part.y, part.across, part.down, false);
    tile.graph.resume_recording();
  });
}

void SupersampleProgram::export_borders(Tile& tile) const {
  if (supersample_.halo == Halo::kRetrace) return;
  const std::uint64_t store = stored_bytes_per_tile() * tile.at.index;
  tiles_.for_each_export_border(tile.at, [&](std::uint32_t border, std::uint64_t first, std::uint32_t samples) {
    tile.graph.export_samples(border, store + first * kExchangedBytes, samples * kExchangedBytes);
  });
}

/// Writes the attributes of all samples to DRAM and reads them back, if attributes are kept there.
void SupersampleProgram::spill_attributes_to_dram(Tile& tile) const {
  if (supersample_.attributes == AttributeStorage::kTile) return;
  const std::uint32_t across = tile.at.width + (tile.at.has_left ? 2 : 0);
  const std::uint32_t bytes = across * (tile.at.height + (tile.at.has_above ? 2 : 0)) * kAttributeBytes;
  const std::uint64_t store = stored_bytes_per_tile() * tile.at.index + tiles_.stored_samples() * kExchangedBytes;
  const Node out = tile.graph.add_transfer(Region::kSamples, true, store, bytes);
  tile.graph.wait_for_record_writers(out);
  const Node in = tile.graph.add_transfer(Region::kSamples, false, store, bytes);
  tile.graph.wait_for_all(in, out);
  tile.graph.register_record_writer(in);
}

/// Samples the active sub-pixels that launch `tested` found, and adds the samples to the pixel sums of launch
/// `weighing`. Returns the launch that completes the tile's pixels.
SupersampleProgram::Node SupersampleProgram::sample_active_subpixels(Tile& tile, Node tested, Node weighing) const {
  std::vector<Chunk> chunks;
  const Node packed = list_active_subpixels(tile, tested, chunks);
  Node summed = weighing;
  std::uint32_t subpixels = 0;
  const bool is_spilt = supersample_.packing == Packing::kAtomic;
  for (const Chunk& chunk : chunks) {
    const std::uint32_t first_sample = centre_samples() + (is_spilt ? kExtra * chunk.first : 0);
    trace_chunk(tile, chunk, first_sample, packed);
    if (supersample_.propagate != 0) store_active_subpixels(tile, chunk, first_sample, 0);
    is_spilt ? spill_chunk(tile, chunk) : void(summed = sum_chunk(tile, chunk, weighing));
    tile.out.sampling.padding += chunk.padding;
    subpixels += chunk.subpixels;
  }
  tile.out.sampling.traced += kExtra * std::uint64_t{subpixels};
  if (is_spilt && subpixels != 0) summed = sum_samples_from_memory(tile, subpixels, weighing);
  return summed;
}

SupersampleProgram::Node SupersampleProgram::list_active_subpixels(Tile& tile, Node tested,
                                                                   std::vector<Chunk>& chunks) const {
  switch (supersample_.packing) {
    case Packing::kBlock:
      return pack_subpixels_by_block(tile, tested, chunks);
    case Packing::kAtomic:
      return pack_subpixels_by_atomics(tile, tested, chunks);
    case Packing::kNone:
      break;
  }
  chunk_all_subpixels(tile, chunks);
  return tested;
}

SupersampleProgram::Node SupersampleProgram::pack_subpixels_by_block(Tile& tile, Node tested,
                                                                     std::vector<Chunk>& chunks) const {
  TileBuffer& buffer = tile.buffer;
  const std::uint32_t across = (tile.out.width + kBlockWidth - 1) / kBlockWidth;
  const std::uint32_t down = (tile.out.height + kBlockHeight - 1) / kBlockHeight;
  PackSubpixels::Ports<float> ports;
  ports.across = static_cast<float>(across);
  ports.inverse_across = 1.0F / ports.across;
  ports.width = static_cast<float>(tile.out.width);
  ports.height = static_cast<float>(tile.out.height);
  ports.verdicts.bind(buffer.subpixels.verdicts.data());
  const Node node = tile.graph.launch<PackSubpixels>(ports, across * down * kBlockWidth * kBlockHeight);
  tile.graph.wait_for_all(node, tested);

  const auto length = static_cast<std::uint32_t>(ports.list_end.value);
  for (std::uint32_t first = 0, masters = 0; first < length; first += kChunk) {
    const std::uint32_t fill = buffer.subpixels.fills[first / kChunk];
    const std::uint32_t taken = fill & ((1U << PackSubpixels::kFillBits) - 1);
    const std::uint32_t masters_end = fill >> PackSubpixels::kFillBits;
    const std::uint32_t padding = first + kChunk < length ? kChunk - taken : 0;
    chunks.push_back({first, taken, padding, masters, masters_end - masters});
    masters = masters_end;
  }
  return node;
}

SupersampleProgram::Node SupersampleProgram::pack_subpixels_by_atomics(Tile& tile, Node tested,
                                                                       std::vector<Chunk>& chunks) const {
  TileBuffer& buffer = tile.buffer;
  const std::uint32_t subpixels = 4 * tile.pixels;
  // A stride near the golden section, so that neighbours in the list are far apart in the picture.
  std::uint32_t stride = static_cast<std::uint32_t>(std::uint64_t{subpixels} * 618 / 1000) | 1U;
  while (std::gcd(stride, subpixels) != 1) stride += 2;
  buffer.subpixels.fills[0] = 0;
  PackSubpixelsAtomic::Ports<float> ports;
  ports.verdicts.bind(buffer.subpixels.verdicts.data());
  ports.length.bind(buffer.subpixels.fills.data());
  ports.subpixel.value = static_cast<float>(sim::hash(frame_, tile.at.index) % subpixels);
  ports.stride = static_cast<float>(stride % subpixels);
  ports.subpixels = static_cast<float>(subpixels);
  const Node node = tile.graph.launch<PackSubpixelsAtomic>(ports, subpixels);
  tile.graph.wait_for_all(node, tested);
  for (std::uint32_t first = 0; first < buffer.subpixels.fills[0]; first += kChunk) {
    chunks.push_back({first, std::min(kChunk, buffer.subpixels.fills[0] - first), 0, 0, 0});
  }
  return node;
}

/// Divides all sub-pixels of a tile into chunks, without a list of active ones. Each item of a chunk tests whether its
/// sub-pixel is active.
void SupersampleProgram::chunk_all_subpixels(Tile& tile, std::vector<Chunk>& chunks) const {
  TileBuffer& buffer = tile.buffer;
  constexpr std::uint32_t kChunkPixels = kChunk / 4;
  std::uint32_t masters = 0;
  for (std::uint32_t pixel = 0; pixel < tile.pixels; pixel += kChunkPixels) {
    const std::uint32_t end = std::min(pixel + kChunkPixels, tile.pixels);
    const std::uint32_t first = pixel * 4;
    Chunk chunk{first, 0, 0, masters, 0};
    for (std::uint32_t subpixel = first; subpixel < 4 * end; ++subpixel) {
      std::uint32_t& verdict = buffer.subpixels.verdicts[subpixel];
      if (active_bit<float>(verdict) == 0) continue;
      const std::uint32_t index = first + chunk.subpixels++;
      verdict |= index << kIndexShift;
      buffer.subpixels.active[index] = subpixel;
      if (chunk.masters == 0 || buffer.subpixels.masters.entries[masters - 1] != subpixel / 4) {
        buffer.subpixels.masters.entries[masters++] = subpixel / 4;
        ++chunk.masters;
      }
    }
    chunk.padding = 4 * end - first - chunk.subpixels;
    chunks.push_back(chunk);
  }
}

/// Traces the samples of one chunk of active sub-pixels. The samples' colours are stored from index `first_sample` on.
void SupersampleProgram::trace_chunk(Tile& tile, const Chunk& chunk, std::uint32_t first_sample, Node after) const {
  Wavefront& wave = tile.wave;
  TileGraph& graph = tile.graph;
  TileBuffer& buffer = tile.buffer;
  const std::uint32_t items = kExtra * chunk.subpixels;
  const std::uint32_t padding = kExtra * chunk.padding;
  buffer.reserve_wave(items);
  wave.set_cone(cone_uniforms(camera_, kWholeGrid));
  GenerateExtraRays::Ports<float> generate;
  generate.active.bind(buffer.subpixels.active.data() + chunk.first);
  generate.camera = camera_;
  generate.x0 = static_cast<float>(tile.out.x);
  generate.y0 = static_cast<float>(tile.out.y);
  generate.width = tile.finished.width;
  generate.inverse_width = tile.finished.inverse_width;
  generate.first_sample = static_cast<float>(first_sample);
  generate.image_width = config_.width;
  generate.seed = jitter_seed(frame_);
  const Node generated = graph.launch<GenerateExtraRays>(generate, items, items + padding, padding);
  graph.wait_for_all(generated, after);
  graph.wait_for_colour_writers(generated);  // the ray slots are free when all colours have been added
  for (std::uint32_t i = 0; wave.wave_tracer().counts_pixels() && i < items; ++i) {
    const std::uint32_t pixel = buffer.subpixels.active[chunk.first + i / kExtra] / 4;
    wave.wave_tracer().assign_ray_to_pixel(i, tile.out.x + pixel % tile.out.width, tile.out.y + pixel / tile.out.width);
  }
  if (items != 0) wave.run(generated, items, {}, items + padding, padding);
}

/// Writes the samples of one chunk of active sub-pixels to memory. They stay there until all chunks of the tile are
/// traced.
void SupersampleProgram::spill_chunk(Tile& tile, const Chunk& chunk) const {
  TileGraph& graph = tile.graph;
  const std::uint32_t items = kExtra * chunk.subpixels;
  const std::uint64_t offset =
      stored_bytes_per_tile() * (tile.at.index + 1) -
      (std::uint64_t{tile_pixels()} * kWhole - std::uint64_t{kExtra} * chunk.first) * sizeof(ColourRecord<float>);
  const Node out = graph.add_transfer(traces::Region::kSamples, true, offset, items * sizeof(ColourRecord<float>));
  graph.wait_for_colour_writers(out);
  graph.replace_colour_writers(out);
}

SupersampleProgram::Node SupersampleProgram::sum_chunk(Tile& tile, const Chunk& chunk, Node weighing) const {
  const bool is_listed = supersample_.packing == Packing::kBlock;
  const std::uint32_t idle = is_listed ? 0 : (chunk.subpixels + chunk.padding) / 4 - chunk.masters;
  return sum_samples(tile, tile.buffer.subpixels.masters.entries.data() + chunk.first_master, chunk.masters, idle,
                     chunk.first, weighing);
}

SupersampleProgram::Node SupersampleProgram::sum_samples_from_memory(Tile& tile, std::uint32_t subpixels,
                                                                     Node weighing) const {
  const std::uint64_t offset = stored_bytes_per_tile() * (tile.at.index + 1) -
                               std::uint64_t{tile_pixels()} * kWhole * sizeof(ColourRecord<float>);
  const auto bytes = static_cast<std::uint32_t>(kExtra * subpixels * sizeof(ColourRecord<float>));
  const Node in = tile.graph.add_transfer(traces::Region::kSamples, false, offset, bytes);
  tile.graph.wait_for_colour_writers(in);
  tile.graph.replace_colour_writers(in);
  ListSamples::Ports<float> list;
  list.samples.bind(tile.buffer.subpixels.masters.entries.data());
  list.lattice = {.first = 0,
                  .across = static_cast<float>(tile.pixels),
                  .inverse_across = 1.0F / static_cast<float>(tile.pixels),
                  .step = 1,
                  .row_step = 0};
  const Node listed = tile.graph.launch<ListSamples>(list, tile.pixels);
  tile.graph.register_colour_writer(listed);
  return sum_samples(tile, tile.buffer.subpixels.masters.entries.data(), tile.pixels, 0, 0, weighing);
}

/// Completes the listed pixels by adding the samples of their active sub-pixels. `first_index`: index, in the list of
/// active sub-pixels, of the sub-pixel whose colours are stored first.
SupersampleProgram::Node SupersampleProgram::sum_samples(Tile& tile, std::uint32_t* listed, std::uint32_t pixels,
                                                         std::uint32_t padding, std::uint32_t first_index,
                                                         Node weighing) const {
  SumSubpixels::Ports<float> ports;
  ports.listed.bind(listed);
  ports.verdicts.bind(tile.buffer.subpixels.verdicts.data());
  ports.first_sample = static_cast<float>(centre_samples()) - static_cast<float>(kExtra * first_index);
  const Node node = tile.graph.launch<SumSubpixels>(ports, kWhole * pixels, 0, kWhole * padding);
  tile.graph.wait_for_all(node, weighing);
  tile.graph.wait_for_colour_writers(node);
  tile.graph.replace_colour_writers(node);
  return node;
}

}  // namespace kernels
