#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "shader_kernels/programs/adaptive/adaptive_config.h"
#include "shader_kernels/programs/adaptive/block_tile.h"
#include "shader_kernels/programs/wavefront/sampling.h"
#include "shader_kernels/programs/wavefront/tile_result.h"

namespace kernels {

/// Post-correction of an undersampled frame (Kim et al. 2016, section 4): traces interpolated samples that differ from
/// a traced neighbour. It keeps identity words of all samples for the comparison.
///
/// 1. A scan visits all lines of the picture at once, sample by sample.
/// 2. An interpolated sample is suspect if its predecessor was traced and has another identity.
/// 3. Suspects are traced, so that a suspect may make the next sample suspect.
class PostCorrection {
 public:
  /// Axis and direction of a scan over the picture.
  struct Scan {
    bool is_along_y = false, is_backward = false;
  };
  /// An interpolated sample that a scan of post-correction has found suspect and traces next.
  struct Suspect {
    std::uint32_t tile = 0;
    std::uint32_t round = 0;  ///< 1 plus the length of the chain of suspects that made this sample suspect
    std::uint32_t x = 0, y = 0;
  };
  /// Results of tracing suspect samples (Suspect), in the order of the suspects.
  struct SuspectResults {
    std::vector<std::uint32_t> identities;
    std::vector<glm::vec3> colours;  ///< colours of the traced samples, clamped to [0, 1]
  };

  PostCorrection(const UndersampleConfig& config, std::uint32_t width, std::uint32_t height, std::uint32_t tile_side);

  std::uint32_t scan_count() const;
  /// Returns the direction of scan `number`. The order is that of the paper: right, left, down, up; with only two
  /// scans: right, down.
  Scan scan_direction(std::uint32_t number) const {
    return {2 * number >= scan_count(), scan_count() == 4 && number % 2 == 1};
  }

  /// Stores identity words and colours of a tile's samples, which the scans compare.
  void store_samples(const TileResult& tile, const SampleTile& at);
  /// Runs a scan of post-correction over the picture. `trace(suspects)` traces suspect samples and returns their
  /// results. Returns all suspect samples of the scan, ordered by tile, then by round.
  template <class Trace>
  const std::vector<Suspect>& run_scan(const Scan& scan, Trace&& trace) {
    begin_scan();
    for (std::uint32_t step = 1; step < (scan.is_along_y ? height_ : width_); ++step) {
      find_suspects(scan, step);
      if (!fresh_.empty()) apply_results(trace(std::span<const Suspect>(fresh_)));
    }
    end_scan();
    return all_;
  }
  /// Returns the samples of a tile that the last scan of post-correction found suspect and traced.
  std::span<const Suspect> suspects_of(std::uint32_t tile) const;

  glm::vec3 sample_colour(std::uint32_t x, std::uint32_t y) const { return colours_[std::size_t{y} * width_ + x]; }

 private:
  std::uint32_t sample_index(std::uint32_t x, std::uint32_t y) const { return (y + 1) * (width_ + 2) + x + 1; }
  void begin_scan();
  void find_suspects(const Scan& scan, std::uint32_t step);
  void apply_results(const SuspectResults& found);
  void end_scan();

  const UndersampleConfig config_;
  const std::uint32_t width_, height_, side_, across_;
  std::vector<std::uint32_t> identities_;  ///< identity words of all samples, surrounded by words without identity
  std::vector<std::uint16_t> rounds_;      ///< per identity word: round in which this scan traced the sample
  std::vector<glm::vec3> colours_;
  std::vector<std::uint32_t> line_, found_;
  std::vector<Suspect> fresh_, all_;
};

/// Frame program undersample (Kim et al. 2016). Samples between similar references get interpolated attributes and are
/// shaded from those. Scans over the whole frame then correct samples whose interpolation missed something.
///
///   per tile: references -> check_attributes_x -> interpolate_attributes, shade | trace -> check_attributes_y -> ...
///             -> average_samples -> pack_colour -> transfer to the frame buffer
///   per scan and tile: identities from memory -> find_suspects -> trace -> find_suspects -> ... -> corrected pixels
class UndersampleProgram final : public FrameProgram {
 public:
  /// `scene_size` is the longest side of the scene's bounds, the same in all frames.
  UndersampleProgram(const traces::MemoryImage& image, const traces::Camera& camera, const RenderConfig& config,
                     const UndersampleConfig& undersample, float scene_size, std::uint32_t frame);

  std::uint32_t tiles() const override;
  TileGridSize tile_grid_size() const override { return {blocks_.tiles.tiles_across(), blocks_.tiles.tiles_down()}; }
  std::uint32_t pass_end(std::uint32_t tile_index) const override;
  FrameRequirements requirements() const override;
  void begin_pass(std::uint32_t tile_index, const traces::Tracer& tracer) override;
  void run_tile(std::uint32_t tile_index, const traces::Tracer& tracer, bool record, TileResult& out) const override;
  void commit_tile(const TileResult& tile) override;

 private:
  Verdict check_samples(BlockTile& tile, const BlockLines& lines) const;
  template <class K>
  Verdict launch_check(BlockTile& tile, const BlockLines& lines) const;
  void average_pixels(BlockTile& tile) const;
  template <class K>
  Wavefront::Node store_identity_words(BlockTile& tile) const;
  std::uint32_t scan_number(std::uint32_t tile_index) const { return tile_index / blocks_.tiles.tile_count() - 1; }
  // Scans of post-correction.
  std::uint32_t scan_bytes_per_sample() const;
  std::uint64_t scan_address(std::uint32_t tile) const;
  void run_scan(std::uint32_t tile_index, const traces::Tracer& tracer, bool record, TileResult& out) const;
  template <class Sample>
  void list_suspect_samples(std::span<const PostCorrection::Suspect> suspects, TileResult& out, Sample&& sample) const;
  void trace_suspects(Wavefront& wave, TileResult& out, const GridUniforms<float>& grid, std::uint32_t items,
                      Wavefront::Node lister) const;
  void average_pixel_again(std::uint32_t x, std::uint32_t y);
  Wavefront::Node record_suspect_search(TileGraph& graph, std::uint32_t items) const;
  void correct_samples(Wavefront& wave, TileResult& out, const SampleTile& at, Wavefront::Node found) const;
  void write_corrected_pixels(TileGraph& graph, const SampleTile& at, std::uint32_t corrected,
                              std::uint32_t corrected_pixels, Wavefront::Node last) const;

  const UndersampleConfig undersample_;
  const BlockFrame blocks_;
  const float apart_;  ///< largest distance between two hits at which the position check passes
  PostCorrection correction_;
};

}  // namespace kernels
