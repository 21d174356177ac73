#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "shader_kernels/programs/adaptive/block_program.h"
#include "shader_kernels/programs/adaptive/post_correction.h"
#include "shader_kernels/programs/adaptive/undersample_config.h"

namespace kernels {

/// Frame program undersample (Kim et al. 2016): samples between similar ones take the attributes in their middle and
/// are shaded from those. Scans over the whole frame then look for what fell between samples.
///
///   per tile: references -> check_attributes_x -> interpolate_attributes, shade | trace -> check_attributes_y -> ...
///             -> average_samples -> pack_colour -> transfer to the frame buffer
///   per scan and tile: identities from memory -> find_suspects -> trace -> find_suspects -> ... -> corrected pixels
class UndersampleProgram final : public BlockProgram {
 public:
  /// `scene_size`: the longest side of the scene's bounds, the same in all frames.
  UndersampleProgram(const traces::MemoryImage& image, const traces::Camera& camera, const RenderConfig& config,
                     const UndersampleConfig& undersample, float scene_size, std::uint32_t frame);

  std::uint32_t tiles() const override;
  std::uint32_t pass_end(std::uint32_t tile_index) const override;
  FrameRequirements requirements() const override;
  void begin_pass(std::uint32_t tile_index, const traces::Tracer& tracer) override;
  void run_tile(std::uint32_t tile_index, const traces::Tracer& tracer, bool record, TileResult& out) const override;
  void keep(const TileResult& tile) override;

 private:
  Wavefront::RetainedRecords records_to_retain(bool is_last) const override;
  Verdict check(Tile& tile, bool along_y, const LineUniforms<float>& line, std::uint32_t items) const override;
  void interpolate(Tile& tile, bool along_y, const LineUniforms<float>& line, const Verdict& verdict) const override;
  void traced(Tile& tile, std::vector<std::uint32_t>& list, std::uint32_t items, std::uint32_t lanes,
              const Wavefront::RetainedRecords& retained) const override;
  void imported(Tile& tile, std::uint32_t samples) const override;
  void settled(Tile& tile) const override;
  Wavefront::Node pack_samples(Tile& tile) const override;

  template <bool kAlongY>
  Verdict check_along(Tile& tile, const LineUniforms<float>& line, std::uint32_t items) const;
  template <class K>
  Verdict check_with(Tile& tile, const LineUniforms<float>& line, std::uint32_t items) const;
  template <bool kAlongY>
  void interpolate_with(Tile& tile, const LineUniforms<float>& line, const Verdict& verdict) const;
  template <class K>
  Wavefront::Node store_identities(Tile& tile) const;
  std::uint32_t scan_of(std::uint32_t tile_index) const { return tile_index / sample_tiles().count() - 1; }
  // undersample_scans.cc
  std::uint32_t scanned_bytes() const;
  std::uint64_t scan_store(std::uint32_t tile) const;
  void run_scan(std::uint32_t tile_index, const traces::Tracer& tracer, bool record, TileResult& out) const;
  template <class Sample>
  void list_suspects(std::span<const PostCorrection::Suspect> suspects, TileResult& out, Sample&& sample) const;
  void trace_suspects(Wavefront& wave, TileResult& out, const GridUniforms<float>& grid, std::uint32_t items,
                      Wavefront::Node lister) const;
  void average_again(std::uint32_t x, std::uint32_t y);
  Wavefront::Node note_search(Wavefront& wave, std::uint32_t items) const;
  void correct(Wavefront& wave, TileResult& out, const SampleTile& at, Wavefront::Node found) const;
  void put_corrected(Wavefront& wave, const SampleTile& at, std::uint32_t corrected, std::uint32_t corrected_pixels,
                     Wavefront::Node last) const;

  const UndersampleConfig undersample_;
  const float apart_;  ///< hits are near each other up to this distance
  const float faint_;  ///< two colours pass their check if no channel of them is above this
  PostCorrection correction_;
};

}  // namespace kernels
