#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "shader_kernels/records.h"
#include "traces/raster/rasteriser.h"
#include "traces/ray.h"
#include "traces/stream.h"

namespace kernels {

/// Work items of a stage: indices of ray slots, samples or pixels (`Item`). An inspector kernel writes `entries`, and
/// its counter port sets `items`. There is one spare entry, because rejected items are written after the end.
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

/// Ray slots of a wave: rays in flight, their paths and hits.
struct RaySlots {
  std::vector<traces::Ray> rays;
  std::vector<PathRecord<float>> paths;
  std::vector<traces::Hit> hits;
  void reserve_slots(std::size_t slots);
};

/// Rays of a tile in flight.
struct RayBuffers {
  RaySlots wave, next_wave, shadow;
  RaySlots layer;  ///< rays that continue after a hole or tinted glass
};

/// Queues between the shading stages of a wave, which is a batch of rays of one tile (stages.h).
struct StageQueues {
  SlotQueue misses, surfaces;                                       ///< from classify_hits
  SlotQueue textured, diffuse, mirror, glass, emissive;             ///< from classify_surfaces
  SlotQueue deferred;                                               ///< diffuse surfaces with deferred light
  SlotQueue absorbing, vertexed, based, physical, bumped, blended;  ///< from classify_details
  SlotQueue glowing, occluded;                                      ///< from classify_details
  SlotQueue layers;                                                 ///< hits to test for holes
  SlotQueue targets;                                                ///< slots of continuing rays
  /// Empties all queues of surfaces.
  void clear_surfaces();
};

/// Surfaces hit by a wave, by ray slot.
struct HitSurfaces {
  std::vector<SurfacePointRecord<float>> points;
  std::vector<DiffuseRecord<float>> mattes;
  std::vector<TexcoordRecord<float>> texcoords;
  std::vector<SpecularRecord<float>> optics;
  std::vector<TangentRecord<float>> tangents;
};

/// Colours of samples, and records of their hits.
struct SampleRecords {
  std::vector<ColourRecord<float>> colours;
  std::vector<GeometryRecord<float>> geometry;
  std::vector<SecondaryRecord<float>> secondary;
  std::vector<SurfaceRecord<float>> kept;
  std::vector<ColourRecord<float>> globals;  ///< light of kept surfaces from reflection and refraction
};

/// Checks of multirate and undersample.
struct CheckRecords {
  std::vector<std::uint32_t> verdicts, identities;  ///< by sample
  SampleQueue samples;                              ///< samples to trace
  SampleQueue passed, failed;
};

/// Records of supersample.
struct SubpixelRecords {
  std::vector<TraitsRecord<float>> traits, secondary_traits;  ///< by sample
  std::vector<BranchRecord<float>> branches;
  std::vector<std::uint32_t> verdicts;  ///< by sub-pixel
  std::vector<std::uint32_t> active, fills;
  PixelQueue masters;
  std::vector<SubpixelRecord<float>> states;  ///< states of sub-pixels between rounds of propagation
  std::vector<ColourRecord<float>> shown;     ///< colours of sub-pixels
};

/// Records for filters: those of reconstruct, and of effects with a lower rate.
struct FilterRecords {
  std::vector<VisibleRecord<float>> visible;
  std::vector<ColourRecord<float>> lights;  ///< unoccluded light of samples whose effects have a lower rate
  std::vector<RatioRecord<float>> ratios;   ///< visible share of that light
};

/// Work of the rays of a pixel.
struct PixelWork {
  std::uint32_t pixel = 0;  ///< index in the picture, row by row
  std::uint32_t rays = 0, steps = 0, tests = 0;
};

/// Host-side data of a tile in progress.
struct TileScratch {
  std::vector<PixelWork> pixel_work;          ///< by sample, if counted
  std::vector<std::uint32_t> record_writers;  ///< nodes that write records of samples
  std::vector<std::uint32_t> colour_writers;  ///< nodes that add to colours
  std::vector<traces::WorkNode> spare_nodes;
  traces::Coverage coverage;  ///< coverage of a rasterised wave
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

  /// Makes room for a wave of `slots` rays.
  void reserve_wave(std::size_t slots);
  void reserve_details(std::size_t slots);
  void reserve_layers(std::size_t slots);
  void reserve_samples(std::size_t count);
  /// Makes room for `pixels` pixels whose centres are among `centres` samples.
  void reserve_subpixels(std::size_t centres, std::size_t pixels);
  /// Makes room for `count` samples of reconstruct; at most `pixels` of them are queued.
  void reserve_visible(std::size_t count, std::size_t pixels);
  /// Makes room for `count` samples with effects at a lower rate, and `light_count` lights.
  void reserve_rated(std::size_t count, std::size_t light_count);
};

}  // namespace kernels
