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
  const std::uint64_t side = tiles_.side();
  const bool is_parked = supersample_.attributes == AttributeStorage::kDram;
  const bool is_spilt = supersample_.packing == Packing::kAtomic;
  return 4 * side * kExchangedBytes + (is_parked ? std::uint64_t{centres()} * kAttributeBytes : 0) +
         (is_spilt ? std::uint64_t{tile_pixels()} * kWhole * sizeof(ColourRecord<float>) : 0);
}

/// As block_halo.cc has it: a tile always makes its halo; where neighbours keep theirs, the machine reads it back.
void SupersampleProgram::make_halo(Tile& tile) const {
  const SampleTile& at = tile.at;
  const std::uint64_t rows = 2 * std::uint64_t{tiles_.side()} * kExchangedBytes;  // behind a store's columns
  const bool reloads = supersample_.halo == Halo::kReload;
  const auto make = [&](traces::Border border, std::uint64_t offset, std::uint32_t x, std::uint32_t y,
                        std::uint32_t across, std::uint32_t down) {
    if (reloads) {
      tile.wave.import_samples(border, store_bytes() * border.tile + offset, across * down * kExchangedBytes);
      tile.wave.mute();
    }
    trace_centres(tile, x, y, across, down, false);
    tile.wave.unmute();
  };
  if (at.has_left) make({at.left, kRightBorder}, 0, 0, 2, 2, at.height);
  if (at.has_above) make({at.above, kLowerBorder}, rows, 2, 0, at.width, 2);
  if (at.has_left && at.has_above) {
    make({at.above_left, kRightBorder}, 2 * (std::uint64_t{tiles_.side()} - 2) * kExchangedBytes, 0, 0, 2, 2);
  }
}

void SupersampleProgram::export_borders(Tile& tile) const {
  if (supersample_.halo == Halo::kRetrace) return;
  const std::uint64_t store = store_bytes() * tile.at.index;
  if (tile.at.has_right) tile.wave.export_samples(kRightBorder, store, 2 * tile.at.height * kExchangedBytes);
  if (tile.at.has_below) {
    tile.wave.export_samples(kLowerBorder, store + 2 * std::uint64_t{tiles_.side()} * kExchangedBytes,
                             2 * tile.at.width * kExchangedBytes);
  }
}

/// Writes all attributes to memory and reads them back, if that is where they are.
void SupersampleProgram::park_attributes(Tile& tile) const {
  if (supersample_.attributes == AttributeStorage::kTile) return;
  const std::uint32_t across = tile.at.width + (tile.at.has_left ? 2 : 0);
  const std::uint32_t bytes = across * (tile.at.height + (tile.at.has_above ? 2 : 0)) * kAttributeBytes;
  const std::uint64_t store = store_bytes() * tile.at.index + 4 * std::uint64_t{tiles_.side()} * kExchangedBytes;
  const Node out = tile.wave.transfer(Region::kSamples, true, store, bytes);
  tile.wave.wait_for_records(out);
  const Node in = tile.wave.transfer(Region::kSamples, false, store, bytes);
  tile.wave.wait_all(in, out);
  tile.wave.adds_records(in);
}

}  // namespace kernels
