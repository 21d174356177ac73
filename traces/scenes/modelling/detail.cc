#include "traces/scenes/modelling/detail.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "traces/scenes/modelling/shapes.h"

namespace traces {

std::uint32_t Detail::cell_count(double at_detail_1, std::uint32_t least) const {
  return std::max(static_cast<std::uint32_t>(share * at_detail_1 + 0.5), least);
}

std::uint32_t Detail::piece_count(double at_detail_1, std::uint32_t least) const {
  return std::max(static_cast<std::uint32_t>(share * share * at_detail_1 + 0.5), least);
}

std::vector<glm::vec2> Detail::coarser_profile(std::span<const glm::vec2> points) const {
  const std::size_t stride = share < 0.34 ? 3 : share < 0.5 ? 2 : 1;
  std::vector<glm::vec2> kept;
  for (std::size_t k = 0; k + 1 < points.size(); k += stride) kept.push_back(points[k]);
  kept.push_back(points.back());
  return kept;
}

Detail detail_for(double triangles, double at_detail_1) { return {std::sqrt(triangles / at_detail_1)}; }

Detail fit_detail(std::uint64_t wanted, const std::function<std::uint64_t(const Detail& detail)>& triangles_at,
                  const DetailSearch& search) {
  const std::uint64_t missing = std::max<std::uint64_t>(wanted - std::min(search.made, wanted), 1);
  Detail detail, best;
  double least_error = std::numeric_limits<double>::infinity();
  for (int k = 0; k < search.tries; ++k) {
    const double ratio = static_cast<double>(missing) / static_cast<double>(triangles_at(detail));
    const double error = std::max(ratio, 1 / ratio) - 1;
    if (error < least_error) least_error = error, best = detail;
    if (error < search.near_enough) break;
    detail.share = std::clamp(detail.share * std::sqrt(ratio), search.least, search.most);
  }
  return best;
}

Scene build_to_size(std::uint32_t triangles, const std::function<Scene(const Detail& detail)>& make) {
  Scene scene;
  Detail made;
  const auto triangles_at = [&](const Detail& detail) {
    made = detail;
    scene = make(detail);
    return count_triangles(scene);
  };
  const Detail best =
      fit_detail(triangles, triangles_at,
                 {.tries = 8, .near_enough = 0.03, .least = 0, .most = std::numeric_limits<double>::max()});
  return made.share == best.share ? scene : make(best);
}

}  // namespace traces
