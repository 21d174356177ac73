#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <glm/vec3.hpp>

#include "shader_kernels/programs/wavefront/sampling.h"
#include "shader_kernels/records.h"
#include "sim/named.h"
#include "traces/raster/rasteriser.h"
#include "traces/ray.h"
#include "traces/stream.h"

namespace kernels {

using traces::kPixelBytes;

/// A wave: rays on their way, what they carry, where they hit. The three arrays are the ray slots of the tile buffer.
struct RaySlots {
  std::vector<traces::Ray> rays;
  std::vector<PathRecord<float>> paths;
  std::vector<traces::Hit> hits;
  void hold(std::size_t slots);
};

/// Work of the rays of a pixel.
struct PixelWork {
  std::uint32_t pixel = 0;  ///< index in the picture, row by row
  std::uint32_t rays = 0, steps = 0, tests = 0;
};

/// Contents of the tile buffer while a tile is made; afterwards nobody looks at them, and another tile may have it.
/// Arrays only grow, so that a used one allocates no more.
struct TileBuffer {
  RaySlots wave, next_wave, shadow, layer;
  // Streams of slots.
  std::vector<std::uint32_t> misses, surfaces, textured, diffuse, later, mirror, glass, emissive;
  std::vector<std::uint32_t> absorbing, vertexed, based, physical, bumped, blended, glowing, occluded;
  std::vector<std::uint32_t> layers, targets;  ///< hits to test; slots whose rays go on
  std::vector<SurfacePointRecord<float>> points;
  std::vector<DiffuseRecord<float>> mattes;
  std::vector<TexcoordRecord<float>> texcoords;
  std::vector<SpecularRecord<float>> optics;
  std::vector<TangentRecord<float>> tangents;
  std::vector<ColourRecord<float>> colours;  ///< per sample
  // Adaptive sampling: records that samples keep, verdicts on them, streams of them.
  std::vector<GeometryRecord<float>> geometry;
  std::vector<SecondaryRecord<float>> secondary;
  std::vector<SurfaceRecord<float>> kept;
  std::vector<ColourRecord<float>> globals;  ///< light of kept surfaces
  std::vector<std::uint32_t> verdicts, identities, samples, passed, failed;
  // Supersampling: records that samples keep; verdicts on sub-pixels, lists.
  std::vector<TraitsRecord<float>> traits, secondary_traits;
  std::vector<BranchRecord<float>> branches;
  std::vector<std::uint32_t> subpixels, active, masters, fills;
  std::vector<SubpixelRecord<float>> states;  ///< those of sub-pixels, between rounds of propagation
  std::vector<ColourRecord<float>> shown;     ///< by them
  std::vector<PixelWork> pixel_work;          ///< per sample, if anybody wants to know
  std::vector<VisibleRecord<float>> visible;  ///< those of reconstruct's samples
  std::vector<ColourRecord<float>> lights;    ///< those of samples whose effects have a lower rate
  std::vector<RatioRecord<float>> ratios;     ///< how much of these comes
  std::vector<std::uint32_t> record_nodes;    ///< launches of the work that have added to what samples keep
  std::vector<std::uint32_t> colour_nodes;    ///< launches of the work that have added to colours
  std::vector<traces::WorkNode> spare_nodes;
  traces::Coverage coverage;  ///< samples of a wave that is rasterised
  /// Names the arrays as the kernels' ports do.
  static void describe(auto& b, auto&& array) {
    array(NAMED(b.wave.rays)), array(NAMED(b.wave.paths)), array(NAMED(b.wave.hits));
    array(b.shadow.rays, "shadow_rays"), array(b.shadow.paths, "shadow_paths"), array(b.shadow.hits, "shadow_hits");
    array(b.layer.hits, "layer_hits"), array(NAMED(b.layers)), array(NAMED(b.targets));
    array(NAMED(b.misses)), array(NAMED(b.surfaces)), array(NAMED(b.textured)), array(NAMED(b.diffuse));
    array(NAMED(b.later));
    array(NAMED(b.mirror)), array(NAMED(b.glass)), array(NAMED(b.emissive));
    array(NAMED(b.absorbing)), array(NAMED(b.vertexed)), array(NAMED(b.based)), array(NAMED(b.physical));
    array(NAMED(b.bumped)), array(NAMED(b.blended)), array(NAMED(b.glowing)), array(NAMED(b.occluded));
    array(b.points, "places"), array(NAMED(b.mattes)), array(NAMED(b.texcoords)), array(NAMED(b.optics));
    array(NAMED(b.tangents)), array(NAMED(b.colours));
    array(NAMED(b.geometry)), array(NAMED(b.secondary)), array(NAMED(b.kept)), array(NAMED(b.globals));
    array(NAMED(b.verdicts)), array(NAMED(b.identities)), array(NAMED(b.samples));
    array(NAMED(b.passed)), array(NAMED(b.failed));
    array(NAMED(b.traits)), array(NAMED(b.branches));
    array(NAMED(b.active)), array(NAMED(b.masters)), array(NAMED(b.fills));
    array(NAMED(b.states)), array(NAMED(b.shown)), array(NAMED(b.visible));
    array(NAMED(b.lights)), array(NAMED(b.ratios));
  }
  void hold_wave(std::size_t slots);
  void hold_details(std::size_t slots);
  void hold_layers(std::size_t slots);
  void hold_samples(std::size_t count);
  /// For `pixels` pixels whose centres are among `centres` samples.
  void hold_subpixels(std::size_t centres, std::size_t pixels);
  /// Samples of reconstruct, `pixels` of which may be listed.
  void hold_visible(std::size_t count, std::size_t pixels);
  /// Samples whose effects have a lower rate, with so many lights.
  void hold_rated(std::size_t count, std::size_t light_count);
};

/// A sample as post-correction sees it.
struct ShownSample {
  std::uint32_t identity = 0;
  glm::vec3 colour{};
};

/// A sub-pixel as later rounds of propagation see it.
struct ShownSubpixel {
  std::uint32_t x = 0, y = 0;  ///< in the picture's grid of sub-pixels
  SubpixelRecord<float> state{};
  glm::vec3 colour{};
  bool is_background = false;  ///< by the sample at its pixel's centre
};

/// Result of one tile.
struct TileResult {
  /// Makes the work of primary waves in place of rays, if it is not null (geometry_pass.h).
  const traces::Rasteriser* rasteriser = nullptr;
  std::uint32_t tile = 0;
  std::uint32_t x = 0, y = 0, width = 0, height = 0;  ///< in pixels
  std::vector<glm::vec3> linear;                      ///< per pixel, row by row: linear RGB in [0, 1]
  std::vector<std::uint32_t> packed;                  ///< per pixel: as the frame buffer holds it, R in the lowest byte
  std::array<std::uint64_t, static_cast<std::size_t>(traces::RayKind::kCount)> rays{};
  std::uint64_t continued = 0;  ///< rays that went on behind what was no solid surface, counted above, too
  Sampling sampling;
  std::vector<SampleMark> marks;          ///< adaptive sampling's, per sample (or pixel) of the tile, row by row
  std::vector<ShownSample> shown;         ///< its own samples, row by row, if a later pass looks at them
  std::vector<ShownSubpixel> subpixels;   ///< its own, or those that a round has made active
  std::vector<std::uint32_t> corrected;   ///< pixels of the picture whose new colours a round has put into `linear`
  std::vector<std::uint32_t> background;  ///< samples whose primary ray hit nothing, in the order traced
  std::uint64_t traversal_steps = 0;  ///< node visits and triangle tests; counted from the walks, so 0 if not recorded
  std::uint64_t triangle_tests = 0;   ///< those of these steps that are triangle tests
  bool wants_pixel_work = false;      ///< says, before the tile is made, whether `pixel_work` is to be filled
  std::vector<PixelWork> pixel_work;  ///< a pixel may be there several times, also one of a neighbour's
  traces::TileWork work;              ///< filled if recorded
  TileBuffer buffer;
  /// Colour of a sample as it is averaged.
  glm::vec3 colour(std::uint32_t sample) const;
};

}  // namespace kernels
