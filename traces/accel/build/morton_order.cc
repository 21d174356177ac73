#include "traces/accel/build/morton_order.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <numeric>
#include <utility>

#include <glm/common.hpp>
#include <glm/vec3.hpp>

namespace traces {
namespace {

/// Returns x with two zero bits before each of its lowest 21 bits.
std::uint64_t spread_bits(std::uint64_t x) {
  x &= 0x1fffff;
  x = (x | x << 32) & 0x001f00000000ffff;
  x = (x | x << 16) & 0x001f0000ff0000ff;
  x = (x | x << 8) & 0x100f00f00f00f00f;
  x = (x | x << 4) & 0x10c30c30c30c30c3;
  x = (x | x << 2) & 0x1249249249249249;
  return x;
}

glm::dvec3 centre_of(const Bounds& b) { return 0.5 * (glm::dvec3(b.lower) + glm::dvec3(b.upper)); }

/// Returns the cell of `x` cells from the grid's corner; outside the grid, and for NaN, a cell at its end.
std::uint32_t cell_of(double x, std::uint32_t cells) {
  if (!(x > 0)) return 0;
  return x < cells ? static_cast<std::uint32_t>(x) : cells - 1;
}

}  // namespace

std::uint64_t morton_code(std::uint32_t x, std::uint32_t y, std::uint32_t z, std::uint32_t bits) {
  const std::uint64_t code = spread_bits(x) << 2 | spread_bits(y) << 1 | spread_bits(z);
  return code & ((std::uint64_t{1} << bits) - 1);
}

void sort_by_code(MortonOrder& order, std::uint32_t bits) {
  constexpr std::uint32_t kDigitBits = 8, kDigits = 1U << kDigitBits;
  MortonOrder sorted{std::vector<std::uint32_t>(order.items.size()), std::vector<std::uint64_t>(order.codes.size())};
  for (std::uint32_t shift = 0; shift < bits; shift += kDigitBits) {
    const auto digit_of = [&](std::uint64_t code) { return static_cast<std::size_t>(code >> shift) % kDigits; };
    std::array<std::uint32_t, kDigits> counts{}, next{};
    for (const std::uint64_t code : order.codes) ++counts[digit_of(code)];
    std::exclusive_scan(counts.begin(), counts.end(), next.begin(), 0U);
    for (std::size_t i = 0; i < order.codes.size(); ++i) {
      const std::uint32_t to = next[digit_of(order.codes[i])]++;
      sorted.codes[to] = order.codes[i];
      sorted.items[to] = order.items[i];
    }
    std::swap(order, sorted);
  }
}

MortonOrder morton_order(std::span<const Bounds> boxes, std::uint32_t bits) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  glm::dvec3 lower(kInfinity), upper(-kInfinity);
  for (const Bounds& box : boxes) {
    const glm::dvec3 centre = centre_of(box);
    lower = glm::min(lower, centre);
    upper = glm::max(upper, centre);
  }
  const std::uint32_t cells = 1U << (bits / 3);
  const glm::dvec3 size = upper - lower;
  const double extent = std::max({size.x, size.y, size.z});
  const double scale = extent > 0 ? cells / extent : 0;
  MortonOrder order{std::vector<std::uint32_t>(boxes.size()), std::vector<std::uint64_t>(boxes.size())};
  std::iota(order.items.begin(), order.items.end(), 0U);
  std::ranges::transform(boxes, order.codes.begin(), [&](const Bounds& box) {
    const glm::dvec3 at = (centre_of(box) - lower) * scale;
    return morton_code(cell_of(at.x, cells), cell_of(at.y, cells), cell_of(at.z, cells), bits);
  });
  sort_by_code(order, bits);
  return order;
}

}  // namespace traces
