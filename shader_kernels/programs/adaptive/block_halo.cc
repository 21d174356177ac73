#include "shader_kernels/programs/adaptive/block_program.h"

namespace kernels {

using traces::Region;

/// The picture must not depend on who traces the halo, so a tile always has it; that of neighbours who keep it for this
/// tile is read back, not traced, as far as the machine is concerned.
void BlockProgram::make_halo(Tile& tile) const {
  const SampleTile& at = tile.at;
  const bool reloads = adaptive_.halo == Halo::kReload;
  const std::uint32_t rows = at.height / tile.block;
  if (reloads) {
    if (at.has_left) tile.out.work.after.push_back(at.left);
    if (at.has_above) tile.out.work.after.push_back(at.above);
  }
  if (at.has_left) {
    // A coarser neighbour has references in some rows only.
    const std::uint32_t stride = block_of(at.left) / tile.block > 1 ? block_of(at.left) / tile.block : 1;
    const std::uint32_t step = tile.block * pitch();
    if (reloads) {
      const std::uint32_t kept = rows / stride;
      import_samples(tile, store_bytes() * at.left + std::uint64_t{tiles_.side()} * exchanged_bytes(), kept);
      if (stride > 1) trace_lattice(tile, step, 1, 0, stride * step, rows - kept, false);
      tile.wave.mute();
      trace_lattice(tile, stride * step, 1, 0, stride * step, kept, false);
      tile.wave.unmute();
    } else {
      trace_lattice(tile, step, 1, 0, step, rows, false);
    }
  }
  if (!at.has_above) return;
  if (reloads) {
    import_samples(tile, store_bytes() * at.above, at.width);
    tile.wave.mute();
  }
  trace_row_above(tile);
  tile.wave.unmute();
}

/// As the tile above makes its last row.
void BlockProgram::trace_row_above(Tile& tile) const {
  const SampleTile& at = tile.at;
  const std::uint32_t block = block_of(at.above);
  const std::uint32_t columns = at.width / block;
  const std::uint32_t corner = at.has_left ? 1 : 0;
  trace_lattice(tile, at.has_left ? 0 : block, columns + corner, block, 0, columns + corner, false);
  resolve(tile, false, line_along_x(tile, block, true), at.width - columns, false);
}

void BlockProgram::import_samples(Tile& tile, std::uint64_t offset, std::uint32_t samples) const {
  if (samples == 0) return;
  const Wavefront::Node node = tile.wave.transfer(Region::kSamples, false, offset, samples * exchanged_bytes());
  tile.wave.adds_records(node);
  tile.wave.adds_colours(node);
}

/// Leaves the last row and the references of the last column for the neighbours who ask for them.
void BlockProgram::export_borders(Tile& tile) const {
  if (adaptive_.halo == Halo::kRetrace) return;
  const SampleTile& at = tile.at;
  const auto put = [&](std::uint64_t offset, std::uint32_t samples) {
    const Wavefront::Node node = tile.wave.transfer(Region::kSamples, true, offset, samples * exchanged_bytes());
    tile.wave.wait_for_records(node);
    tile.wave.wait_for_colours(node);
  };
  const std::uint64_t store = store_bytes() * at.index;
  if (at.has_below) put(store, at.width);
  if (at.has_right) put(store + std::uint64_t{tiles_.side()} * exchanged_bytes(), at.height / tile.block);
}

/// Writes attributes of samples to memory and reads those back that the next check looks at, if that is where they are.
void BlockProgram::park_attributes(Tile& tile, std::uint32_t written, std::uint32_t read) const {
  if (adaptive_.attributes == AttributeStorage::kTile || written == 0) return;
  const std::uint64_t store = store_bytes() * tile.at.index + 2 * std::uint64_t{tiles_.side()} * exchanged_bytes();
  const Wavefront::Node out = tile.wave.transfer(Region::kSamples, true, store, written * setup_.record_bytes);
  tile.wave.wait_for_records(out);
  const Wavefront::Node in = tile.wave.transfer(Region::kSamples, false, store, read * setup_.record_bytes);
  tile.wave.wait_all(in, out);
  tile.wave.adds_records(in);
}

}  // namespace kernels
