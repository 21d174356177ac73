#include "traces/accel/ray_predictor.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <utility>

namespace traces {
namespace {

/// Returns the number of the sector of a direction's angle to the y axis, 0 to 7, each of 22.5 degrees. Comparisons of
/// squares replace the arc cosine, whose last bits differ between C libraries.
std::uint32_t polar_sector(const glm::vec3& d) {
  // Squared cosines of 22.5, 45 and 67.5 degrees.
  constexpr float k22 = 0.85355339F, k45 = 0.5F, k67 = 0.14644661F;
  const float y2 = d.y * d.y, length2 = d.x * d.x + y2 + d.z * d.z;
  const std::uint32_t off_axis = static_cast<std::uint32_t>(y2 < k22 * length2) +
                                 static_cast<std::uint32_t>(y2 < k45 * length2) +
                                 static_cast<std::uint32_t>(y2 < k67 * length2);
  return d.y < 0 ? 7 - off_axis : off_axis;
}

/// Returns the number of the sector of a direction around the y axis, 0 to 15, each of 22.5 degrees.
std::uint32_t azimuth_sector(const glm::vec3& d) {
  constexpr float kTan22 = 0.41421356F, kTan67 = 2.4142136F;
  const std::uint32_t quadrant = d.z < 0 ? (d.x < 0 ? 2 : 3) : (d.x < 0 ? 1 : 0);
  float u = std::abs(d.x), v = std::abs(d.z);
  if (quadrant % 2 == 1) std::swap(u, v);
  return 4 * quadrant + static_cast<std::uint32_t>(v > kTan22 * u) + static_cast<std::uint32_t>(v > u) +
         static_cast<std::uint32_t>(v > kTan67 * u);
}

constexpr std::uint32_t kAzimuthBits = 4;

}  // namespace

RayPredictor::RayPredictor(const MemoryImage& image, const PredictorConfig& config)
    : config_(config), lower_(image.lower), parents_(parent_indices(image)), leaf_parents_(image.triangles.size()) {
  assert(!image.has_two_levels());
  const glm::vec3 extent = image.upper - image.lower;
  const auto cells = static_cast<float>(1U << config.origin_bits);
  for (int axis = 0; axis < 3; ++axis) cells_per_unit_[axis] = extent[axis] > 0 ? cells / extent[axis] : 0;
  for (std::uint32_t node = 0; node < image.node_count(); ++node) {
    for (const std::uint32_t link : image.links_of(node)) {
      if (is_leaf(link)) std::fill_n(leaf_parents_.begin() + leaf_first(link), leaf_count(link), node);
    }
  }
}

std::uint32_t RayPredictor::hash_of(const Ray& ray) const {
  std::uint32_t cell = 0;
  for (int axis = 2; axis >= 0; --axis) {
    const float at = (ray.origin[axis] - lower_[axis]) * cells_per_unit_[axis];
    const auto last = static_cast<float>((1U << config_.origin_bits) - 1);
    cell = cell << config_.origin_bits | static_cast<std::uint32_t>(at > 0 ? std::min(at, last) : 0);
  }
  return cell ^ (polar_sector(ray.direction) << kAzimuthBits | azimuth_sector(ray.direction));
}

std::uint32_t RayPredictor::node_to_store(std::uint32_t triangle) const {
  std::uint32_t node = leaf_parents_[triangle];
  if (node == 0) return kNone;
  for (std::uint32_t level = 1; level < config_.go_up && parents_[node] != 0; ++level) node = parents_[node];
  return node;
}

PredictorTable::PredictorTable(const PredictorConfig& config)
    : ways_(config.ways),
      set_bits_(static_cast<std::uint32_t>(std::countr_zero(config.entries / config.ways))),
      entries_(config.entries, PredictorUpdate{0, kNone}) {}

std::size_t PredictorTable::set_of(std::uint32_t hash) const {
  std::uint32_t set = 0;
  for (; set_bits_ != 0 && hash != 0; hash >>= set_bits_) set ^= hash & ((1U << set_bits_) - 1);
  return std::size_t{set} * ways_;
}

std::uint32_t PredictorTable::find_node(std::uint32_t hash) const {
  const std::size_t first = set_of(hash);
  for (std::size_t i = first; i < first + ways_; ++i) {
    if (entries_[i].hash == hash && entries_[i].node != kNone) return entries_[i].node;
  }
  return kNone;
}

void PredictorTable::apply_update(const PredictorUpdate& update) {
  const auto first = entries_.begin() + static_cast<std::ptrdiff_t>(set_of(update.hash));
  const auto last = first + static_cast<std::ptrdiff_t>(ways_ - 1);
  const auto replaced = std::find_if(
      first, last, [&](const PredictorUpdate& entry) { return entry.hash == update.hash && entry.node != kNone; });
  const std::uint32_t node = update.node == kNone ? find_node(update.hash) : update.node;
  if (node == kNone) return;
  std::move_backward(first, replaced, replaced + 1);
  *first = {update.hash, node};
}

std::uint32_t TilePredictions::look_up(std::uint32_t hash) {
  rays_ += 1;
  while (visible_ < updates_.size() && updating_rays_[visible_] + ray_lag_ <= rays_) {
    const PredictorUpdate& update = updates_[visible_++];
    if (update.node != kNone) table_.apply_update(update);
  }
  const std::uint32_t node = table_.find_node(hash);
  if (node != kNone) {
    table_.apply_update({hash, kNone});
    add_update({hash, kNone});
  }
  return node;
}

void TilePredictions::add_update(const PredictorUpdate& update) {
  updates_.push_back(update);
  updating_rays_.push_back(rays_);
}

PredictorHistory::PredictorHistory(const RayPredictor& predictor)
    : lag_(predictor.config().lag), versions_(lag_, PredictorTable(predictor.config())) {}

const PredictorTable& PredictorHistory::table_of(std::uint32_t tile) const {
  assert(tile >= committed_ && tile < end_of_startable());
  const std::uint32_t version = tile < lag_ ? 0 : tile - lag_ + 1;
  return versions_[version % lag_];
}

void PredictorHistory::commit_tile(std::span<const PredictorUpdate> updates) {
  PredictorTable& next = versions_[(committed_ + 1) % lag_];
  if (lag_ > 1) next = versions_[committed_ % lag_];
  for (const PredictorUpdate& update : updates) next.apply_update(update);
  committed_ += 1;
}

}  // namespace traces
