#include "traces/scenes/detail.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "traces/scenes/shapes.h"

namespace traces {

std::uint32_t Detail::cells(std::uint32_t at_one, std::uint32_t least) const {
  return std::max(static_cast<std::uint32_t>(share * static_cast<float>(at_one) + 0.5F), least);
}

std::uint32_t Detail::pieces(std::uint32_t at_one, std::uint32_t least) const {
  return std::max(static_cast<std::uint32_t>(share * share * static_cast<float>(at_one) + 0.5F), least);
}

std::vector<glm::vec2> Detail::profile(std::span<const glm::vec2> points) const {
  const std::size_t stride = share < 0.34F ? 3 : share < 0.5F ? 2 : 1;
  std::vector<glm::vec2> kept;
  for (std::size_t k = 0; k + 1 < points.size(); k += stride) kept.push_back(points[k]);
  kept.push_back(points.back());
  return kept;
}

Scene build_to_size(std::uint32_t triangles, const std::function<Scene(const Detail& detail)>& make) {
  constexpr int kTries = 8;
  constexpr double kNear = 0.03;
  Detail detail;
  Scene best;
  double best_miss = 0;
  for (int k = 0; k < kTries; ++k) {
    Scene scene = make(detail);
    const double ratio = static_cast<double>(triangles) / static_cast<double>(triangles_of(scene));
    const double miss = std::max(ratio, 1 / ratio) - 1;
    if (k == 0 || miss < best_miss) {
      best = std::move(scene);
      best_miss = miss;
    }
    if (best_miss < kNear) break;
    detail.share *= static_cast<float>(std::sqrt(ratio));
  }
  return best;
}

}  // namespace traces
