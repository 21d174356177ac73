#pragma once
#include <algorithm>
#include <cstdint>
#include <vector>

#include "shader_kernels/kernels/subpixels.h"
#include "shader_kernels/kernels/uniforms.h"
#include "shader_kernels/programs/adaptive/adaptive_config.h"
#include "shader_kernels/programs/wavefront/frame_program.h"
#include "shader_kernels/programs/wavefront/render_config.h"
#include "shader_kernels/programs/wavefront/scene_tables.h"
#include "shader_kernels/programs/wavefront/tile_result.h"
#include "shader_kernels/programs/wavefront/wavefront.h"
#include "traces/stream.h"

namespace kernels {

/// Numbers of the two borders that a tile exports: its last columns, and its last rows.
inline constexpr std::uint32_t kRightBorder = 0, kLowerBorder = 1;

/// Returns the bytes that a transfer of `records` scattered records moves: one memory line per record, but at most
/// `all` bytes.
std::uint32_t scattered_bytes(std::uint64_t records, std::uint64_t all);

/// A tile of the picture, in samples.
struct SampleTile {
  std::uint32_t index = 0;     ///< number of the tile, in row order
  std::uint32_t x = 0, y = 0;  ///< position in the picture of the tile's first sample
  std::uint32_t width = 0, height = 0;
  std::uint32_t left = 0, above = 0, above_left = 0;  ///< indices of the neighbouring tiles, if they exist
  bool has_left = false, has_above = false;
  bool has_right = false, has_below = false;
};

/// Divides the samples of the picture into square tiles of whole pixels and whole blocks.
class SampleTiles {
 public:
  /// `side` is the desired side of a tile in samples, `samples_per_side` the number of samples along a pixel's side.
  /// Tile sides are multiples of `block`.
  SampleTiles(std::uint32_t width, std::uint32_t height, std::uint32_t samples_per_side, std::uint32_t side,
              std::uint32_t block);

  std::uint32_t tile_count() const { return across_ * down_; }
  std::uint32_t tiles_across() const { return across_; }
  std::uint32_t tiles_down() const { return down_; }
  std::uint32_t tile_side() const { return side_; }
  std::uint32_t pixel_grid_side() const { return grid_; }
  SampleTile sample_tile(std::uint32_t index) const;
  /// Returns the tile indices in rendering order. The order is by diagonals, so that the left and upper neighbours of a
  /// tile are rendered long before it, or row by row if halos are retraced.
  std::vector<std::uint32_t> rendering_order(Halo halo) const;

 private:
  std::uint32_t width_, height_;  ///< size of the picture in samples
  std::uint32_t grid_, side_, across_, down_;
};

/// A rectangle of a tile's halo in the tile buffer, and the place in memory where a neighbouring tile has stored these
/// samples.
struct HaloPart {
  traces::Border border;
  std::uint64_t first = 0;     ///< index of the rectangle's first sample among those that the other tile stores
  std::uint32_t x = 0, y = 0;  ///< position in the tile buffer of the rectangle's first sample
  std::uint32_t across = 0, down = 0;
  /// Returns the part of the halo's rectangle that is nearest to the tile: its last `columns` columns and last `rows`
  /// rows.
  HaloPart part_nearest_tile(std::uint32_t columns, std::uint32_t rows) const;
};

/// Tiles for programs whose pixels read neighbours up to `reach` pixels away in all directions. A tile imports samples
/// only from the left and above.
///
/// So the pixels that a tile finishes are offset from its samples by `reach` to the left and up. The tile needs 2 *
/// `reach` columns and rows of its neighbours (its halo). With a reach of 1:
///
///   h h|h h h h    h  halo: samples of the tiles left, above, and above to the left
///   h F|F F F .    F  pixels finished here
///   ---+-------    .  the neighbours to the right and below finish these; at the picture's edge, this tile
///   h F|F F F .
///   h .|. . . .
///
/// A tile stores in memory its last 2 * `reach` columns, row by row (the corner comes last), then its last 2 * `reach`
/// rows.
class FinishedTiles {
 public:
  /// `side` is the desired side of a tile in pixels. Tiles that are not last in a row or column are at least as wide as
  /// a halo.
  FinishedTiles(std::uint32_t width, std::uint32_t height, std::uint32_t side, std::uint32_t reach)
      : tiles_(width, height, 1, side, std::max(1U, 2 * reach)), reach_(reach) {}

  const SampleTiles& sample_tiles() const { return tiles_; }
  std::uint32_t tile_count() const { return tiles_.tile_count(); }
  std::uint32_t tile_side() const { return tiles_.tile_side(); }
  std::uint32_t halo_width() const { return 2 * reach_; }
  /// Returns the number of samples in a row of the tile buffer: those of the halo at its left, followed by the tile's
  /// own.
  std::uint32_t row_pitch() const { return tile_side() + halo_width(); }
  std::uint32_t buffer_sample_count() const { return row_pitch() * row_pitch(); }
  /// Returns the longest side, in pixels, of the rectangle whose final colours one tile computes.
  std::uint32_t most_side() const { return tile_side() + reach_; }
  std::uint32_t most_pixels() const { return most_side() * most_side(); }
  /// Sets in `out` the rectangle of the picture whose final colours a tile computes.
  void set_finished_rect(const SampleTile& at, TileResult& out) const;
  /// Returns for which pixels a tile computes the final colours, and where their samples are in the tile buffer.
  FinishedUniforms<float> finished_uniforms(const SampleTile& at, const TileResult& out) const;
  /// Returns the indices of the samples in a rectangle of the tile buffer that begins at (x, y).
  LatticeUniforms<float> rect_sample_lattice(std::uint32_t x, std::uint32_t y, std::uint32_t across) const;

  /// Returns the number of samples that a tile stores in memory for its neighbours.
  std::uint64_t stored_samples() const { return 2 * std::uint64_t{halo_width()} * tile_side(); }
  /// Calls f(part) for each rectangle (HaloPart) of a tile's halo.
  void for_each_halo_part(const SampleTile& at, auto&& f) const {
    const std::uint32_t h = halo_width();
    if (h == 0) return;
    if (at.has_left) f(HaloPart{{at.left, kRightBorder}, 0, 0, h, h, at.height});
    if (at.has_above) f(HaloPart{{at.above, kLowerBorder}, std::uint64_t{h} * tile_side(), h, 0, at.width, h});
    if (at.has_left && at.has_above) {
      f(HaloPart{{at.above_left, kRightBorder}, std::uint64_t{h} * (tile_side() - h), 0, 0, h, h});
    }
  }
  /// Calls f(border, first, samples) for each border that other tiles read; `first` is the index of its first sample in
  /// the memory region to which the tile writes its samples.
  void for_each_export_border(const SampleTile& at, auto&& f) const {
    if (halo_width() == 0) return;
    if (at.has_right) f(kRightBorder, std::uint64_t{0}, halo_width() * at.height);
    if (at.has_below) f(kLowerBorder, std::uint64_t{halo_width()} * tile_side(), halo_width() * at.width);
  }

 private:
  const SampleTiles tiles_;
  const std::uint32_t reach_;
};

/// Properties of the program multirate or undersample that all tiles of a frame share.
struct BlockSetup {
  std::uint32_t grid = 1;          ///< number of samples along the side of a pixel
  std::uint32_t block = 2;         ///< number of samples along the side of a block
  std::uint32_t whole = 2;         ///< common multiple of all block sides, in samples; tile sides are multiples of it
  std::uint32_t record_bytes = 0;  ///< bytes of a sample's record in the tile buffer, without the colour
  bool carries_rates = false;  ///< tiles read block sides from memory and write the fraction of similar samples there
  RetainedRecords before_check_y{};  ///< records kept of samples that a check along y will read
  RetainedRecords after_check_y{};   ///< records kept of samples that no later check reads
  float faint = 0;                   ///< colours pass every colour check if no channel is above this (CountColoured)
};

/// A frame of the program multirate or undersample. The picture's samples are divided into blocks. The last sample of
/// each block is a reference R, which is always traced. The others are checked between two samples of their line:
///
///   I I I I        1. x samples of reference rows are between two references of the row.
///   I R x R        2. y samples of other rows are between two samples above and below.
///   y y y y        3. Similar samples are interpolated, all others traced.
///   x R x R        4. Samples at the picture's edge that lack a reference are traced.
///
/// The blocks of a tile also need the last rows and columns of the tiles above and to the left (the halo). The tile
/// buffer has the samples row by row, with a row and a column of halo before the tile's own.
struct BlockFrame {
  BlockFrame(const traces::MemoryImage& image, const traces::Camera& viewer, const RenderConfig& config,
             const AdaptiveConfig& keys, const BlockSetup& properties, std::uint32_t frame);

  FrameRequirements requirements() const;
  /// Returns the number of samples in a row of the tile buffer.
  std::uint32_t row_pitch() const { return tiles.tile_side() + 1; }
  ConeUniforms<float> ray_cone() const { return cone_uniforms(camera, setup.grid); }
  /// Returns which samples of the tile buffer belong to the tile, without its halo.
  LatticeUniforms<float> own_sample_lattice(const SampleTile& at) const;
  GridUniforms<float> grid_uniforms(float x0, float y0, std::uint32_t row_samples) const;
  /// Returns how many bytes of each border sample a neighbouring tile reads.
  std::uint32_t exchanged_bytes_per_sample() const;
  /// Returns the bytes that a tile stores in memory: last row, last column, and all records if they are kept in DRAM.
  std::uint64_t stored_bytes_per_tile() const;
  /// Returns the bytes of a tile's pixels in the frame buffer.
  std::uint64_t picture_bytes() const { return requirements().region_bytes[0] / tiles.tile_count(); }
  /// Allocates the counts that `frame_counts` keeps for each tile.
  void allocate_counts(Sampling& frame_counts) const;
  /// Adds a finished tile's fraction of similar samples, and the side of its blocks, to the frame's counts.
  void count_tile(const TileResult& tile, std::uint32_t block, Sampling& frame_counts) const;

  const AdaptiveConfig adaptive;
  const BlockSetup setup;
  const SceneTables scene;
  const CameraUniforms<float> camera;
  const SampleTiles tiles;
  const std::vector<std::uint32_t> order;  ///< tile indices in rendering order
  const std::uint32_t number;
};

/// The samples that one similarity check examines: samples between references along x, or along y.
struct BlockLines {
  LineUniforms<float> uniforms{};
  bool along_y = false;
  std::uint32_t samples = 0;
  bool is_own = true;  ///< the samples belong to the tile itself, not to a neighbour
};

/// Result of launching a check: the launch, and how many samples it appended to the queues `passed` and `failed`.
struct Verdict {
  Wavefront::Node node = Wavefront::kNone;
  std::uint32_t passed = 0, failed = 0;
  std::uint32_t rough = 0;  ///< samples that passed but count as failed when the tile's rate is chosen
};

/// Renders one tile with the program multirate or undersample, by the steps that both programs share.
class BlockTile {
 public:
  /// `block_of(tile)` returns the side, in samples, of the blocks of tile `tile` in this frame.
  BlockTile(const BlockFrame& frame, std::uint32_t tile_index, const traces::Tracer& tracer, bool record,
            TileResult& result, auto&& block_of)
      : BlockTile(frame, frame.tiles.sample_tile(frame.order[tile_index]), tracer, record, result) {
    block_ = block_of(at.index);
    if (at.has_left) left_block_ = block_of(at.left);
    if (at.has_above) above_block_ = block_of(at.above);
    if (frame.setup.carries_rates) read_block_sides();
  }

  /// Traces the reference sample of every block.
  void trace_references();
  /// Returns the samples between references in the rows that contain references. They are checked along x.
  BlockLines lines_along_x() const { return lines_along_x(block_, true); }
  /// Returns the samples of the rows without references. They are checked along y, against samples above and below.
  BlockLines lines_along_y() const;
  /// Traces the samples that failed a similarity check.
  void trace_failed_samples(const BlockLines& lines, const Verdict& verdict);

  /// Writes the reference samples of the last column to memory, for the tile on the right.
  void export_right_border();
  /// Writes the last row of samples to memory, for the tile below.
  void export_lower_border();
  /// Loads or traces the last column of samples of the tile on the left, as AdaptiveConfig::halo selects.
  void import_left_halo();
  /// Loads or traces the last row of the tile above, as AdaptiveConfig::halo selects. `resolve(lines)` renders the
  /// samples between the references of that row.
  template <class Resolve>
  void import_upper_halo(Resolve&& resolve) {
    if (!begin_upper_halo_import()) return;
    trace_references_above();
    resolve(lines_along_x(above_block_, false));
    graph.resume_recording();
  }
  /// Writes the records of the tile's reference samples to DRAM and reads them back, if AdaptiveConfig::attributes is
  /// dram.
  void spill_references_to_dram() {
    add_spill_transfers(block_rows() * block_columns(), block_rows() * block_columns());
  }
  /// Adds two transfers if AdaptiveConfig::attributes is dram. The first writes to DRAM the records of the samples
  /// between references; the second reads back all records of the rows with references.
  void spill_reference_rows_to_dram() {
    add_spill_transfers(block_rows() * (at.width - block_columns()), block_rows() * at.width);
  }

  /// True if one kernel can clamp, encode and pack a pixel, because it has a single sample.
  bool can_pack_samples() const { return frame_.scene.fuses && frame_.setup.grid == 1 && !frame_.scene.dma_encodes; }
  /// Averages the samples of each pixel and writes the pixels to the frame buffer.
  void average_pixels();
  /// Writes the pixels that launch `packed` has encoded to the frame buffer.
  void write_packed_pixels(Wavefront::Node packed);
  /// Completes the tile's graph of work and counts the tile's samples.
  void finish();

  const SampleTile at;
  TileResult& out;
  TileBuffer& buffer;
  Wavefront wave;
  TileGraph& graph;
  std::uint32_t coloured = 0;  ///< number of samples whose global colour may fail the colour check (CountColoured)

 private:
  BlockTile(const BlockFrame& frame, const SampleTile& tile, const traces::Tracer& tracer, bool record,
            TileResult& result);
  std::uint32_t block_rows() const { return at.height / block_; }
  std::uint32_t block_columns() const { return at.width / block_; }
  void read_block_sides();
  BlockLines lines_along_x(std::uint32_t block, bool is_own) const;
  /// Traces `items` samples of a regular lattice with `across` samples per row, beginning at sample `first`.
  void trace_lattice(std::uint32_t first, std::uint32_t across, std::uint32_t step, std::uint32_t row_step,
                     std::uint32_t items, bool is_own);
  void trace_listed_samples(SampleQueue& list, Wavefront::Node lister, std::uint32_t items, const RetainedRecords& kept,
                            bool is_own, std::uint32_t lanes);
  void record_global_light(SampleQueue& list, std::uint32_t items, std::uint32_t lanes, float faint);
  void import_samples(std::uint32_t tile, std::uint32_t border, std::uint64_t offset, std::uint32_t samples);
  bool begin_upper_halo_import();
  void trace_references_above();
  void add_spill_transfers(std::uint32_t records_written, std::uint32_t records_read);
  void mark_samples(const BlockLines& lines, const Verdict& verdict);

  const BlockFrame& frame_;
  std::uint32_t block_ = 2, left_block_ = 2, above_block_ = 2;
  Wavefront::Node start_ = Wavefront::kNone;  ///< node that the first launch of the tile waits for
};

}  // namespace kernels
