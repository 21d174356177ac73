#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "shader_kernels/kernels/similarity.h"
#include "shader_kernels/kernels/subpixels.h"

namespace kernels {

/// Counts of the samples that a frame program renders, and of those that it traces. A background sample is one whose
/// primary ray hits nothing, or that is between two such samples.
struct Sampling {
  std::uint64_t wanted = 0;
  std::uint64_t traced = 0;      ///< all traced samples, including those of the halo and of corrections
  std::uint64_t halo = 0;        ///< traced samples that belong to neighbouring tiles
  std::uint64_t correction = 0;  ///< samples that were traced after they had been interpolated
  std::uint64_t background = 0, traced_background = 0;  ///< background samples among `wanted` and among `traced`
  std::uint64_t checked = 0, passed = 0;  ///< samples between references that were checked, and those that passed
  /// Number of samples that failed each similarity check; a sample may fail several.
  std::array<std::uint64_t, static_cast<std::size_t>(Check::kCount)> failed{};
  /// Number of failed samples, by the first similarity check that a sample failed.
  std::array<std::uint64_t, static_cast<std::size_t>(Check::kCount)> first_failed{};
  std::uint64_t rough = 0;  ///< samples that passed but count as failed when the tile's rate is chosen

  // Counts of the program supersample: pixels by their number of active sub-pixels; active sub-pixels by differing
  // attributes (one may have several) and by the first of them; empty entries in lists of sub-pixels.
  std::array<std::uint64_t, 5> active{};
  std::array<std::uint64_t, kAttributes> reasons{}, first_reasons{};
  std::uint64_t padding = 0;
  std::uint64_t propagated = 0;  ///< sub-pixels that became active in rounds of propagation

  /// For each tile of the grid, row by row, the fraction of checked samples that passed. Empty if there are no checks.
  std::vector<float> similar;
  std::vector<std::uint8_t> blocks;
  std::uint32_t tile_side = 0;  ///< length of a tile's side in samples
  bool has_rates = false;       ///< the block sides in `blocks` may differ from tile to tile

  /// Calls count(name, member...) for each count, with this member of each object in `s`. The names are those of trace
  /// files.
  static constexpr void describe(auto&& count, auto&... s) {
    count("wanted", s.wanted...);
    count("traced", s.traced...);
    count("halo", s.halo...);
    count("correction", s.correction...);
    count("background", s.background...);
    count("traced_background", s.traced_background...);
    count("checked", s.checked...);
    count("passed", s.passed...);
    count("failed", s.failed...);
    count("first_failed", s.first_failed...);
    count("rough", s.rough...);
    count("active", s.active...);
    count("reasons", s.reasons...);
    count("first_reasons", s.first_reasons...);
    count("padding", s.padding...);
    count("propagated", s.propagated...);
  }
  /// Adds the counts of a tile or frame, except the counts that are kept per tile.
  void add(const Sampling& other) {
    const auto add_count = [](const char*, auto& sum, const auto& added) {
      if constexpr (requires { sum.size(); }) {
        for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += added[i];
      } else {
        sum += added;
      }
    };
    describe(add_count, *this, other);
  }
};

/// Mark of a sample in debug pictures: bits of the failed checks (Check), and above them how its colour was computed.
using SampleMark = std::uint16_t;
inline constexpr SampleMark kTracedMark = 1U << 12, kReferenceMark = 1U << 13, kCorrectedMark = 1U << 14;
static_assert(static_cast<std::size_t>(Check::kCount) <= 12);

// Mark of a pixel of the program supersample in debug pictures: bits of the attributes that differed at its active
// sub-pixels (Attribute), and above them the number of these sub-pixels.
inline constexpr std::uint32_t kActiveCountShift = kAttributes;
inline constexpr std::uint32_t active_subpixel_count(SampleMark mark) { return (mark >> kActiveCountShift) & 7U; }
static_assert(kActiveCountShift + 3 <= 12);

/// Why a filter of the program reconstruct rejected a shaded sample, for surfaces, mirrored light and refracted light.
enum class FilterEdge : std::uint8_t {
  kDepth,
  kNormal,
  kShadow,
  kReflection,  ///< the hit after a mirror differs in depth or normal
  kReflectedShadow,
  kRefraction,
  kRefractedShadow,
  kCount
};
constexpr std::array<std::string_view, static_cast<std::size_t>(FilterEdge::kCount)> names_of(FilterEdge) {
  return {"depth", "normal", "shadow", "reflection", "reflected-shadow", "refraction", "refracted-shadow"};
}

// Mark of a pixel of the program reconstruct in debug pictures: bits of the edges found by its filters (FilterEdge),
// and above them the weight of all shaded samples that remained, as a fraction of 255.
inline constexpr std::uint32_t kWeightShift = 8;
static_assert(static_cast<std::size_t>(FilterEdge::kCount) <= kWeightShift);

}  // namespace kernels
