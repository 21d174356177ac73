#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "shader_kernels/kernels/similarity.h"
#include "shader_kernels/kernels/subpixels.h"

namespace kernels {

/// Counts of the samples that a frame program had to render, and of those that it traced. A background sample's primary
/// ray hits nothing, or the sample lies between two such samples.
struct Sampling {
  std::uint64_t wanted = 0;
  std::uint64_t traced = 0;                             ///< includes halo and correction
  std::uint64_t halo = 0;                               ///< samples of neighbouring tiles that were traced again
  std::uint64_t correction = 0;                         ///< traced samples that had been interpolated
  std::uint64_t background = 0, traced_background = 0;  ///< background samples of `wanted`, of `traced`
  std::uint64_t checked = 0, passed = 0;                ///< samples between references
  std::array<std::uint64_t, static_cast<std::size_t>(Check::kCount)> failed{};  ///< a sample may fail several checks
  std::array<std::uint64_t, static_cast<std::size_t>(Check::kCount)> first_failed{};  ///< by the first failed check
  std::uint64_t rough = 0;  ///< passed samples that do not count for a tile's rate

  // supersample: pixels by their number of active sub-pixels; active sub-pixels by differing attributes (one may have
  // several) and by the first of them; empty entries in lists of sub-pixels.
  std::array<std::uint64_t, 5> active{};
  std::array<std::uint64_t, kAttributes> reasons{}, first_reasons{};
  std::uint64_t padding = 0;
  std::uint64_t propagated = 0;  ///< sub-pixels that rounds of propagation made active

  /// Per tile of the grid, row by row, if the program has it: share of checked samples that passed, and block side.
  std::vector<float> similar;
  std::vector<std::uint8_t> blocks;
  std::uint32_t tile_side = 0;  ///< in samples
  bool has_rates = false;       ///< block sides differ from tile to tile

  /// Adds the counts of a tile or frame, except the per-tile data.
  void add(const Sampling& other);
};

/// Mark of a sample: bits of failed checks (Check), and flags of its origin above them.
using SampleMark = std::uint16_t;
inline constexpr SampleMark kTracedMark = 1U << 12, kReferenceMark = 1U << 13, kCorrectedMark = 1U << 14;
static_assert(static_cast<std::size_t>(Check::kCount) <= 12);

// Mark of a pixel of supersample: bits of the attributes that differed at its active sub-pixels (Attribute), and above
// them the number of these sub-pixels.
inline constexpr std::uint32_t kActiveCountShift = kAttributes;
inline constexpr std::uint32_t active_of(SampleMark mark) { return (mark >> kActiveCountShift) & 7U; }
static_assert(kActiveCountShift + 3 <= 12);

/// Reasons why a filter of reconstruct rejects a shaded sample, for surfaces, mirrored light and refracted light.
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

// Mark of a pixel of reconstruct: bits of the edges found by its filters, and above them the remaining weight of all
// shaded samples, as a share of 255.
inline constexpr std::uint32_t kWeightShift = 8;
static_assert(static_cast<std::size_t>(FilterEdge::kCount) <= kWeightShift);

}  // namespace kernels
