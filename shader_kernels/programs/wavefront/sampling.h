#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "shader_kernels/kernels/similarity.h"
#include "shader_kernels/kernels/subpixels.h"

namespace kernels {

/// Counts of the samples that a frame program was to find out, and of those that it traced. A sample is background if
/// its primary ray hits nothing, or if it lies between two that are.
struct Sampling {
  std::uint64_t wanted = 0;
  std::uint64_t traced = 0;                             ///< halo and correction included
  std::uint64_t halo = 0;                               ///< traced samples of neighbouring tiles, once more
  std::uint64_t correction = 0;                         ///< traced samples that were first taken for similar
  std::uint64_t background = 0, traced_background = 0;  ///< samples of the wanted, of the traced
  std::uint64_t checked = 0, passed = 0;                ///< samples between references
  std::array<std::uint64_t, static_cast<std::size_t>(Check::kCount)> failed{};  ///< a sample may fail several checks
  std::array<std::uint64_t, static_cast<std::size_t>(Check::kCount)> first_failed{};  ///< by the first that it fails
  std::uint64_t rough = 0;  ///< samples that have passed, but that a tile's rate does not count

  // supersample: pixels by how many of their sub-pixels are active, active sub-pixels by what disagreed (one may have
  // several reasons; by the first one, too), and entries that listing them left empty.
  std::array<std::uint64_t, 5> active{};
  std::array<std::uint64_t, kAttributes> reasons{}, first_reasons{};
  std::uint64_t padding = 0;
  std::uint64_t propagated = 0;  ///< sub-pixels made active by rounds of propagation

  /// Per tile of the grid, row by row, where tiles have them: share of checked samples that passed, and block side.
  std::vector<float> similar;
  std::vector<std::uint8_t> blocks;
  std::uint32_t tile_side = 0;  ///< in samples
  bool has_rates = false;       ///< blocks differ from tile to tile

  /// Adds a tile's or another frame's counts; what is per tile stays.
  void add(const Sampling& other);
};

/// Mark of a sample: bits of failed checks (Check), and above them how it came about.
using SampleMark = std::uint16_t;
inline constexpr SampleMark kTracedMark = 1U << 12, kReferenceMark = 1U << 13, kCorrectedMark = 1U << 14;
static_assert(static_cast<std::size_t>(Check::kCount) <= 12);

// Mark of a pixel of supersample: attributes that disagreed at its active sub-pixels (Attribute, a bit each), and above
// them how many of those there are.
inline constexpr std::uint32_t kActiveCountShift = kAttributes;
inline constexpr std::uint32_t active_of(SampleMark mark) { return (mark >> kActiveCountShift) & 7U; }
static_assert(kActiveCountShift + 3 <= 12);

/// Reason that parts a sample of reconstruct from a shaded one that is looked at, by the filter that finds it: of what
/// surfaces show, of what mirrors show, of what is seen through glass.
enum class FilterEdge : std::uint8_t {
  kDepth,
  kNormal,
  kShadow,
  kReflection,  ///< depth or normal
  kReflectedShadow,
  kRefraction,
  kRefractedShadow,
  kCount
};
constexpr std::array<std::string_view, static_cast<std::size_t>(FilterEdge::kCount)> names_of(FilterEdge) {
  return {"depth", "normal", "shadow", "reflection", "reflected-shadow", "refraction", "refracted-shadow"};
}

// Mark of a pixel of reconstruct: edges that its filters found, a bit each, and above them what is left of the weights
// of all shaded samples at all of its samples' surfaces, of 255.
inline constexpr std::uint32_t kWeightShift = 8;
static_assert(static_cast<std::size_t>(FilterEdge::kCount) <= kWeightShift);

}  // namespace kernels
