#pragma once
#include <cstdint>
#include <vector>

#include "shader_kernels/kernels/generate_rays.h"
#include "shader_kernels/programs/adaptive/adaptive_config.h"
#include "shader_kernels/programs/adaptive/block_tile.h"
#include "shader_kernels/programs/wavefront/frame_program.h"
#include "shader_kernels/programs/wavefront/render_config.h"
#include "shader_kernels/programs/wavefront/scene_tables.h"
#include "shader_kernels/programs/wavefront/wavefront.h"

namespace kernels {

/// Frame program reconstruct (Chiu et al. 2012). A pixel has four samples on a rotated grid. One is shaded; the others
/// only find geometry and shadows. A filter computes the colour of each sample from the similar shaded samples around
/// it.
///
///   per tile: generate_shaded_rays  -> shaded -> limit_colours -+
///             generate_visible_rays -> geometry, shadows -------+-> [halo] -> reconstruct -> pack_colour -> frame
///                                                               list_branches -> reconstruct_branch
///
/// 1. Light from surfaces is filtered by their own geometry and shadows. Mirrored and refracted light is filtered by
/// the geometry and shadows of what the secondary rays hit.
/// 2. With a colour test, all four samples are shaded in pixels whose colour changes where the geometry does not:
///
///     reconstruct -> list_contrasts -> generate_contrast_rays -> shaded -> average_contrasts -> pack_colour
///
/// 3. reconstruct:sraa, for comparison, filters whole colours by the first hits' geometry. Its samples that are not
/// shaded cast primary rays only.
///
/// The light of the samples is divided into layers: layer 0 is the surface, then mirrored light, then refracted light.
/// Sample k of layer b of the pixel at `position` of the tile buffer has index position + (4 b + k) x
/// buffer_position_count(). Shaded samples also have a colour.
class ReconstructProgram final : public FrameProgram {
 public:
  enum class Filters : std::uint8_t { kApart, kOne };
  /// `scene_size` is the longest side of the scene's bounds, the same in all frames.
  ReconstructProgram(const traces::MemoryImage& image, const traces::Camera& camera, const RenderConfig& config,
                     const ReconstructConfig& reconstruct, Filters filters, float scene_size, std::uint32_t frame);

  std::uint32_t tiles() const override { return tiles_.tile_count(); }
  TileGridSize tile_grid_size() const override {
    return {tiles_.sample_tiles().tiles_across(), tiles_.sample_tiles().tiles_down()};
  }
  FrameRequirements requirements() const override;
  void run_tile(std::uint32_t tile_index, const traces::Tracer& tracer, bool record, TileResult& out) const override;

 private:
  using Node = Wavefront::Node;
  /// State of a tile while program reconstruct renders it.
  struct Tile {
    SampleTile at;
    FinishedUniforms<float> finished;
    std::uint32_t pixels;  ///< number of pixels whose final colours the tile computes
    Wavefront& wave;
    TileGraph& graph;
    TileResult& out;
    TileBuffer& buffer;
  };
  static constexpr std::uint32_t kOtherSamples = kGeometrySamples - 1;  ///< samples per pixel that are not shaded
  /// A rectangle of the tile buffer, in pixels.
  struct PixelRect {
    std::uint32_t x, y, across, down;
    std::uint32_t pixel_count() const { return across * down; }
  };

  bool filters_apart() const { return filters_ == Filters::kApart; }
  bool has_geometry() const { return reconstruct_.radius != 0; }
  bool tests_colours() const { return reconstruct_.colour >= 0; }
  std::uint32_t buffer_position_count() const { return tiles_.buffer_sample_count(); }
  /// Returns the number of records in one layer of light. It is the distance from a sample's record to the record of
  /// the same sample in the next layer.
  std::uint32_t records_per_layer() const { return kGeometrySamples * buffer_position_count(); }
  /// Return the bytes per pixel, summed over all layers of light. shaded_sample_bytes(): records and colours of the
  /// shaded sample. unshaded_sample_bytes(): records of the other samples. attribute_bytes(): records of all samples.
  std::uint32_t shaded_sample_bytes() const;
  std::uint32_t unshaded_sample_bytes() const;
  std::uint32_t attribute_bytes() const;
  std::uint32_t exchanged_bytes_per_sample() const;
  std::uint64_t stored_bytes_per_tile() const;

  /// Calls f<kBranches>(), where kBranches is the number of colour layers after the first: 0, 1 or 2 (mirrored light,
  /// refracted light).
  template <class Function>
  auto call_with_branch_count(Function&& f) const {
    if (layers_ == 1) return f.template operator()<0>();
    return layers_ == 2 ? f.template operator()<1>() : f.template operator()<2>();
  }
  Tile make_tile(const SampleTile& at, Wavefront& wave, TileResult& out) const;
  VisibleSamples records_to_keep(bool are_shaded) const;
  void bind_pixels(auto& ports, const Tile& tile) const;
  VisibleRayPorts<float>& bind_rays(VisibleRayPorts<float>& ports, const Tile& tile, const PixelRect& part) const;
  void trace_pixels(Tile& tile, const PixelRect& shaded, const PixelRect& others, bool is_own) const;
  Node clear_branches(Tile& tile, const PixelRect& part) const;
  void assign_samples_to_pixels(Tile& tile, std::uint32_t rays) const;
  void trace_shaded_samples(Tile& tile, const PixelRect& part, Node cleared) const;
  void trace_unshaded_samples(Tile& tile, const PixelRect& part, Node cleared) const;
  void clamp_colour_layers(Tile& tile, const PixelRect& part) const;
  void fill_halo(Tile& tile) const;
  void export_borders(Tile& tile) const;
  void spill_attributes_to_dram(Tile& tile) const;
  Node copy_shaded_colours(Tile& tile) const;
  Node filter_pixels(Tile& tile) const;
  template <std::uint32_t kRadius>
  Node launch_filter(Tile& tile) const;
  // The test for pixels whose colour changes where the geometry does not.
  Node shade_contrast_pixels(Tile& tile, Node filtered) const;
  template <std::uint32_t kBranches>
  Node shade_contrast_pixels(Tile& tile, Node filtered) const;
  template <class K>
  void bind_filter(typename K::template Ports<float>& ports, const Tile& tile) const;
  // Counts and debug pictures.
  void count_samples(Tile& tile) const;
  SampleMark pixel_mark(const Tile& tile, std::uint32_t pixel) const;

  const RenderConfig config_;
  const ReconstructConfig reconstruct_;
  const Filters filters_;
  const SceneTables scene_;
  const CameraUniforms<float> camera_;
  const FinishedTiles tiles_;
  const std::vector<std::uint32_t> order_;
  const std::uint32_t frame_;
  const float depth_scale_, bend_;
  std::uint32_t mirrors_ = 0, glass_ = 0;  ///< numbers of the layers of mirrored and refracted light; 0: none
  std::uint32_t layers_ = 1;
};

/// Sets a kernel's ports for the camera and the pixels of the tile.
void ReconstructProgram::bind_pixels(auto& ports, const Tile& tile) const {
  const auto halo = static_cast<float>(tiles_.halo_width()), pitch = static_cast<float>(tiles_.row_pitch());
  ports.camera = camera_;
  ports.grid = {.x0 = static_cast<float>(tile.at.x) - halo,
                .y0 = static_cast<float>(tile.at.y) - halo,
                .pitch = pitch,
                .inverse_pitch = 1.0F / pitch,
                .grid = 1,
                .inverse_grid = 1};
}

}  // namespace kernels
