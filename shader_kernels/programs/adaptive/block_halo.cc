#include "shader_kernels/programs/adaptive/block_program.h"

namespace kernels {

using traces::Region;

/// The picture must not depend on who traces the halo, so a tile always has it; that of neighbours who keep it for this
/// tile is read back, not traced, as far as the machine is concerned.
void BlockProgram::make_halo_left(Tile& tile) const {
  const SampleTile& at = tile.at;
  if (!at.has_left) return;
  const std::uint32_t rows = at.height / tile.block;
  const std::uint32_t step = tile.block * pitch();
  if (adaptive_.halo == Halo::kRetrace) return trace_lattice(tile, step, 1, 0, step, rows, false);
  // A coarser neighbour has references in some rows only.
  const std::uint32_t stride = block_of(at.left) / tile.block > 1 ? block_of(at.left) / tile.block : 1;
  const std::uint32_t kept = rows / stride;
  if (kept != 0) {
    tile.wave.import_samples({at.left, kRightBorder},
                             store_bytes() * at.left + std::uint64_t{tiles_.side()} * exchanged_bytes(),
                             kept * exchanged_bytes());
    imported(tile, kept);
  }
  if (stride > 1) trace_lattice(tile, step, 1, 0, stride * step, rows - kept, false);
  tile.wave.mute();
  trace_lattice(tile, stride * step, 1, 0, stride * step, kept, false);
  tile.wave.unmute();
}

void BlockProgram::make_halo_above(Tile& tile) const {
  const SampleTile& at = tile.at;
  if (!at.has_above) return;
  if (adaptive_.halo == Halo::kReload) {
    tile.wave.import_samples({at.above, kLowerBorder}, store_bytes() * at.above, at.width * exchanged_bytes());
    imported(tile, at.width);
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

/// Leaves the references of the last column for the tile to the right, which asks for them before its first check.
void BlockProgram::export_right(Tile& tile) const {
  if (adaptive_.halo == Halo::kRetrace || !tile.at.has_right) return;
  tile.wave.export_samples(kRightBorder,
                           store_bytes() * tile.at.index + std::uint64_t{tiles_.side()} * exchanged_bytes(),
                           tile.at.height / tile.block * exchanged_bytes());
}

/// Leaves the last row for the tile below.
void BlockProgram::export_below(Tile& tile) const {
  if (adaptive_.halo == Halo::kRetrace || !tile.at.has_below) return;
  tile.wave.export_samples(kLowerBorder, store_bytes() * tile.at.index, tile.at.width * exchanged_bytes());
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
