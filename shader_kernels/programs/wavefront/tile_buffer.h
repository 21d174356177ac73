#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

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

/// Queues between the shading stages of a wave. A wave is a batch of rays of one tile (stages.h).
struct StageQueues {
  SlotQueue misses, surfaces;                            ///< slots that kernel classify_hits has listed
  SlotQueue textured, diffuse, mirror, glass, emissive;  ///< surfaces by material class, from classify_surfaces
  SlotQueue deferred;  ///< diffuse surfaces whose lighting must wait for kernels of their other classes
  SlotQueue absorbing, vertexed, based, physical, bumped, blended;  ///< surfaces by rarer class, from classify_details
  SlotQueue glowing, occluded;                                      ///< surfaces by rarer class, from classify_details
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
  TileScratch scratch;

  /// Grows the arrays of a wave to `slots` ray slots.
  void reserve_wave(std::size_t slots);
  void reserve_details(std::size_t slots);
  void reserve_layers(std::size_t slots);
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
};

}  // namespace kernels
