#include "shader_kernels/programs/adaptive/block_tile.h"

#include <algorithm>
#include <bit>
#include <numeric>

namespace kernels {

std::uint32_t scattered_bytes(std::uint64_t records, std::uint64_t all) {
  constexpr std::uint64_t kLine = 64;  // bytes of memory that a transfer of one record moves
  return static_cast<std::uint32_t>(std::min(records * kLine, all));
}

SampleTiles::SampleTiles(std::uint32_t width, std::uint32_t height, std::uint32_t samples_per_side, std::uint32_t side,
                         std::uint32_t block)
    : width_(width * samples_per_side), height_(height * samples_per_side), grid_(samples_per_side) {
  const std::uint32_t whole = std::lcm(samples_per_side, block);
  side_ = std::max(whole, side / whole * whole);
  across_ = (width_ + side_ - 1) / side_;
  down_ = (height_ + side_ - 1) / side_;
}

SampleTile SampleTiles::sample_tile(std::uint32_t index) const {
  SampleTile t;
  const std::uint32_t column = index % across_;
  const std::uint32_t row = index / across_;
  t.index = index;
  t.x = column * side_;
  t.y = row * side_;
  t.width = std::min(side_, width_ - t.x);
  t.height = std::min(side_, height_ - t.y);
  t.has_left = column > 0;
  t.has_above = row > 0;
  t.has_right = column + 1 < across_;
  t.has_below = row + 1 < down_;
  if (t.has_left) t.left = index - 1;
  if (t.has_above) t.above = index - across_;
  if (t.has_left && t.has_above) t.above_left = index - across_ - 1;
  return t;
}

std::vector<std::uint32_t> SampleTiles::rendering_order(Halo halo) const {
  std::vector<std::uint32_t> order(tile_count());
  std::iota(order.begin(), order.end(), 0U);
  if (halo == Halo::kRetrace) return order;
  std::ranges::stable_sort(order, {}, [&](std::uint32_t i) { return i % across_ + i / across_; });
  return order;
}

HaloPart HaloPart::part_nearest_tile(std::uint32_t columns, std::uint32_t rows) const {
  HaloPart part = *this;
  part.across = std::min(across, columns);
  part.down = std::min(down, rows);
  part.x += across - part.across;
  part.y += down - part.down;
  return part;
}

void FinishedTiles::set_finished_rect(const SampleTile& at, TileResult& out) const {
  const std::uint32_t left = at.has_left ? reach_ : 0;
  const std::uint32_t above = at.has_above ? reach_ : 0;
  out.tile = at.index;
  out.x = at.x - left;
  out.y = at.y - above;
  out.width = at.width + left - (at.has_right ? reach_ : 0);
  out.height = at.height + above - (at.has_below ? reach_ : 0);
}

FinishedUniforms<float> FinishedTiles::finished_uniforms(const SampleTile& at, const TileResult& out) const {
  const std::uint32_t left = at.has_left ? reach_ : 0;
  const std::uint32_t above = at.has_above ? reach_ : 0;
  const auto width = static_cast<float>(out.width), height = static_cast<float>(out.height);
  const auto reach = static_cast<float>(reach_);
  return {.width = width,
          .inverse_width = 1.0F / width,
          .first = static_cast<float>((halo_width() - above) * row_pitch() + halo_width() - left),
          .pitch = static_cast<float>(row_pitch()),
          .low_x = at.has_left ? -reach : 0.0F,
          .high_x = at.has_right ? width + reach - 1.0F : width - 1.0F,
          .low_y = at.has_above ? -reach : 0.0F,
          .high_y = at.has_below ? height + reach - 1.0F : height - 1.0F};
}

LatticeUniforms<float> FinishedTiles::rect_sample_lattice(std::uint32_t x, std::uint32_t y,
                                                          std::uint32_t across) const {
  return {.first = static_cast<float>(y * row_pitch() + x),
          .across = static_cast<float>(across),
          .inverse_across = 1.0F / static_cast<float>(across),
          .step = 1,
          .row_step = static_cast<float>(row_pitch())};
}

using traces::Region;

namespace {

float inverse_or_one(std::uint32_t n) { return 1.0F / static_cast<float>(std::max(n, 1U)); }

LineUniforms<float> line_uniforms(std::uint32_t inner, std::uint32_t block) {
  LineUniforms<float> line{};
  line.inner = static_cast<float>(inner);
  line.inverse_inner = inverse_or_one(inner);
  line.gaps = static_cast<float>(block - 1);
  line.inverse_gaps = inverse_or_one(block - 1);
  line.block = static_cast<float>(block);
  line.inverse_block = inverse_or_one(block);
  return line;
}

}  // namespace

BlockFrame::BlockFrame(const traces::MemoryImage& image, const traces::Camera& viewer, const RenderConfig& config,
                       const AdaptiveConfig& keys, const BlockSetup& properties, std::uint32_t frame)
    : adaptive(keys),
      setup(properties),
      scene(image, config),
      camera(camera_uniforms(viewer, config.width, config.height)),
      tiles(config.width, config.height, setup.grid, config.tile, setup.whole),
      order(tiles.rendering_order(keys.halo)),
      number(frame) {}

std::uint64_t BlockFrame::stored_bytes_per_tile() const {
  const std::uint64_t side = tiles.tile_side();
  return 2 * side * exchanged_bytes_per_sample() +
         (adaptive.attributes == AttributeStorage::kDram ? side * side * setup.record_bytes : 0);
}

std::uint32_t BlockFrame::exchanged_bytes_per_sample() const {
  return setup.record_bytes + static_cast<std::uint32_t>(sizeof(ColourRecord<float>));
}

FrameRequirements BlockFrame::requirements() const {
  const std::uint32_t side = tiles.tile_side();
  const std::uint32_t kept = side * (side / setup.block);  // only rows with references are compared again, along y
  const std::uint32_t pixels = side / setup.grid * (side / setup.grid);
  FrameRequirements needs;
  needs.tile_samples = side * side;
  needs.wave_samples = side * side / setup.whole * (setup.whole - 1);  // the samples that are checked along y
  needs.attribute_bytes = adaptive.attributes == AttributeStorage::kTile ? kept * setup.record_bytes : 0;
  needs.region_bytes = {std::uint64_t{tiles.tile_count()} * pixels * kPixelBytes,
                        tiles.tile_count() * stored_bytes_per_tile(), setup.carries_rates ? tiles.tile_count() : 0};
  return needs;
}

LatticeUniforms<float> BlockFrame::own_sample_lattice(const SampleTile& at) const {
  return {.first = static_cast<float>(row_pitch() + 1),
          .across = static_cast<float>(at.width),
          .inverse_across = inverse_or_one(at.width),
          .step = 1,
          .row_step = static_cast<float>(row_pitch())};
}

GridUniforms<float> BlockFrame::grid_uniforms(float x0, float y0, std::uint32_t row_samples) const {
  return {.x0 = x0,
          .y0 = y0,
          .pitch = static_cast<float>(row_samples),
          .inverse_pitch = inverse_or_one(row_samples),
          .grid = static_cast<float>(setup.grid),
          .inverse_grid = inverse_or_one(setup.grid)};
}

void BlockFrame::allocate_counts(Sampling& frame_counts) const {
  frame_counts.similar.resize(tiles.tile_count());
  frame_counts.blocks.resize(tiles.tile_count());
  frame_counts.tile_side = tiles.tile_side();
}

void BlockFrame::count_tile(const TileResult& tile, std::uint32_t block, Sampling& frame_counts) const {
  const Sampling& of = tile.sampling;
  frame_counts.has_rates = setup.carries_rates;
  frame_counts.similar[tile.tile] =
      of.checked == 0 ? 1.0F : static_cast<float>(of.passed - of.rough) / static_cast<float>(of.checked);
  frame_counts.blocks[tile.tile] = static_cast<std::uint8_t>(block);
}

BlockTile::BlockTile(const BlockFrame& frame, const SampleTile& tile, const traces::Tracer& tracer, bool record,
                     TileResult& result)
    : at(tile),
      out(result),
      buffer(result.buffer),
      wave(frame.scene, tracer, record, frame.ray_cone(), result),
      graph(wave.tile_graph()),
      frame_(frame) {
  const std::uint32_t grid = frame.setup.grid;
  out.tile = at.index;
  out.x = at.x / grid;
  out.y = at.y / grid;
  out.width = at.width / grid;
  out.height = at.height / grid;
  out.linear.resize(std::size_t{out.width} * out.height);
  out.packed.resize(out.linear.size());
  out.sampling = {};
  out.marks.assign(std::size_t{at.width} * at.height, 0);
  // A kernel may load a sample after the last row in place of a missing reference. It does not use the value.
  buffer.reserve_samples(std::size_t{frame.row_pitch()} * (frame.row_pitch() + frame.setup.whole));
  out.work.frame = frame.number;
  out.work.tile = at.index;
  out.work.samples = at.width * at.height;
}

/// Reads from memory the block sides of this tile and of the neighbours in its halo.
void BlockTile::read_block_sides() {
  const std::uint32_t first = at.has_left ? at.left : at.index;
  start_ = graph.add_transfer(Region::kRates, false, first, at.index - first + 1);
  if (!at.has_above) return;
  const Wavefront::Node above = graph.add_transfer(Region::kRates, false, at.above, 1);
  graph.wait_for_all(above, start_);
  start_ = above;
}

BlockLines BlockTile::lines_along_x(std::uint32_t block, bool is_own) const {
  const std::uint32_t pitch = frame_.row_pitch(), between = at.width - at.width / block;
  BlockLines lines{line_uniforms(between, block), false, is_own ? block_rows() * between : between, is_own};
  lines.uniforms.first = is_own ? static_cast<float>(block * pitch) : 0.0F;
  lines.uniforms.step = 1;
  lines.uniforms.line_step = static_cast<float>(block * pitch);
  lines.uniforms.low = at.has_left ? 0.0F : 1.0F;
  lines.uniforms.high = static_cast<float>(at.width);
  return lines;
}

BlockLines BlockTile::lines_along_y() const {
  BlockLines lines{line_uniforms(at.width, block_), true, (at.height - block_rows()) * at.width, true};
  lines.uniforms.first = 1;
  lines.uniforms.step = static_cast<float>(frame_.row_pitch());
  lines.uniforms.line_step = 1;
  lines.uniforms.low = at.has_above ? 0.0F : 1.0F;
  lines.uniforms.high = static_cast<float>(at.height);
  return lines;
}

void BlockTile::trace_references() {
  const std::uint32_t pitch = frame_.row_pitch();
  trace_lattice(block_ * (pitch + 1), block_columns(), block_, block_ * pitch, block_rows() * block_columns(), true);
}

void BlockTile::trace_lattice(std::uint32_t first, std::uint32_t across, std::uint32_t step, std::uint32_t row_step,
                              std::uint32_t items, bool is_own) {
  if (items == 0) return;
  ListSamples::Ports<float> ports;
  ports.lattice = {.first = static_cast<float>(first),
                   .across = static_cast<float>(across),
                   .inverse_across = inverse_or_one(across),
                   .step = static_cast<float>(step),
                   .row_step = static_cast<float>(row_step)};
  const Wavefront::Node listed = graph.launch<ListSamples>(ports, items);
  graph.wait_for_all(listed, start_);
  trace_listed_samples(buffer.checks.samples, listed, items, frame_.setup.before_check_y, is_own, items);
  if (!is_own) return;
  const std::uint32_t pitch = frame_.row_pitch();
  for (std::uint32_t i = 0; i < items; ++i) {
    const std::uint32_t sample = buffer.checks.samples.entries[i];
    out.marks[std::size_t{sample / pitch - 1} * at.width + sample % pitch - 1] = kTracedMark | kReferenceMark;
  }
}

void BlockTile::trace_listed_samples(SampleQueue& list, Wavefront::Node lister, std::uint32_t items,
                                     const RetainedRecords& kept, bool is_own, std::uint32_t lanes) {
  if (items == 0) return;
  buffer.reserve_wave(items);
  GenerateListedRays::Ports<float> generate;
  generate.camera = frame_.camera;
  generate.grid =
      frame_.grid_uniforms(static_cast<float>(at.x) - 1.0F, static_cast<float>(at.y) - 1.0F, frame_.row_pitch());
  RetainedRecords retained = kept;
  const Wavefront::Node generated = wave.generate_listed_rays(generate, list, lister, items, retained, lanes);
  wave.run(generated, items, retained, lanes);
  if (retained.surfaces) record_global_light(list, items, lanes, frame_.setup.faint);
  if (graph.is_muted()) return;
  out.sampling.traced += items;
  if (!is_own) out.sampling.halo += items;
}

/// Records the global colour of each listed sample, for the colour check of the program undersample. Global colour is
/// the light that does not come from lights at the first hit.
void BlockTile::record_global_light(SampleQueue& list, std::uint32_t items, std::uint32_t lanes, float faint) {
  const auto launch = [&]<class K>(typename K::template Ports<float>& ports) {
    ports_of<RecordGlobal>(ports).samples.bind(list.entries.data());
    const Wavefront::Node node = graph.launch<K>(ports, items, lanes);
    graph.wait_for_colour_writers(node);
    graph.register_record_writer(node);
  };
  if (!frame_.scene.fuses) {
    RecordGlobal::Ports<float> ports;
    return launch.operator()<RecordGlobal>(ports);
  }
  RecordCounted::Ports<float> ports;
  ports_of<CountColoured>(ports).samples.bind(list.entries.data());
  ports_of<CountColoured>(ports).faint = faint;
  launch.operator()<RecordCounted>(ports);
  coloured += ports_of<CountColoured>(ports).coloured_count.value;
}

void BlockTile::trace_failed_samples(const BlockLines& lines, const Verdict& verdict) {
  if (lines.is_own) mark_samples(lines, verdict);
  const RetainedRecords& kept = lines.along_y ? frame_.setup.after_check_y : frame_.setup.before_check_y;
  trace_listed_samples(buffer.checks.failed, verdict.node, verdict.failed, kept, lines.is_own, lines.samples);
  if (!lines.is_own || !lines.along_y || !frame_.setup.carries_rates) return;
  const Wavefront::Node written = graph.add_transfer(Region::kRates, true, at.index, 1);
  graph.wait_for_all(written, verdict.node);
}

/// Counts the results of a similarity check, and marks the checked samples for debug pictures.
void BlockTile::mark_samples(const BlockLines& lines, const Verdict& verdict) {
  const std::uint32_t pitch = frame_.row_pitch();
  const auto own = [&](std::uint32_t sample) -> SampleMark& {
    return out.marks[std::size_t{sample / pitch - 1} * at.width + sample % pitch - 1];
  };
  Sampling& sampling = out.sampling;
  const auto step = static_cast<std::uint32_t>(lines.uniforms.step);
  std::uint32_t unchecked = 0;
  for (std::uint32_t i = 0; i < verdict.passed; ++i) {
    const std::uint32_t word = buffer.checks.passed.entries[i];
    const std::uint32_t sample = word & kSampleMask;
    const std::uint32_t before = sample - ((word >> kGapShift) + 1) * step;
    if (buffer.samples.geometry[before].object == kNoObject) sampling.background += 1;
    own(sample) = 0;
  }
  for (std::uint32_t i = 0; i < verdict.failed; ++i) {
    const std::uint32_t sample = buffer.checks.failed.entries[i];
    const std::uint32_t failed = buffer.checks.verdicts[sample];
    if (failed == check_bit(Check::kBorder)) unchecked += 1;
    own(sample) = static_cast<SampleMark>(failed | kTracedMark);
    for (std::size_t check = 0; check < sampling.failed.size(); ++check) sampling.failed[check] += failed >> check & 1U;
    sampling.first_failed[static_cast<std::size_t>(std::countr_zero(failed))] += 1;
  }
  sampling.checked += verdict.passed + verdict.failed - unchecked;
  sampling.passed += verdict.passed;
  sampling.rough += verdict.rough;
}

void BlockTile::import_samples(std::uint32_t tile, std::uint32_t border, std::uint64_t offset, std::uint32_t samples) {
  graph.import_samples({tile, border}, frame_.stored_bytes_per_tile() * tile + offset,
                       samples * frame_.exchanged_bytes_per_sample());
  if (!frame_.scene.fuses || !frame_.setup.before_check_y.surfaces) return;
  // The modelled machine counts imported samples here. The host has counted them when they were traced.
  const Wavefront::Node counted = graph.record_known_launch<CountColoured>(samples);
  graph.wait_for_record_writers(counted);
  graph.register_record_writer(counted);
}

/// Fills the left halo of a tile. The simulator always traces halo samples itself, so that pixels do not depend on tile
/// order. If the modelled tile reads these samples from memory, the recorded work is a transfer instead.
void BlockTile::import_left_halo() {
  if (!at.has_left) return;
  const std::uint32_t step = block_ * frame_.row_pitch();
  if (frame_.adaptive.halo == Halo::kRetrace) return trace_lattice(step, 1, 0, step, block_rows(), false);
  // A neighbour with larger blocks has references in some rows only.
  const std::uint32_t stride = left_block_ / block_ > 1 ? left_block_ / block_ : 1;
  const std::uint32_t kept = block_rows() / stride;
  if (kept != 0) {
    import_samples(at.left, kRightBorder, std::uint64_t{frame_.tiles.tile_side()} * frame_.exchanged_bytes_per_sample(),
                   kept);
  }
  if (stride > 1) trace_lattice(step, 1, 0, stride * step, block_rows() - kept, false);
  graph.pause_recording();
  trace_lattice(stride * step, 1, 0, stride * step, kept, false);
  graph.resume_recording();
}

bool BlockTile::begin_upper_halo_import() {
  if (!at.has_above) return false;
  if (frame_.adaptive.halo == Halo::kReload) {
    import_samples(at.above, kLowerBorder, 0, at.width);
    graph.pause_recording();
  }
  return true;
}

/// Traces the reference samples in the last row of the tile above, and the corner sample.
void BlockTile::trace_references_above() {
  const std::uint32_t columns_above = at.width / above_block_, corner = at.has_left ? 1 : 0;
  trace_lattice(at.has_left ? 0 : above_block_, columns_above + corner, above_block_, 0, columns_above + corner, false);
}

void BlockTile::export_right_border() {
  if (frame_.adaptive.halo == Halo::kRetrace || !at.has_right) return;
  const std::uint64_t bytes = frame_.exchanged_bytes_per_sample();
  graph.export_samples(kRightBorder, frame_.stored_bytes_per_tile() * at.index + frame_.tiles.tile_side() * bytes,
                       block_rows() * frame_.exchanged_bytes_per_sample());
}

void BlockTile::export_lower_border() {
  if (frame_.adaptive.halo == Halo::kRetrace || !at.has_below) return;
  graph.export_samples(kLowerBorder, frame_.stored_bytes_per_tile() * at.index,
                       at.width * frame_.exchanged_bytes_per_sample());
}

void BlockTile::add_spill_transfers(std::uint32_t records_written, std::uint32_t records_read) {
  if (frame_.adaptive.attributes == AttributeStorage::kTile || records_written == 0) return;
  const std::uint64_t borders = 2 * std::uint64_t{frame_.tiles.tile_side()} * frame_.exchanged_bytes_per_sample();
  const std::uint64_t store = frame_.stored_bytes_per_tile() * at.index + borders;
  const Wavefront::Node to_dram =
      graph.add_transfer(Region::kSamples, true, store, records_written * frame_.setup.record_bytes);
  graph.wait_for_record_writers(to_dram);
  const Wavefront::Node back =
      graph.add_transfer(Region::kSamples, false, store, records_read * frame_.setup.record_bytes);
  graph.wait_for_all(back, to_dram);
  graph.register_record_writer(back);
}

void BlockTile::average_pixels() {
  if (can_pack_samples()) {
    PackGridSample::Ports<float> pack;
    pack.lattice = frame_.own_sample_lattice(at);
    return write_packed_pixels(graph.launch<PackGridSample>(pack, at.width * at.height));
  }
  const std::uint32_t grid = frame_.setup.grid, per_pixel = grid * grid;
  AverageSamples::Ports<float> ports;
  ports.samples = static_cast<float>(per_pixel);
  ports.inverse_samples = inverse_or_one(per_pixel);
  ports.width = static_cast<float>(out.width);
  ports.inverse_width = inverse_or_one(out.width);
  ports.grid = static_cast<float>(grid);
  ports.inverse_grid = inverse_or_one(grid);
  ports.first = static_cast<float>(frame_.row_pitch() + 1);
  ports.pitch = static_cast<float>(frame_.row_pitch());
  const Wavefront::Node averaged = graph.launch<AverageSamples>(ports, out.width * out.height * per_pixel);
  graph.wait_for_colour_writers(averaged);
  graph.write_pixels(averaged, frame_.picture_bytes() * at.index);
}

void BlockTile::write_packed_pixels(Wavefront::Node packed) {
  graph.wait_for_colour_writers(packed);
  graph.write_packed_pixels(packed, frame_.picture_bytes() * at.index);
}

void BlockTile::finish() {
  wave.finish();
  Sampling& sampling = out.sampling;
  sampling.wanted = std::uint64_t{at.width} * at.height;
  sampling.traced_background = out.background.size();
  const std::uint32_t pitch = frame_.row_pitch();
  for (const std::uint32_t sample : out.background) {
    if (sample % pitch != 0 && sample / pitch != 0) sampling.background += 1;
  }
}

}  // namespace kernels
