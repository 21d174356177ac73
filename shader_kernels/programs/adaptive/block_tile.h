#pragma once
#include <cstdint>
#include <vector>

#include "shader_kernels/programs/adaptive/adaptive_config.h"
#include "shader_kernels/programs/adaptive/sample_tiles.h"
#include "shader_kernels/programs/wavefront/frame_program.h"
#include "shader_kernels/programs/wavefront/render_config.h"
#include "shader_kernels/programs/wavefront/scene_tables.h"
#include "shader_kernels/programs/wavefront/wavefront.h"

namespace kernels {

/// Properties of a block program that all tiles of a frame share.
struct BlockSetup {
  std::uint32_t grid = 1;            ///< samples along a pixel's side
  std::uint32_t block = 2;           ///< samples along a block's side
  std::uint32_t whole = 2;           ///< a tile's side is a multiple of it, and so is every block side
  std::uint32_t record_bytes = 0;    ///< size of a sample's record, without the colour
  bool carries_rates = false;        ///< block sides are read from memory, and similar ratios are written there
  RetainedRecords before_check_y{};  ///< records of samples that a later check reads
  RetainedRecords after_check_y{};   ///< records of samples that no check reads
  float faint = 0;                   ///< colours with no channel above this pass the colour check (CountColoured)
};

/// Frame of multirate and undersample. The picture's samples are divided into blocks. The last sample of a block is its
/// reference R and is always traced. The others are checked between two samples of their line:
///
///   I I I I        1. x samples of reference rows are between two references of the row.
///   I R x R        2. y samples of other rows are between two samples above and below.
///   y y y y        3. Similar samples are interpolated, all others traced.
///   x R x R        4. Samples at the picture's edge that lack a reference are traced.
///
/// A tile's blocks need the last rows and columns of the tiles above and to the left (its halo). The tile buffer has
/// the samples row by row, with a row and a column of halo before the tile's own.
struct BlockFrame {
  BlockFrame(const traces::MemoryImage& image, const traces::Camera& viewer, const RenderConfig& config,
             const AdaptiveConfig& keys, const BlockSetup& properties, std::uint32_t frame);

  FrameRequirements requirements() const;
  /// Returns the samples per row of the tile buffer.
  std::uint32_t row_pitch() const { return tiles.tile_side() + 1; }
  ConeUniforms<float> ray_cone() const { return cone_uniforms(camera, setup.grid); }
  /// Returns the tile's samples in the tile buffer, without its halo.
  LatticeUniforms<float> own_samples(const SampleTile& at) const;
  GridUniforms<float> grid_uniforms(float x0, float y0, std::uint32_t row_samples) const;
  /// Returns the bytes of a sample that a neighbouring tile reads.
  std::uint32_t exchanged_bytes() const;
  /// Returns the bytes of memory per tile: its last row, its last column, and all records if they are kept in DRAM.
  std::uint64_t store_bytes() const;
  /// Returns the bytes of a tile in the picture.
  std::uint64_t picture_bytes() const { return requirements().region_bytes[0] / tiles.count(); }
  /// Allocates the per-tile counts of a frame.
  void size_counts(Sampling& frame_counts) const;
  /// Adds the similar ratio and block side of a finished tile to the frame's counts.
  void count_tile(const TileResult& tile, std::uint32_t block, Sampling& frame_counts) const;

  const AdaptiveConfig adaptive;
  const BlockSetup setup;
  const SceneTables scene;
  const CameraUniforms<float> camera;
  const SampleTiles tiles;
  const std::vector<std::uint32_t> order;  ///< tiles in rendering order
  const std::uint32_t number;
};

/// The samples that one check examines: those between references along x, or along y.
struct BlockLines {
  LineUniforms<float> uniforms{};
  bool along_y = false;
  std::uint32_t samples = 0;
  bool is_own = true;  ///< false: samples of a neighbouring tile
};

/// Result of a check: its launch, and the number of samples in the queues `passed` and `failed`.
struct Verdict {
  Wavefront::Node node = Wavefront::kNone;
  std::uint32_t passed = 0, failed = 0;
  std::uint32_t rough = 0;  ///< passed samples that count as failed for the tile's rate
};

/// A tile in progress of a block program, with the steps that multirate and undersample share.
class BlockTile {
 public:
  /// `block_of(tile)` returns a tile's block side in this frame, in pixels.
  BlockTile(const BlockFrame& frame, std::uint32_t tile_index, const traces::Tracer& tracer, bool record,
            TileResult& result, auto&& block_of)
      : BlockTile(frame, frame.tiles.sample_tile(frame.order[tile_index]), tracer, record, result) {
    block_ = block_of(at.index);
    if (at.has_left) left_block_ = block_of(at.left);
    if (at.has_above) above_block_ = block_of(at.above);
    if (frame.setup.carries_rates) read_rates();
  }

  /// Traces the reference sample of every block.
  void trace_references();
  /// Returns the samples of reference rows, between two references.
  BlockLines lines_along_x() const { return lines_along_x(block_, true); }
  /// Returns the samples of all other rows, between two rows.
  BlockLines lines_along_y() const;
  /// Traces the samples that failed a check.
  void trace_failed(const BlockLines& lines, const Verdict& verdict);

  /// Exports the references of the last column to the tile on the right.
  void export_right();
  /// Exports the last row to the tile below.
  void export_below();
  /// Loads or retraces the last column of the tile on the left, as `AdaptiveConfig::halo` selects.
  void import_left();
  /// Loads or retraces the last row of the tile above. `resolve(lines)` renders the samples between its references.
  template <class Resolve>
  void import_above(Resolve&& resolve) {
    if (!begin_import_above()) return;
    trace_references_above();
    resolve(lines_along_x(above_block_, false));
    graph.resume_recording();
  }
  /// Writes the records of the references to DRAM and reads them back, if `AdaptiveConfig::attributes` is dram.
  void spill_references_to_dram() { spill_records(block_rows() * block_columns(), block_rows() * block_columns()); }
  /// Does the same for the x samples, and reads all reference rows back.
  void spill_reference_rows_to_dram() {
    spill_records(block_rows() * (at.width - block_columns()), block_rows() * at.width);
  }

  /// True if one kernel clamps, encodes and packs pixels; they have a single sample each.
  bool packs_samples() const { return frame_.scene.fuses && frame_.setup.grid == 1 && !frame_.scene.dma_encodes; }
  /// Averages the samples of each pixel and writes the picture.
  void average_pixels();
  /// Writes the pixels that `packed` encoded.
  void write_packed(Wavefront::Node packed);
  /// Ends the tile's work and counts its samples.
  void finish();

  const SampleTile at;
  TileResult& out;
  TileBuffer& buffer;
  Wavefront wave;
  TileGraph& graph;
  std::uint32_t coloured = 0;  ///< samples whose global light the colour check may reject (CountColoured)

 private:
  BlockTile(const BlockFrame& frame, const SampleTile& tile, const traces::Tracer& tracer, bool record,
            TileResult& result);
  std::uint32_t block_rows() const { return at.height / block_; }
  std::uint32_t block_columns() const { return at.width / block_; }
  void read_rates();
  BlockLines lines_along_x(std::uint32_t block, bool is_own) const;
  /// Traces `items` samples, `across` per row, beginning at sample `first`.
  void trace_lattice(std::uint32_t first, std::uint32_t across, std::uint32_t step, std::uint32_t row_step,
                     std::uint32_t items, bool is_own);
  void trace_listed(SampleQueue& list, Wavefront::Node lister, std::uint32_t items, const RetainedRecords& kept,
                    bool is_own, std::uint32_t lanes);
  void record_global_light(SampleQueue& list, std::uint32_t items, std::uint32_t lanes, float faint);
  void import_samples(std::uint32_t tile, std::uint32_t border, std::uint64_t offset, std::uint32_t samples);
  bool begin_import_above();
  void trace_references_above();
  void spill_records(std::uint32_t written, std::uint32_t read);
  void mark_samples(const BlockLines& lines, const Verdict& verdict);

  const BlockFrame& frame_;
  std::uint32_t block_ = 2, left_block_ = 2, above_block_ = 2;
  Wavefront::Node start_ = Wavefront::kNone;  ///< node that the tile's first launch waits for
};

}  // namespace kernels
