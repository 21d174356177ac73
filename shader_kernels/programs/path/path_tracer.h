#pragma once
#include <cstdint>
#include <vector>

#include "shader_kernels/kernels/generate_rays.h"
#include "shader_kernels/programs/path/path_config.h"
#include "shader_kernels/programs/wavefront/wavefront.h"

namespace kernels {

/// Traces the paths of a tile, one wave per bounce. Each path has one ray per wave, and a shadow ray at most.
///
///   rays -> classify_hits -> shade_background
///        -> surface stages, textures, emission of the wavefront
///        -> [classify_lit] -> sample_light, [sample_light_rough] -> shadow rays -> combine_shadow
///        -> choose_lobe -> [keep_visible] -> shade_straight, shade_mirror, shade_glass
///                       -> [scatter_rough], scatter_diffuse -> next rays
///
/// classify_lit and rough stages are for images with GGX roughness. keep_visible divides the surfaces of transparent
/// materials by whether scattered rays have hit them.
class PathTracer {
 public:
  using Node = Wavefront::Node;

  /// `wave` must outlive the tracer.
  PathTracer(Wavefront& wave, const PathConfig& config) : wave_(wave), config_(config) {}

  /// Traces and shades primary rays and all later bounces. Launch `maker` wrote the primary rays with the uniforms of
  /// `ports`, one ray for each sample, in the order of samples.
  void run(const GeneratePorts<float>& ports, Node maker, std::uint32_t samples, RetainedRecords retained = {});

 private:
  /// The surfaces at the front of a queue that rays with lower slots than scattered ones have hit.
  struct KeptSurfaces {
    Node node = Wavefront::kNone;  ///< launch that counted the surfaces, if any
    std::uint32_t items = 0;
  };

  Node seed_samples(const GeneratePorts<float>& ports, std::uint32_t samples);
  void shade_emission(WaveBounce& bounce);
  void keep_visible(WaveBounce& bounce, SlotQueue& queue);
  KeptSurfaces count_visible(const WaveBounce& bounce, SlotQueue& queue);
  void sample_lights(WaveBounce& bounce);
  void choose_lobes(WaveBounce& bounce);
  WaveBounce scatter(const WaveBounce& bounce);
  void add_reader(Node node) {
    if (node != Wavefront::kNone) readers_.push_back(node);
  }

  Wavefront& wave_;
  const PathConfig& config_;
  Node seeded_ = Wavefront::kNone;
  /// First ray slot of the wave's scattered rays: those from diffuse and rough surfaces, and their continuations
  /// through surfaces that shadow rays pass too.
  std::uint32_t scattered_ = 0;
  bool counts_all_ = false;    ///< scattered rays also see lamps, or the scene has none
  std::vector<Node> readers_;  ///< launches of the bounce that read throughputs and queues before choose_lobe
};

}  // namespace kernels
