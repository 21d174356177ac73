#include "shader_kernels/programs/reconstruct/reconstruct.h"

namespace kernels {

using traces::Region;

/// Bytes of a border's pixel. Of its columns or rows those at the outer side of the halo are only looked at, so of them
/// the shaded samples go; the inner half is finished by the neighbour, which needs the other samples, too.
std::uint32_t ReconstructProgram::exchanged_bytes() const { return shaded_bytes() + other_bytes() / 2; }

// A tile's store: its borders (finished_tiles.h); all attributes if they do not stay.
std::uint64_t ReconstructProgram::store_bytes() const {
  const bool is_parked = reconstruct_.attributes == AttributeStorage::kDram;
  return tiles_.stored_samples() * exchanged_bytes() + (is_parked ? std::uint64_t{positions()} * attribute_bytes() : 0);
}

/// As block_halo.cc has it: a tile always makes its halo; where neighbours keep theirs, the machine reads it back.
void ReconstructProgram::make_halo(Tile& tile) const {
  tiles_.for_each_part(tile.at, [&](const HaloPart& part) {
    const bool is_left = part.x < tiles_.halo(), is_above = part.y < tiles_.halo();
    const HaloPart inner = part.inner(is_left ? reconstruct_.radius : part.across,  //
                                      is_above ? reconstruct_.radius : part.down);
    if (reconstruct_.halo == Halo::kReload) {
      tile.wave.import_samples(part.border, store_bytes() * part.border.tile + part.first * exchanged_bytes(),
                               part.across * part.down * exchanged_bytes());
      tile.wave.mute();
    }
    trace(tile, {part.x, part.y, part.across, part.down}, {inner.x, inner.y, inner.across, inner.down}, false);
    tile.wave.unmute();
  });
}

void ReconstructProgram::export_borders(Tile& tile) const {
  if (reconstruct_.halo == Halo::kRetrace) return;
  const std::uint64_t store = store_bytes() * tile.at.index;
  tiles_.for_each_export(tile.at, [&](std::uint32_t border, std::uint64_t first, std::uint32_t samples) {
    tile.wave.export_samples(border, store + first * exchanged_bytes(), samples * exchanged_bytes());
  });
}

/// Writes all attributes to memory and reads them back, if that is where they are.
void ReconstructProgram::park_attributes(Tile& tile) const {
  if (reconstruct_.attributes == AttributeStorage::kTile || !has_geometry()) return;
  const std::uint32_t across = tile.at.width + (tile.at.has_left ? tiles_.halo() : 0);
  const std::uint32_t down = tile.at.height + (tile.at.has_above ? tiles_.halo() : 0);
  const std::uint32_t bytes = across * down * attribute_bytes();
  const std::uint64_t store = store_bytes() * tile.at.index + tiles_.stored_samples() * exchanged_bytes();
  const Node out = tile.wave.transfer(Region::kSamples, true, store, bytes);
  tile.wave.wait_for_records(out);
  const Node in = tile.wave.transfer(Region::kSamples, false, store, bytes);
  tile.wave.wait_all(in, out);
  tile.wave.adds_records(in);
}

}  // namespace kernels
