#pragma once
#include <array>
#include <cstdint>

#include "shader_kernels/catalogue.h"
#include "shader_kernels/programs/wavefront/stream_builder.h"

namespace kernels {

/// Rays that have been traced.
struct TracedBatch {
  StreamBuilder::Node rays = StreamBuilder::kNone;
  StreamBuilder::Node settled =
      StreamBuilder::kNone;  ///< the launch that has put the last hit into its slot, if any ray went on
};

/// Nodes that the launches of a bounce wait for.
struct WaveBounce {
  std::uint32_t rays = 0;
  std::uint32_t depth = 1;
  std::uint32_t lanes = 0, padding = 0;       ///< as for launch()
  std::uint32_t mirrored = 0, refracted = 0;  ///< first slots of rays that were; those before went straight on
  StreamBuilder::Node recorded = StreamBuilder::kNone;  ///< the launch that keeps its geometry
  StreamBuilder::Node begun = StreamBuilder::kNone;     ///< the launch that gave its rays samples of their own
  StreamBuilder::Node after = StreamBuilder::kNone;     ///< the last launch of the bounce before that changes colours
  std::array<TracedBatch, 3> batches{};
  std::uint32_t batch_count = 0;
  bool is_single = true;                                 ///< no sample has two of its rays
  StreamBuilder::Node inspector = StreamBuilder::kNone;  ///< fills the streams
  StreamBuilder::Node colours = StreamBuilder::kNone;  ///< makes the base colours, if nothing before the inspector did
};

/// Items of the streams that a bounce's surfaces have been sorted into.
struct WaveStreams {
  std::uint32_t textured = 0, diffuse = 0, mirror = 0, glass = 0, emissive = 0;
  bool has_lit = false;  ///< diffuse surfaces have their ambient and first light, but for those listed for later
  std::uint32_t later = 0;
  std::uint32_t unlit() const { return has_lit ? later : diffuse; }  ///< diffuse surfaces that have no light yet
  std::uint32_t blended = 0, glowing = 0, occluded = 0;              ///< streams of classify_details
  void take(const ClassifySurfaces::Ports<float>& sorted);
  /// Streams of a kernel that lights surfaces at once.
  template <class P>
  void take_lit(P& ports) {
    take(ports_of<ClassifySurfaces>(ports));
    has_lit = true;
    later = ports_of<ListLater>(ports).later_count.value;
  }
};

}  // namespace kernels
