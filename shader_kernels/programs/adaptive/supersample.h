#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <glm/vec3.hpp>

#include "shader_kernels/kernels/subpixels.h"
#include "shader_kernels/programs/adaptive/adaptive_config.h"
#include "shader_kernels/programs/adaptive/block_tile.h"
#include "shader_kernels/programs/wavefront/frame_program.h"
#include "shader_kernels/programs/wavefront/render_config.h"
#include "shader_kernels/programs/wavefront/scene_tables.h"
#include "shader_kernels/programs/wavefront/tile_result.h"
#include "shader_kernels/programs/wavefront/wavefront.h"

namespace kernels {

/// Colours and states of all sub-pixels of a picture, kept between rounds of propagation. A round reads the results of
/// earlier rounds. apply_round_results() applies a round's own results after all tiles of the round.
class PropagationState {
 public:
  /// `tiles` is the number of tiles of the picture. All sub-pixels are inactive at first.
  PropagationState(std::uint32_t width, std::uint32_t height, std::uint32_t tiles);

  /// Stores the sub-pixels of a tile before the first round of propagation.
  void store_initial_subpixels(std::uint32_t tile, const std::vector<PropagationSubpixel>& all);
  /// Collects the sub-pixels of a tile that became active in the current round of propagation. apply_round_results()
  /// makes them visible to later rounds.
  void add_activated_subpixels(std::uint32_t tile, const std::vector<PropagationSubpixel>& found);
  void apply_round_results();

  /// True if sub-pixels of the tile became active in the last round of propagation that apply_round_results() has
  /// applied.
  bool is_newly_active(std::uint32_t tile) const { return fresh_[tile] != 0; }
  /// Copies the states of a rectangle of sub-pixels at (x, y), and of one more sub-pixel on each side. Sub-pixels
  /// outside the picture are inactive.
  void copy_states(std::uint32_t x, std::uint32_t y, std::uint32_t width, std::uint32_t height,
                   SubpixelRecord<float>* to) const;
  const glm::vec3& subpixel_colour(std::uint32_t x, std::uint32_t y) const {
    return colours_[std::size_t{y} * width_ + x];
  }
  /// Returns how many sub-pixels of pixel (x, y) are active.
  std::uint32_t active_subpixel_count(std::uint32_t x, std::uint32_t y) const;
  bool is_background(std::uint32_t x, std::uint32_t y) const {
    return is_background_[std::size_t{y} * width_ + x] != 0;
  }

 private:
  void store_subpixels(const std::vector<PropagationSubpixel>& subpixels);

  const std::uint32_t width_, height_;         ///< size of the picture in sub-pixels
  std::vector<SubpixelRecord<float>> states_;  ///< states of all sub-pixels, surrounded by inactive ones
  std::vector<glm::vec3> colours_;
  std::vector<std::uint8_t> is_background_;
  std::vector<std::uint8_t> fresh_, next_fresh_;  ///< per tile: the last round, or this round, made sub-pixels active
  std::vector<PropagationSubpixel> found_;
};

/// Frame program supersample (Jin et al. 2009). Every pixel has one sample at its centre. Each of its four sub-pixels
/// is compared with the three pixels around its corner; if they differ, the sub-pixel is active and gets four more
/// samples, those of full:16.
///
///   per tile: centres -> test_subpixels -> add_inactive_subpixels -> pack_colour -> transfer to the frame buffer
///                                                         -> pack_subpixels -> generate_extra_rays -> sum_subpixels
///
/// 1. Pixels read neighbours one pixel away, with tiles as in FinishedTiles.
/// 2. Active sub-pixels are sampled in chunks of 64, which share 256 ray slots. A chunk begins when the previous one
/// has been summed.
/// 3. Packing `block` keeps the sub-pixels of a pixel in one chunk. Some entries are left empty for that; they are idle
/// iterations of all kernels before the next list is made.
/// 4. Packing `none` has no list: a chunk is 16 pixels, whose inactive sub-pixels are idle.
/// 5. Packing `atomic` lists sub-pixels in random order. A pixel's sub-pixels may be in several chunks, so all samples
/// are written to memory and read back before they are summed.
///
/// Rounds of propagation are passes over the whole frame; the sub-pixels' colours and states are in memory between
/// them. A tile reads them if the previous round made sub-pixels active in it or next to it:
///
///   propagate_subpixels -> chunks: generate_extra_rays -> settle_subpixels -> average_subpixels -> pack_colour
///
/// Not modelled: contention for the list's length with packing `atomic`, which costs a load and a store per sub-pixel.
class SupersampleProgram final : public FrameProgram {
 public:
  SupersampleProgram(const traces::MemoryImage& image, const traces::Camera& camera, const RenderConfig& config,
                     const SupersampleConfig& supersample, std::uint32_t frame);

  std::uint32_t tiles() const override { return tiles_.tile_count() * (1 + supersample_.propagate); }
  TileGridSize tile_grid_size() const override {
    return {tiles_.sample_tiles().tiles_across(), tiles_.sample_tiles().tiles_down()};
  }
  std::uint32_t pass_end(std::uint32_t tile_index) const override;
  FrameRequirements requirements() const override;
  void begin_pass(std::uint32_t tile_index, const traces::Tracer& tracer) override;
  void run_tile(std::uint32_t tile_index, const traces::Tracer& tracer, bool record, TileResult& out) const override;
  void commit_tile(const TileResult& tile) override;

 private:
  using Node = Wavefront::Node;
  /// State of a tile while program supersample renders it.
  struct Tile {
    SampleTile at;
    FinishedUniforms<float> finished;
    std::uint32_t pixels;  ///< number of pixels whose final colours the tile computes
    Wavefront& wave;
    TileGraph& graph;
    TileResult& out;
    TileBuffer& buffer;
    Node shown = Wavefront::kNone;  ///< last transfer of the colours and states of sub-pixels to memory
  };
  /// Active sub-pixels that are sampled together, and the pixels that they complete.
  struct Chunk {
    std::uint32_t first = 0, subpixels = 0;
    std::uint32_t padding = 0;  ///< number of entries of the chunk that are left empty
    std::uint32_t first_master = 0, masters = 0;
  };

  /// Bytes of a sample's records of its first hit and one secondary hit, without the colour.
  static constexpr std::uint32_t kAttributeBytes = 2 * sizeof(TraitsRecord<float>);

  std::uint32_t centre_samples() const { return tiles_.buffer_sample_count(); }
  std::uint32_t tile_pixels() const { return tiles_.most_pixels(); }
  std::uint64_t stored_bytes_per_tile() const;
  void begin_tile(const SampleTile& at, TileResult& out) const;
  Tile make_tile(const SampleTile& at, Wavefront& wave, TileResult& out) const;

  // Samples at pixel centres, and the tests for active sub-pixels.
  void trace_centres(Tile& tile, std::uint32_t x, std::uint32_t y, std::uint32_t across, std::uint32_t down,
                     bool is_own) const;
  std::array<float, kAttributes> attribute_thresholds() const;
  static std::size_t centre_sample_index(const Tile& tile, std::uint32_t pixel);
  Node test_pixels(Tile& tile) const;
  Node add_inactive_subpixels(Tile& tile, Node tested) const;
  template <bool kBilinear>
  Node launch_weighing(Tile& tile, Node tested) const;
  void count_samples(Tile& tile) const;

  // The halo and the borders of a tile.
  void fill_halo(Tile& tile) const;
  void export_borders(Tile& tile) const;
  void spill_attributes_to_dram(Tile& tile) const;

  // Samples of active sub-pixels.
  Node sample_active_subpixels(Tile& tile, Node tested, Node weighing) const;
  Node list_active_subpixels(Tile& tile, Node tested, std::vector<Chunk>& chunks) const;
  Node pack_subpixels_by_block(Tile& tile, Node tested, std::vector<Chunk>& chunks) const;
  Node pack_subpixels_by_atomics(Tile& tile, Node tested, std::vector<Chunk>& chunks) const;
  void chunk_all_subpixels(Tile& tile, std::vector<Chunk>& chunks) const;
  void trace_chunk(Tile& tile, const Chunk& chunk, std::uint32_t first_sample, Node after) const;
  void spill_chunk(Tile& tile, const Chunk& chunk) const;
  Node sum_chunk(Tile& tile, const Chunk& chunk, Node weighing) const;
  Node sum_samples_from_memory(Tile& tile, std::uint32_t subpixels, Node after_weighing) const;
  Node sum_samples(Tile& tile, std::uint32_t* listed, std::uint32_t pixels, std::uint32_t padding,
                   std::uint32_t first_index, Node weighing) const;

  // Rounds of propagation (supersample_rounds.cc).
  std::uint32_t subpixel_bytes() const;
  static std::uint32_t dma_waiting_bytes();
  std::uint64_t subpixel_data_address(std::uint32_t tile) const;
  std::uint64_t newly_active_flag_address(std::uint32_t tile, std::uint32_t round) const;
  static StateUniforms<float> state_uniforms(const Tile& tile);
  static PropagationSubpixel load_propagation_subpixel(const Tile& tile, std::uint32_t subpixel);
  void store_inactive_subpixels(Tile& tile) const;
  void store_active_subpixels(Tile& tile, const Chunk& chunk, std::uint32_t first_sample, std::uint32_t round) const;
  void write_subpixels(Tile& tile) const;
  bool has_newly_active_neighbour(const SampleTile& at, auto&& read) const;
  void run_round(std::uint32_t tile_index, const traces::Tracer& tracer, bool record, TileResult& out) const;
  Node read_subpixel_states(Tile& tile, Node before) const;
  void propagate_round(Tile& tile, std::uint32_t round, Node before) const;
  void write_corrected_pixels(Tile& tile, std::uint32_t pixels, std::uint32_t subpixels, std::uint32_t round) const;
  void load_other_subpixels(Tile& tile, std::uint32_t pixel) const;
  void recount_pixel(std::uint32_t pixel, const TileResult& tile);

  const RenderConfig config_;
  const SupersampleConfig supersample_;
  const SceneTables scene_;
  const CameraUniforms<float> camera_;
  const FinishedTiles tiles_;
  const std::vector<std::uint32_t> order_;
  const std::uint32_t frame_;
  PropagationState shown_;  ///< sub-pixels of the picture; empty if there are no rounds of propagation
};

}  // namespace kernels
