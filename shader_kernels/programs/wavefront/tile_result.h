#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <glm/vec3.hpp>

#include "shader_kernels/programs/wavefront/sampling.h"
#include "shader_kernels/records.h"
#include "traces/raster/rasteriser.h"
#include "traces/ray.h"
#include "traces/stream.h"

namespace kernels {

/// Work items of a shading stage: indices of ray slots, samples or pixels (`Item`). A classifying kernel writes
/// `entries`, and its counter port sets `items`. There is one spare entry: rejected items are written after the end.
template <class Item>
struct Queue {
  std::vector<std::uint32_t> entries;
  std::uint32_t items = 0;
};
struct RaySlotItem;
struct SampleItem;
struct PixelItem;
using SlotQueue = Queue<RaySlotItem>;
using SampleQueue = Queue<SampleItem>;
using PixelQueue = Queue<PixelItem>;

/// Ray slots of a wave: the rays in flight with their paths and hits.
struct RaySlots {
  std::vector<traces::Ray> rays;
  std::vector<PathRecord<float>> paths;
  std::vector<traces::Hit> hits;
  void reserve_slots(std::size_t slots);
};

/// All ray slots of a tile.
struct RayBuffers {
  RaySlots wave, next_wave, shadow;
  RaySlots layer;  ///< rays that continue after a hole or tinted glass
};

/// Queues between the shading stages of a wave. A wave is a batch of rays of one tile (wavefront.h).
struct StageQueues {
  SlotQueue misses, surfaces;                            ///< slots that kernel classify_hits has listed
  SlotQueue textured, diffuse, mirror, glass, emissive;  ///< surfaces by material class, from classify_surfaces
  SlotQueue deferred;  ///< diffuse surfaces whose lighting must wait for kernels of their other classes
  SlotQueue absorbing, vertexed, based, physical, bumped, blended;  ///< surfaces by rarer class, from classify_details
  SlotQueue glowing, occluded;                                      ///< surfaces by rarer class, from classify_details
  SlotQueue rough;                                                  ///< surfaces that GGX microfacets reflect
  SlotQueue layers;   ///< ray slots whose hits must be tested for transparency
  SlotQueue targets;  ///< ray slots that receive the hits of continuing rays
  /// Empties all queues of surfaces.
  void clear_surfaces();
};

/// The surfaces that the rays of a wave hit, indexed by ray slot.
struct HitSurfaces {
  std::vector<SurfacePointRecord<float>> points;
  std::vector<DiffuseRecord<float>> mattes;
  std::vector<TexcoordRecord<float>> texcoords;
  std::vector<SpecularRecord<float>> optics;
  std::vector<TangentRecord<float>> tangents;
};

/// Colours of a tile's samples, and records of what their rays hit.
struct SampleRecords {
  std::vector<ColourRecord<float>> colours;
  std::vector<GeometryRecord<float>> geometry;
  std::vector<SecondaryRecord<float>> secondary;
  std::vector<SurfaceRecord<float>> kept;
  std::vector<std::uint32_t> seeds;          ///< seeds of random numbers (path programs)
  std::vector<ColourRecord<float>> globals;  ///< global colours of samples: without light from lights at the first hit
};

/// Results of the similarity checks in the programs multirate and undersample.
struct CheckRecords {
  std::vector<std::uint32_t> verdicts,
      identities;       ///< words of similarity checks and of post-correction, indexed by sample
  SampleQueue samples;  ///< list of samples to be traced
  SampleQueue passed, failed;
};

/// Data that the program supersample keeps of samples and sub-pixels.
struct SubpixelRecords {
  std::vector<TraitsRecord<float>> traits, secondary_traits;  ///< data of first and secondary hits to compare
  std::vector<BranchRecord<float>> branches;
  std::vector<std::uint32_t> verdicts;  ///< results of the tests for active sub-pixels, indexed by sub-pixel
  std::vector<std::uint32_t> active, fills;
  PixelQueue masters;
  std::vector<SubpixelRecord<float>> states;  ///< states of sub-pixels between rounds of propagation
  std::vector<ColourRecord<float>> shown;     ///< colours of sub-pixels, kept for rounds of propagation
};

/// Data that filters read: the records of the program reconstruct, and those of effects that are traced at only some
/// pixels.
struct FilterRecords {
  std::vector<VisibleRecord<float>> visible;
  std::vector<ColourRecord<float>> lights;  ///< unblocked light of samples (UpsampledProgram)
  std::vector<RatioRecord<float>> ratios;   ///< visible fraction of each light (UpsampledProgram)
};

/// Data of the denoiser: guides of samples, then packed records of pixels, in the precision of the history.
struct DenoiseRecords {
  std::vector<GuideRecord<float>> guides;
  std::vector<GuideWords<float>> guide_words;
  std::vector<HalfLightRecord<float>> half_light, half_filtered;
  std::vector<LightRecord<float>> light, filtered;
  std::vector<std::uint32_t> half_moments, motions, albedos;
  std::vector<MomentsRecord<float>> moments;
  std::vector<LightRecord<float>> taps;  ///< unpacked pixels of a tile and its halo
  std::vector<GuideTapRecord<float>> guide_taps;
};

/// Traversal work of the rays of one pixel.
struct PixelWork {
  std::uint32_t pixel = 0;  ///< index of the pixel in the picture, row by row
  std::uint32_t rays = 0, steps = 0, tests = 0;
};

/// Data of a tile in progress that only the host needs; the modelled GPU does not have these data.
struct TileScratch {
  std::vector<PixelWork> pixel_work;          ///< traversal work of each sample's rays, if it is counted
  std::vector<std::uint32_t> record_writers;  ///< nodes of the work graph that write records of samples
  std::vector<std::uint32_t> colour_writers;  ///< nodes of the work graph that add to samples' colours
  std::vector<traces::WorkNode> spare_nodes;
  traces::Coverage coverage;  ///< pixels covered by the triangles of a rasterised wave
};

/// Contents of the tile buffer while a tile is rendered. Arrays only grow, so that a reused buffer allocates nothing.
struct TileBuffer {
  RayBuffers rays;
  StageQueues queues;
  HitSurfaces surfaces;
  SampleRecords samples;
  CheckRecords checks;
  SubpixelRecords subpixels;
  FilterRecords filters;
  DenoiseRecords denoise;
  TileScratch scratch;

  /// Grows the arrays of a wave to `slots` ray slots.
  void reserve_wave(std::size_t slots);
  void reserve_details(std::size_t slots);
  void reserve_layers(std::size_t slots);
  void reserve_paths(std::size_t slots);  ///< grows the arrays of the program path:N
  void reserve_samples(std::size_t sample_count);
  /// Grows the arrays of the program supersample. `centres`: centre samples of a tile and its halo; `pixels`: pixels of
  /// a tile.
  void reserve_subpixels(std::size_t centres, std::size_t pixels);
  /// Grows the arrays of the program reconstruct. `record_count`: records of samples in all layers of light; `pixels`:
  /// maximum length of its lists of pixels.
  void reserve_visible(std::size_t record_count, std::size_t pixels);
  /// Grows the arrays for effects that are traced at only some pixels, to `sample_count` samples and `light_count`
  /// lights.
  void reserve_low_rate(std::size_t sample_count, std::size_t light_count);
  /// Grows the arrays of the denoiser, to `sample_count` guides and `pixels` pixels of a tile and its halo.
  void reserve_denoise(std::size_t sample_count, std::size_t pixels);
};

using traces::kPixelBytes;

/// A sample as post-correction stores it: identity word and colour.
struct CorrectionSample {
  std::uint32_t identity = 0;
  glm::vec3 colour{};
};

/// Colour and state of a sub-pixel, as the program supersample stores them for later rounds of propagation.
struct PropagationSubpixel {
  std::uint32_t x = 0, y = 0;  ///< position in the picture's grid of sub-pixels
  SubpixelRecord<float> state{};
  glm::vec3 colour{};
  bool is_background = false;  ///< the primary ray at the pixel's centre hit nothing
};

/// All results that a frame program returns for one entry (mostly a tile) of its list.
struct TileResult {
  /// If not null, rasterisation by this rasteriser is recorded instead of primary rays (geometry_pass.h).
  const traces::Rasteriser* rasteriser = nullptr;
  traces::TilePredictions* predictions = nullptr;  ///< predictor that shadow rays look up; null: none
  std::uint32_t tile = 0;
  std::uint32_t x = 0, y = 0, width = 0, height = 0;  ///< rectangle of the tile in the picture, in pixels
  std::vector<glm::vec3> linear;                      ///< for each pixel, row by row: linear RGB in [0, 1]
  std::vector<std::uint32_t> packed;  ///< for each pixel, the word of the frame buffer, R in the lowest byte
  std::array<std::uint64_t, static_cast<std::size_t>(traces::RayKind::kCount)> rays{};
  std::uint64_t continued = 0;  ///< rays that continued after a transparent surface; `rays` includes them
  Sampling sampling;
  std::vector<SampleMark> marks;               ///< debug marks, per sample or pixel of the tile, row by row
  std::vector<CorrectionSample> shown;         ///< the tile's samples, row by row, if a later pass needs them
  std::vector<PropagationSubpixel> subpixels;  ///< all the tile's sub-pixels, or those that a round made active
  std::vector<std::uint32_t> corrected;        ///< pixels of the picture whose new colours are in `linear`
  std::vector<std::uint32_t> background;       ///< samples whose primary ray hit nothing, in the order traced
  std::uint64_t traversal_steps = 0;           ///< node visits and triangle tests of the rays' walks; 0 if not recorded
  std::uint64_t triangle_tests = 0;            ///< triangle tests among `traversal_steps`
  bool wants_pixel_work = false;               ///< set before rendering to fill `pixel_work`
  std::vector<PixelWork> pixel_work;  ///< work per pixel; a pixel may have several entries, or be a neighbour's
  traces::TileWork work;              ///< the graph of work, if it is recorded
  TileBuffer buffer;
  /// Returns a sample's colour, clamped to [0, 1]. A pixel is the mean of sample colours that are clamped in this way.
  glm::vec3 averaged_colour(std::uint32_t sample) const;
  /// Makes this the result of an entry that renders no pixels, numbered as a tile after those of the frame.
  void clear_for_pass_entry(std::uint32_t frame, std::uint32_t entry);
};

/// Number of loop iterations that a kernel has run, including iterations without work.
struct KernelItems {
  traces::KernelId kernel = 0;
  std::uint32_t items = 0;
};

/// Work of one entry of the tile list, in counts that do not depend on a machine.
struct TileSummary {
  std::uint32_t tile = 0;
  std::uint32_t x = 0, y = 0, width = 0, height = 0;  ///< rectangle of the tile in the picture, in pixels
  bool begins_pass = false;                           ///< the entry waits for all earlier ones
  std::array<std::uint64_t, static_cast<std::size_t>(traces::RayKind::kCount)> rays{};
  std::uint64_t steps = 0, tests = 0;  ///< canonical steps (node visits and triangle tests), and triangle tests alone
  std::uint64_t accesses = 0;          ///< number of records and texels that kernels read through the data cache
  std::uint64_t transfer_bytes = 0;    ///< bytes moved between tile buffer and memory
  std::uint64_t kernels = 0;           ///< index in TileSummaries::kernels after the last entry of this tile
};

/// The summaries of all entries of a frame (mostly tiles), in list order.
struct TileSummaries {
  std::vector<TileSummary> tiles;
  std::vector<KernelItems> kernels;  ///< item counts of all kernels, one tile after the other
  void add(const TileResult& tile);
};

}  // namespace kernels
