#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "shader_kernels/kernels/denoise.h"
#include "shader_kernels/programs/adaptive/block_tile.h"
#include "shader_kernels/programs/denoise/denoise_config.h"
#include "shader_kernels/programs/denoise/history.h"
#include "shader_kernels/programs/wavefront/frame_program.h"
#include "shader_kernels/programs/wavefront/guides.h"
#include "shader_kernels/programs/wavefront/pixel_sink.h"
#include "shader_kernels/programs/wavefront/render_config.h"
#include "shader_kernels/programs/wavefront/scene_tables.h"

namespace kernels {

/// The program whose picture is denoised.
struct NoisyProgram {
  FinishedTiles tiles;
  bool clamps_samples = true;  ///< a pixel is the mean of samples clamped to [0, 1]
  std::function<std::unique_ptr<FrameProgram>(const PixelSink& sink)> make;  ///< its tiles go to the sink
};

/// Wraps a frame program of tiles of whole pixels and filters its noise (Schied et al. 2017). Each pass covers the
/// pixels that the program's tiles finish once:
///
///   program      tiles -> split_light -> block of the tile: light without albedo, guide, motion, albedo
///   accumulate   block, history of the previous frame (through the data cache) -> light, history of this frame
///   filter x N   light and guides of tile and halo -> light; the first iteration's light becomes the history's
///   modulate     light, albedo -> pixels of the frame buffer
///
/// 1. All data between passes are at the beginning of region kSamples. Their contents are `memory_`: the host copies
/// what transfers move. The program's own data follow.
/// 2. Filters with taps up to kMostHalo pixels away read tile and halo by DMA, row by row. Wider ones read all taps
/// through the data cache.
/// 3. Light that only modulate_albedo reads is stored tile by tile, all other arrays row by row.
///
/// Not modelled: clearing the history before the first frame.
class DenoisedProgram final : public FrameProgram, private PixelSink {
 public:
  /// `history`: the previous frame's; null in the first frame.
  DenoisedProgram(const traces::MemoryImage& image, const traces::Camera& camera, const RenderConfig& render,
                  const DenoiseConfig& denoise, const DenoiseHistory* history, std::uint32_t frame,
                  const NoisyProgram& noisy);

  std::uint32_t tiles() const override { return tile_count_ * pass_count(); }
  TileGridSize tile_grid_size() const override { return program_->tile_grid_size(); }
  std::uint32_t pass_end(std::uint32_t tile_index) const override {
    return (tile_index / tile_count_ + 1) * tile_count_;
  }
  FrameRequirements requirements() const override;
  void run_tile(std::uint32_t tile_index, const traces::Tracer& tracer, bool record, TileResult& out) const override;
  void commit_tile(const TileResult& tile) override;
  std::shared_ptr<const DenoiseHistory> make_history() const override;

  /// Taps of a filter at most this many pixels away are read with the tile's halo.
  static constexpr std::uint32_t kMostHalo = 8;

 private:
  using Node = TileGraph::Node;
  /// A rectangle of the picture, in pixels.
  struct Rect {
    std::uint32_t x, y, width, height;
    std::uint32_t pixel_count() const { return width * height; }
  };
  struct Tile {
    std::uint32_t index;
    Rect at;
    TileGraph& graph;
    TileResult& out;
  };

  // Pass of the program (PixelSink).
  void begin_rays(TileGraph& graph, Node generated, std::uint32_t rays, std::uint32_t samples, TileResult& out,
                  RetainedRecords& retained) const override;
  void write_tile(TileGraph& graph, std::uint32_t samples, std::uint32_t per_pixel, TileResult& out) const override;
  void write_grid(TileGraph& graph, const LatticeUniforms<float>& lattice, TileResult& out) const override;
  std::uint64_t memory_end() const override { return layout_.end; }
  template <bool kHalf>
  void split_tile(TileGraph& graph, std::uint32_t samples, std::uint32_t per_pixel, TileResult& out) const;
  template <bool kHalf>
  void split_grid(TileGraph& graph, const LatticeUniforms<float>& lattice, TileResult& out) const;
  /// Writes the tile's light, guides, motion and albedo to its block in memory, after the launch `light_split`.
  template <bool kHalf>
  void write_block(TileGraph& graph, Node light_split, std::uint32_t pixels, TileResult& out) const;

  // Later passes.
  bool is_half() const { return denoise_.history == HistoryPrecision::kHalf; }
  std::uint32_t pass_count() const { return 3 + denoise_.iterations; }
  template <bool kHalf>
  void run_filter_tile(std::uint32_t pass, Tile& tile) const;
  template <bool kHalf>
  void accumulate(Tile& tile) const;
  template <bool kHalf, TapSource kSource>
  void filter_from_tile(Tile& tile, std::uint32_t iteration) const;
  template <bool kHalf>
  void filter_from_memory(Tile& tile, std::uint32_t iteration) const;
  template <bool kHalf>
  void modulate(Tile& tile) const;

  // Memory. The nodes that these functions add count as writers of records, or wait for them.
  std::uint64_t light_after(std::uint32_t iteration) const;
  bool is_stored_by_tile(std::uint32_t iteration) const { return iteration > 1 && iteration == denoise_.iterations; }
  std::uint64_t block_address(std::uint32_t tile) const;
  std::uint64_t tile_light_address(std::uint32_t tile) const;
  void read(TileGraph& graph, std::uint64_t address, void* to, std::uint32_t bytes) const;
  void write(TileGraph& graph, std::uint64_t address, const void* from, std::uint32_t bytes, Node after) const;
  void read_rows(Tile& tile, std::uint64_t array, std::uint32_t record_bytes, const Rect& rect, void* to) const;
  void write_rows(Tile& tile, std::uint64_t array, std::uint32_t record_bytes, const void* from, Node after) const;
  void write_light(Tile& tile, std::uint32_t iteration, const void* from, Node after) const;
  Rect with_halo(const Rect& tile, std::uint32_t reach) const;
  EdgeUniforms<float> edge_uniforms(std::uint32_t step) const;
  FinishedUniforms<float> finished_uniforms(const Rect& tile, const Rect& stored) const;

  const traces::MemoryImage& image_;
  const RenderConfig render_;
  const DenoiseConfig denoise_;
  const SceneTables scene_;
  const float most_;  ///< largest channel of a sample that counts
  const std::uint32_t frame_;
  const FinishedTiles tiles_;
  const std::uint32_t tile_count_;
  const DenoiseRecordBytes bytes_;
  const ProjectionUniforms<float> projection_;
  const bool has_moved_;
  const std::uint32_t parity_;
  const DenoiseLayout layout_;
  /// Contents of region kSamples. Tiles of a pass write disjoint parts, and read what earlier passes wrote.
  const std::shared_ptr<std::vector<std::uint32_t>> memory_;
  const GuideUniforms guides_;
  const std::unique_ptr<FrameProgram> program_;
};

}  // namespace kernels
