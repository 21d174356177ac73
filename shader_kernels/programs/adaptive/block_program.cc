#include "shader_kernels/programs/adaptive/block_program.h"

namespace kernels {

BlockProgram::BlockProgram(const traces::MemoryImage& image, const traces::Camera& camera, const RenderConfig& config,
                           const AdaptiveConfig& adaptive, const Setup& setup, std::uint32_t frame)
    : FrameProgram(config.width, config.height),
      config_(config),
      adaptive_(adaptive),
      setup_(setup),
      scene_(image, config),
      camera_(camera_uniforms(camera, config.width, config.height)),
      tiles_(config.width, config.height, setup.grid, config.tile, setup.whole),
      order_(tiles_.order(adaptive.halo)),
      frame_(frame) {
  kept_sampling().similar.resize(tiles_.count());
  kept_sampling().blocks.resize(tiles_.count());
  kept_sampling().tile_side = tiles_.side();
}

std::uint64_t BlockProgram::store_bytes() const {
  // Its last row, its last column, and all attributes if they do not stay.
  const std::uint64_t side = tiles_.side();
  return 2 * side * exchanged_bytes() +
         (adaptive_.attributes == AttributeStorage::kDram ? side * side * setup_.record_bytes : 0);
}

std::uint32_t BlockProgram::exchanged_bytes() const {
  return setup_.record_bytes + static_cast<std::uint32_t>(sizeof(ColourRecord<float>));
}

FrameRequirements BlockProgram::requirements() const {
  const std::uint32_t side = tiles_.side();
  const std::uint32_t kept = side * (side / setup_.block);  // rows of references; others are never compared
  const std::uint32_t pixels = side / setup_.grid * (side / setup_.grid);
  FrameRequirements needs;
  needs.tile_samples = side * side;
  needs.wave_samples = side * side / setup_.whole * (setup_.whole - 1);  // those checked along y
  needs.attribute_bytes = adaptive_.attributes == AttributeStorage::kTile ? kept * setup_.record_bytes : 0;
  needs.region_bytes = {std::uint64_t{tiles_.count()} * pixels * kPixelBytes, tiles_.count() * store_bytes(),
                        carries_rates() ? tiles_.count() : 0};
  return needs;
}

void BlockProgram::run_tile(std::uint32_t tile_index, const traces::Tracer& tracer, bool record,
                            TileResult& out) const {
  const std::uint32_t grid = setup_.grid;
  const SampleTile at = tiles_.tile(order_[tile_index]);
  out.tile = at.index;
  out.x = at.x / grid;
  out.y = at.y / grid;
  out.width = at.width / grid;
  out.height = at.height / grid;
  out.linear.resize(std::size_t{out.width} * out.height);
  out.packed.resize(out.linear.size());
  out.sampling = {};
  out.marks.assign(std::size_t{at.width} * at.height, 0);
  // Samples behind the last row may be read, for a reference that is not there; nothing comes of it.
  out.buffer.hold_samples(std::size_t{pitch()} * (pitch() + setup_.whole));

  Wavefront wave(scene_, tracer, record, cone(), out);
  out.work.frame = frame_;
  out.work.tile = at.index;
  out.work.samples = at.width * at.height;
  Tile tile{at, block_of(at.index), wave, out, out.buffer};
  if (carries_rates()) read_rates(tile);

  const std::uint32_t rows = at.height / tile.block;
  const std::uint32_t columns = at.width / tile.block;
  const std::uint32_t beside = rows * (at.width - columns);
  trace_lattice(tile, tile.block * (pitch() + 1), columns, tile.block, tile.block * pitch(), rows * columns, true);
  // A border goes out as soon as it is complete, before anything of a neighbour's that it does not need: so no tile
  // waits for more than a few others, one behind the other.
  export_right(tile);
  make_halo_left(tile);
  park_attributes(tile, rows * columns, rows * columns);
  resolve(tile, false, line_along_x(tile, tile.block, false), beside, true);
  export_below(tile);
  make_halo_above(tile);
  park_attributes(tile, beside, rows * at.width);
  resolve(tile, true, line_along_y(tile), (at.height - rows) * at.width, true);
  settled(tile);
  average(tile);
  wave.finish();
  count(tile);
}

/// The tile's own and those of the tiles that its halo belongs to.
void BlockProgram::read_rates(Tile& tile) const {
  const SampleTile& at = tile.at;
  const std::uint32_t first = at.has_left ? at.left : at.index;
  tile.start = tile.wave.transfer(traces::Region::kRates, false, first, at.index - first + 1);
  if (!at.has_above) return;
  const Wavefront::Node above = tile.wave.transfer(traces::Region::kRates, false, at.above, 1);
  tile.wave.wait_all(above, tile.start);
  tile.start = above;
}

void BlockProgram::keep(const TileResult& tile) {
  FrameProgram::keep(tile);
  kept_sampling().has_rates = carries_rates();
  const Sampling& of = tile.sampling;
  kept_sampling().similar[tile.tile] =
      of.checked == 0 ? 1.0F : static_cast<float>(of.passed - of.rough) / static_cast<float>(of.checked);
  kept_sampling().blocks[tile.tile] = static_cast<std::uint8_t>(block_of(tile.tile));
}

}  // namespace kernels
