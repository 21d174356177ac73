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

/// Common part of multirate and undersample. The picture's samples are cut into blocks; the last sample of a block
/// is the reference sample and always traced. Those between two of a row are checked along x, then all others along y:
///
///   I I I I        references R;  samples I of their rows lie between two of them;  those of other rows between
///   I R x R        references, or x samples, above and below. Similar ones are interpolated, the others traced; so are
///   y y y y        those at the picture's edge that lack a reference.
///   x R x R
///
/// A tile's blocks need the last rows and columns of the tiles above and to the left (its halo). Samples lie row by row
/// in the tile buffer, a row and a column of halo before the tile's own.
class BlockProgram : public FrameProgram {
 public:
  std::uint32_t tiles() const override { return tiles_.count(); }
  TileCounts tile_counts() const override { return {tiles_.across(), tiles_.down()}; }
  FrameRequirements requirements() const override;
  void run_tile(std::uint32_t tile_index, const traces::Tracer& tracer, bool record, TileResult& out) const override;
  void keep(const TileResult& tile) override;

 protected:
  /// A tile being worked on.
  struct Tile {
    SampleTile at;
    std::uint32_t block = 2;
    Wavefront& wave;
    TileResult& out;
    TileBuffer& buffer;
    Wavefront::Node start = Wavefront::kNone;  ///< its first launch waits for this
    std::uint32_t coloured = 0;                ///< samples that CountColoured has counted
  };
  /// A launch of a check kernel.
  struct Verdict {
    Wavefront::Node node = Wavefront::kNone;
    std::uint32_t passed = 0, failed = 0;
    std::uint32_t rough = 0;  ///< samples that have passed, but that a tile's rate does not count
  };
  struct Setup {
    std::uint32_t grid = 1;          ///< samples along a pixel
    std::uint32_t block = 2;         ///< samples along a block
    std::uint32_t whole = 2;         ///< a tile's side is a multiple of it: every block that it may have
    std::uint32_t record_bytes = 0;  ///< that a sample keeps beside its colour
  };

  BlockProgram(const traces::MemoryImage& image, const traces::Camera& camera, const RenderConfig& config,
               const AdaptiveConfig& adaptive, const Setup& setup, std::uint32_t frame);

  /// Side of a tile's blocks in this frame.
  virtual std::uint32_t block_of([[maybe_unused]] std::uint32_t tile) const { return setup_.block; }
  /// True if that is read from memory, and the tile's findings are written there.
  virtual bool carries_rates() const { return false; }
  /// Records that traced samples keep, before their last check or behind it.
  virtual Wavefront::RetainedRecords records_to_retain(bool is_last) const = 0;
  virtual Verdict check(Tile& tile, bool along_y, const LineUniforms<float>& line, std::uint32_t items) const = 0;
  /// Makes the samples that have passed.
  virtual void interpolate(Tile& tile, bool along_y, const LineUniforms<float>& line, const Verdict& verdict) const = 0;
  /// Called when listed samples have been traced and shaded.
  virtual void traced(Tile&, std::vector<std::uint32_t>& /*list*/, std::uint32_t /*items*/, std::uint32_t /*lanes*/,
                      const Wavefront::RetainedRecords&) const {}
  /// Called when samples of a neighbour have been asked for.
  virtual void imported(Tile&, std::uint32_t /*samples*/) const {}
  /// Called when all samples of a tile are there.
  virtual void settled(Tile&) const {}
  /// Encodes a tile's pixels, if they have one sample each and one loop does it.
  virtual Wavefront::Node pack_samples(Tile& tile) const;
  bool packs_samples(const Wavefront& wave) const { return wave.fuses() && setup_.grid == 1 && !wave.dma_encodes(); }

  /// Samples to a row of the tile buffer.
  std::uint32_t pitch() const { return tiles_.side() + 1; }
  const CameraUniforms<float>& camera() const { return camera_; }
  ConeUniforms<float> cone() const { return cone_uniforms(camera_, setup_.grid); }
  /// A tile's samples in the tile buffer, without its halo.
  LatticeUniforms<float> own_samples(const SampleTile& at) const;
  GridUniforms<float> grid_uniforms(float x0, float y0, std::uint32_t pitch) const;
  const std::vector<std::uint32_t>& order() const { return order_; }
  std::uint32_t frame() const { return frame_; }
  const SceneTables& scene() const { return scene_; }
  const SampleTiles& sample_tiles() const { return tiles_; }

 private:
  std::uint64_t store_bytes() const;
  std::uint32_t exchanged_bytes() const;

  void read_rates(Tile& tile) const;

  // block_stages.cc
  void trace_lattice(Tile& tile, std::uint32_t first, std::uint32_t across, std::uint32_t step, std::uint32_t row_step,
                     std::uint32_t items, bool is_own) const;
  void trace_listed(Tile& tile, std::vector<std::uint32_t>& list, Wavefront::Node lister, std::uint32_t items,
                    bool is_last, bool is_own, std::uint32_t lanes) const;
  void resolve(Tile& tile, bool along_y, const LineUniforms<float>& line, std::uint32_t items, bool is_own) const;
  LineUniforms<float> line_along_x(const Tile& tile, std::uint32_t block, bool is_halo) const;
  LineUniforms<float> line_along_y(const Tile& tile) const;
  void mark(Tile& tile, const Verdict& verdict, const LineUniforms<float>& line) const;
  void average(Tile& tile) const;
  void count(Tile& tile) const;

  // block_halo.cc
  void make_halo_left(Tile& tile) const;
  void make_halo_above(Tile& tile) const;
  void trace_row_above(Tile& tile) const;
  void export_right(Tile& tile) const;
  void export_below(Tile& tile) const;
  void park_attributes(Tile& tile, std::uint32_t written, std::uint32_t read) const;

  const RenderConfig config_;
  const AdaptiveConfig adaptive_;
  const Setup setup_;
  const SceneTables scene_;
  const CameraUniforms<float> camera_;
  const SampleTiles tiles_;
  const std::vector<std::uint32_t> order_;
  const std::uint32_t frame_;
};

}  // namespace kernels
