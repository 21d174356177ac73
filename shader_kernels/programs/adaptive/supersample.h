#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "shader_kernels/kernels/subpixels.h"
#include "shader_kernels/programs/adaptive/adaptive_config.h"
#include "shader_kernels/programs/adaptive/sample_tiles.h"
#include "shader_kernels/programs/adaptive/shown_subpixels.h"
#include "shader_kernels/programs/wavefront/frame_program.h"
#include "shader_kernels/programs/wavefront/render_config.h"
#include "shader_kernels/programs/wavefront/scene_tables.h"
#include "shader_kernels/programs/wavefront/wavefront.h"

namespace kernels {

/// Frame program supersample (Jin et al. 2009): every pixel has one sample at its centre; each of its four sub-pixels
/// is compared with the three pixels around its corner and, if need be, gets four samples more, those of full:16.
///
///   per tile: centres -> test_subpixels -> weigh_centres -> pack_colour -> transfer to the frame buffer
///                                                         -> pack_subpixels -> generate_extra_rays -> sum_subpixels
///
/// Pixels look one pixel far to all sides, tiles as FinishedTiles has it.
///
/// Active sub-pixels are sampled in chunks of 64, which share the slots of 256 rays, so a chunk begins when the one
/// before has been summed up. Packing: `block` lists them so that no pixel is cut by a chunk; entries left empty for
/// that idle through the loops up to the first inspector's. `none` has no list: a chunk is 16 pixels, and their
/// inactive sub-pixels idle likewise. `atomic` cuts pixels and mixes them up, so sums must wait until all chunks are
/// done: the chunks' samples go to memory, and all are read back at once. Not modelled: contention for the list's
/// length, which costs its own kernel a load and a store per sub-pixel here.
///
/// Rounds of propagation are passes over the whole frame. What sub-pixels show lies in memory between them; a tile that
/// sub-pixels made active by the round before lie in, or beside, reads it:
///
///   propagate_subpixels -> chunks: generate_extra_rays -> settle_subpixels -> average_subpixels -> pack_colour
class SupersampleProgram final : public FrameProgram {
 public:
  SupersampleProgram(const traces::MemoryImage& image, const traces::Camera& camera, const RenderConfig& config,
                     const SupersampleConfig& supersample, std::uint32_t frame);

  std::uint32_t tiles() const override { return tiles_.count() * (1 + supersample_.propagate); }
  TileCounts tile_counts() const override { return {tiles_.tiles().across(), tiles_.tiles().down()}; }
  std::uint32_t pass_end(std::uint32_t tile_index) const override;
  FrameRequirements requirements() const override;
  void begin_pass(std::uint32_t tile_index, const traces::Tracer& tracer) override;
  void run_tile(std::uint32_t tile_index, const traces::Tracer& tracer, bool record, TileResult& out) const override;
  void commit_tile(const TileResult& tile) override;

 private:
  using Node = Wavefront::Node;
  /// A tile being worked on.
  struct Tile {
    SampleTile at;
    FinishedUniforms<float> finished;
    std::uint32_t pixels;  ///< finished
    Wavefront& wave;
    TileGraph& graph;
    TileResult& out;
    TileBuffer& buffer;
    Node shown = Wavefront::kNone;  ///< the last transfer of what sub-pixels show
  };
  /// Sub-pixels that are sampled at once, and pixels that are then complete.
  struct Chunk {
    std::uint32_t first = 0, subpixels = 0;
    std::uint32_t padding = 0;  ///< sub-pixels that idle beside them
    std::uint32_t first_master = 0, masters = 0;
  };

  /// Bytes that a sample keeps beside its colour: two hits.
  static constexpr std::uint32_t kAttributeBytes = 2 * sizeof(TraitsRecord<float>);

  std::uint32_t centres() const { return tiles_.samples(); }
  std::uint32_t tile_pixels() const { return tiles_.most_pixels(); }
  std::uint64_t store_bytes() const;
  void begin_tile(const SampleTile& at, TileResult& out) const;
  Tile tile_of(const SampleTile& at, Wavefront& wave, TileResult& out) const;

  // Centres and tests.
  void trace_centres(Tile& tile, std::uint32_t x, std::uint32_t y, std::uint32_t across, std::uint32_t down,
                     bool is_own) const;
  std::array<float, kAttributes> thresholds() const;
  static std::size_t centre_of(const Tile& tile, std::uint32_t pixel);
  Node test(Tile& tile) const;
  Node weigh(Tile& tile, Node tested) const;
  template <bool kBilinear>
  Node weigh_with(Tile& tile, Node tested) const;
  void count(Tile& tile) const;

  // Halo.
  void make_halo(Tile& tile) const;
  void export_borders(Tile& tile) const;
  void spill_attributes_to_dram(Tile& tile) const;

  // Samples of active sub-pixels.
  Node sample_active(Tile& tile, Node tested, Node weighed) const;
  Node pack(Tile& tile, Node tested, std::vector<Chunk>& chunks) const;
  Node pack_by_block(Tile& tile, Node tested, std::vector<Chunk>& chunks) const;
  Node pack_by_atomics(Tile& tile, Node tested, std::vector<Chunk>& chunks) const;
  void take_all(Tile& tile, std::vector<Chunk>& chunks) const;
  void trace_extra(Tile& tile, const Chunk& chunk, std::uint32_t first_sample, Node after) const;
  void spill_chunk(Tile& tile, const Chunk& chunk) const;
  Node sum_up(Tile& tile, const Chunk& chunk, Node weighed) const;
  Node sum_from_memory(Tile& tile, std::uint32_t subpixels, Node weighed) const;
  Node sum(Tile& tile, std::uint32_t* listed, std::uint32_t pixels, std::uint32_t padding, std::uint32_t first_index,
           Node weighed) const;

  // Rounds of propagation (supersample_rounds.cc).
  std::uint32_t shown_bytes() const;
  static std::uint32_t waiting_bytes();
  std::uint64_t shown_store(std::uint32_t tile) const;
  std::uint64_t fresh_store(std::uint32_t tile, std::uint32_t round) const;
  static StateUniforms<float> state_uniforms(const Tile& tile);
  static ShownSubpixel shown_subpixel(const Tile& tile, std::uint32_t subpixel);
  void show(Tile& tile) const;
  void settle(Tile& tile, const Chunk& chunk, std::uint32_t first_sample, std::uint32_t round) const;
  void put_shown(Tile& tile) const;
  bool is_reached(const SampleTile& at, auto&& read) const;
  void run_round(std::uint32_t tile_index, const traces::Tracer& tracer, bool record, TileResult& out) const;
  Node read_states(Tile& tile, Node before) const;
  void propagate(Tile& tile, std::uint32_t round, Node before) const;
  void put_corrected(Tile& tile, std::uint32_t pixels, std::uint32_t subpixels, std::uint32_t round) const;
  void take_others(Tile& tile, std::uint32_t pixel) const;
  void count_again(std::uint32_t pixel, const TileResult& tile);

  const RenderConfig config_;
  const SupersampleConfig supersample_;
  const SceneTables scene_;
  const CameraUniforms<float> camera_;
  const FinishedTiles tiles_;
  const std::vector<std::uint32_t> order_;
  const std::uint32_t frame_;
  ShownSubpixels shown_;  ///< empty without rounds
};

}  // namespace kernels
