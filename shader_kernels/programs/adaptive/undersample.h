#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "shader_kernels/programs/adaptive/adaptive_config.h"
#include "shader_kernels/programs/adaptive/block_tile.h"
#include "shader_kernels/programs/adaptive/post_correction.h"

namespace kernels {

/// Frame program undersample (Kim et al. 2016): samples between similar references get interpolated attributes and are
/// shaded from those. Scans over the whole frame then correct samples whose interpolation missed something.
///
///   per tile: references -> check_attributes_x -> interpolate_attributes, shade | trace -> check_attributes_y -> ...
///             -> average_samples -> pack_colour -> transfer to the frame buffer
///   per scan and tile: identities from memory -> find_suspects -> trace -> find_suspects -> ... -> corrected pixels
class UndersampleProgram final : public FrameProgram {
 public:
  /// `scene_size`: longest side of the scene's bounds, the same in all frames.
  UndersampleProgram(const traces::MemoryImage& image, const traces::Camera& camera, const RenderConfig& config,
                     const UndersampleConfig& undersample, float scene_size, std::uint32_t frame);

  std::uint32_t tiles() const override;
  TileCounts tile_counts() const override { return {blocks_.tiles.across(), blocks_.tiles.down()}; }
  std::uint32_t pass_end(std::uint32_t tile_index) const override;
  FrameRequirements requirements() const override;
  void begin_pass(std::uint32_t tile_index, const traces::Tracer& tracer) override;
  void run_tile(std::uint32_t tile_index, const traces::Tracer& tracer, bool record, TileResult& out) const override;
  void commit_tile(const TileResult& tile) override;

 private:
  Verdict check(BlockTile& tile, const BlockLines& lines) const;
  template <class K>
  Verdict check_with(BlockTile& tile, const BlockLines& lines) const;
  void average(BlockTile& tile) const;
  template <class K>
  Wavefront::Node store_identities(BlockTile& tile) const;
  std::uint32_t scan_of(std::uint32_t tile_index) const { return tile_index / blocks_.tiles.count() - 1; }
  // Scans of post-correction.
  std::uint32_t scanned_bytes() const;
  std::uint64_t scan_store(std::uint32_t tile) const;
  void run_scan(std::uint32_t tile_index, const traces::Tracer& tracer, bool record, TileResult& out) const;
  template <class Sample>
  void list_suspects(std::span<const PostCorrection::Suspect> suspects, TileResult& out, Sample&& sample) const;
  void trace_suspects(Wavefront& wave, TileResult& out, const GridUniforms<float>& grid, std::uint32_t items,
                      Wavefront::Node lister) const;
  void average_again(std::uint32_t x, std::uint32_t y);
  Wavefront::Node note_search(TileGraph& graph, std::uint32_t items) const;
  void correct(Wavefront& wave, TileResult& out, const SampleTile& at, Wavefront::Node found) const;
  void put_corrected(TileGraph& graph, const SampleTile& at, std::uint32_t corrected, std::uint32_t corrected_pixels,
                     Wavefront::Node last) const;

  const UndersampleConfig undersample_;
  const BlockFrame blocks_;
  const float apart_;  ///< largest distance between hits that count as close
  PostCorrection correction_;
};

}  // namespace kernels
