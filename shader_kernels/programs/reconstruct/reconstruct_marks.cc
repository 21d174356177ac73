#include <algorithm>
#include <cmath>

#include "shader_kernels/programs/reconstruct/reconstruct.h"

namespace kernels {
namespace {

constexpr std::uint32_t kWanted = 16;  ///< samples of a pixel of what the picture stands for

/// A layer's edges: bits of its depth, normal, and shadow edges.
struct EdgeBits {
  std::uint32_t depth, normal, shadow;
};
constexpr std::uint32_t bit(FilterEdge edge) { return 1U << static_cast<std::uint32_t>(edge); }
constexpr EdgeBits kSurface{bit(FilterEdge::kDepth), bit(FilterEdge::kNormal), bit(FilterEdge::kShadow)};
constexpr EdgeBits kMirror{bit(FilterEdge::kReflection), bit(FilterEdge::kReflection),
                           bit(FilterEdge::kReflectedShadow)};
constexpr EdgeBits kGlass{bit(FilterEdge::kRefraction), bit(FilterEdge::kRefraction),
                          bit(FilterEdge::kRefractedShadow)};

}  // namespace

void ReconstructProgram::count(Tile& tile) const {
  Sampling& sampling = tile.out.sampling;
  sampling.wanted = std::uint64_t{kWanted} * tile.pixels;
  sampling.traced_background = tile.out.background.size();
  const std::uint32_t stands_for = has_geometry() ? kWanted / kGeometrySamples : kWanted;
  for (const std::uint32_t sample : tile.out.background) {
    const std::uint32_t position = sample % positions();
    const bool is_own = position % tiles_.pitch() >= tiles_.halo() && position / tiles_.pitch() >= tiles_.halo();
    sampling.background += is_own ? stands_for : 0;
  }
  if (!wants_marks() || !has_geometry()) return;
  tile.out.marks.resize(tile.pixels);
  for (std::uint32_t pixel = 0; pixel < tile.pixels; ++pixel) tile.out.marks[pixel] = mark(tile, pixel);
}

/// Compares as the filters do.
SampleMark ReconstructProgram::mark(const Tile& tile, std::uint32_t pixel) const {
  const FinishedUniforms<float>& of = tile.finished;
  const DivMod<float> at = finished_pixel<float>(static_cast<float>(pixel), of);
  const auto centre = static_cast<std::uint32_t>(centre_sample<float>(at, of));
  const auto radius = static_cast<float>(reconstruct_.radius);
  std::uint32_t edges = 0;
  float left = 0, all = 0;
  const auto compare = [&](std::uint32_t layer_number, const EdgeBits& bits, std::uint32_t shaded, std::uint32_t k) {
    const std::uint32_t first = layer_number * layer();
    const VisibleRecord<float>& own = tile.buffer.visible[first + k * positions() + centre];
    if (!has_branch<float>(own)) return;
    const Similarity<float> similar(own, tile.buffer.visible[first + shaded], bend_);
    edges |= (similar.depth > kHalved ? bits.depth : 0) | (similar.normal > kHalved ? bits.normal : 0) |
             (similar.same_shadows ? 0 : bits.shadow);
    if (layer_number != 0) return;
    left += similar.weight();
    all += 1;
  };
  for (float y = std::max(of.low_y, at.quotient - radius); y <= std::min(of.high_y, at.quotient + radius); ++y) {
    for (float x = std::max(of.low_x, at.remainder - radius); x <= std::min(of.high_x, at.remainder + radius); ++x) {
      const auto shaded = static_cast<std::uint32_t>(of.first + y * of.pitch + x);
      for (std::uint32_t k = 0; k < kGeometrySamples; ++k) {
        compare(0, kSurface, shaded, k);
        if (mirrors_ != 0) compare(mirrors_, kMirror, shaded, k);
        if (glass_ != 0) compare(glass_, kGlass, shaded, k);
      }
    }
  }
  const auto share = static_cast<std::uint32_t>(std::lround(255 * left / all));
  return static_cast<SampleMark>(edges | share << kWeightShift);
}

}  // namespace kernels
