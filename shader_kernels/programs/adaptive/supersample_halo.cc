#include "shader_kernels/programs/adaptive/supersample.h"

namespace kernels {
namespace {

using traces::Region;

/// Bytes of a sample that go to neighbours.
constexpr std::uint32_t kExchangedBytes = 2 * sizeof(TraitsRecord<float>) + sizeof(ColourRecord<float>);

}  // namespace

// A tile's store: its last two columns, row by row, so that the last four are the corner; its last two rows; all
// attributes if they do not stay; samples of active sub-pixels if they wait there for each other.
std::uint64_t SupersampleProgram::store_bytes() const {
  const bool is_parked = supersample_.attributes == AttributeStorage::kDram;
  const bool is_spilt = supersample_.packing == Packing::kAtomic;
  return tiles_.stored_samples() * kExchangedBytes + (is_parked ? std::uint64_t{centres()} * kAttributeBytes : 0) +
         (is_spilt ? std::uint64_t{tile_pixels()} * kWhole * sizeof(ColourRecord<float>) : 0);
}

/// As block_halo.cc has it: a tile always makes its halo; where neighbours keep theirs, the machine reads it back.
void SupersampleProgram::make_halo(Tile& tile) const {
  tiles_.for_each_part(tile.at, [&](const HaloPart& part) {
    if (supersample_.halo == Halo::kReload) {
      tile.wave.import_samples(part.border, store_bytes() * part.border.tile + part.first * kExchangedBytes,
                               part.across * part.down * kExchangedBytes);
      tile.wave.mute();
    }
    trace_centres(tile, part.x, part.y, part.across, part.down, false);
    tile.wave.unmute();
  });
}

void SupersampleProgram::export_borders(Tile& tile) const {
  if (supersample_.halo == Halo::kRetrace) return;
  const std::uint64_t store = store_bytes() * tile.at.index;
  tiles_.for_each_export(tile.at, [&](std::uint32_t border, std::uint64_t first, std::uint32_t samples) {
    tile.wave.export_samples(border, store + first * kExchangedBytes, samples * kExchangedBytes);
  });
}

/// Writes all attributes to memory and reads them back, if that is where they are.
void SupersampleProgram::park_attributes(Tile& tile) const {
  if (supersample_.attributes == AttributeStorage::kTile) return;
  const std::uint32_t across = tile.at.width + (tile.at.has_left ? 2 : 0);
  const std::uint32_t bytes = across * (tile.at.height + (tile.at.has_above ? 2 : 0)) * kAttributeBytes;
  const std::uint64_t store = store_bytes() * tile.at.index + tiles_.stored_samples() * kExchangedBytes;
  const Node out = tile.wave.transfer(Region::kSamples, true, store, bytes);
  tile.wave.wait_for_records(out);
  const Node in = tile.wave.transfer(Region::kSamples, false, store, bytes);
  tile.wave.wait_all(in, out);
  tile.wave.adds_records(in);
}

}  // namespace kernels
