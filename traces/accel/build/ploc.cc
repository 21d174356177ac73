#include "traces/accel/build/ploc.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <utility>

#include "traces/accel/build/morton_order.h"

namespace traces {
namespace {

/// The clusters of a round, in Morton order. Planes are in arrays of their own, so that the search is vectorised.
template <std::uint32_t kRadius>
class PlocRounds {
 public:
  explicit PlocRounds(BinaryTree& tree) : tree_(tree), count_(static_cast<std::uint32_t>(tree.items.size())) {
    // The search reads up to kRadius positions after the last cluster and ignores them.
    for (std::vector<float>& plane : planes_) plane.resize(count_ + kRadius);
    links_.resize(count_);
    partners_.resize(count_);
    for (std::uint32_t i = 0; i < count_; ++i) set_cluster(i, leaf_link(i, 1));
  }

  std::uint32_t count() const { return count_; }

  void run_round() {
    for (std::uint32_t first = 0; first < count_; first += kBlock) {
      find_partners(first, std::min(count_, first + kBlock));
    }
    if (count_ >= kFewClusters && count_pairs() * kMostPerPair < count_) {
      for (std::uint32_t i = 0; i < count_; ++i) partners_[i] = std::min(i ^ 1U, count_ - 1);
    }
    merge_pairs();
  }

 private:
  static constexpr std::uint32_t kBlock = 512;        ///< clusters whose areas are in the first-level cache at once
  static constexpr std::uint32_t kMostPerPair = 64;   ///< most clusters per merged pair in a round
  static constexpr std::uint32_t kFewClusters = 256;  ///< below this number a round may merge any number of pairs
  using Areas = std::array<float, kRadius>;           ///< areas with the next clusters; at d - 1: d positions away

  void set_cluster(std::uint32_t i, std::uint32_t link) {
    const Bounds& box = tree_.box_of(link);
    for (int axis = 0; axis < 3; ++axis) {
      planes_[2 * static_cast<std::size_t>(axis)][i] = box.lower[axis];
      planes_[2 * static_cast<std::size_t>(axis) + 1][i] = box.upper[axis];
    }
    links_[i] = link;
  }

  /// Computes half the areas of the boxes that hold cluster `i` and each of the next ones.
  void find_areas(std::uint32_t i, Areas& areas) const {
    const auto size_along = [&](std::size_t axis, std::uint32_t d) {
      const float* lower = planes_[2 * axis].data() + i;
      const float* upper = planes_[2 * axis + 1].data() + i;
      return std::max(upper[0], upper[d]) - std::min(lower[0], lower[d]);
    };
    for (std::uint32_t d = 1; d <= kRadius; ++d) {
      const float x = size_along(0, d), y = size_along(1, d), z = size_along(2, d);
      // A finite value also for areas that overflow or are not a number.
      areas[d - 1] = std::min(std::numeric_limits<float>::max(), x * y + y * z + z * x);
    }
  }

  /// Sets the partners of clusters [first, end).
  void find_partners(std::uint32_t first, std::uint32_t end) {
    const std::uint32_t begin = first - std::min(first, kRadius);
    std::array<Areas, kBlock + kRadius> areas;
    for (std::uint32_t i = begin; i < end; ++i) find_areas(i, areas[i - begin]);
    for (std::uint32_t i = first; i < end; ++i) {
      float least = std::numeric_limits<float>::infinity();
      std::uint32_t partner = i;
      const auto offer = [&](std::uint32_t earlier, std::uint32_t d, std::uint32_t other) {
        const float area = areas[earlier - begin][d - 1];
        if (area < least) {
          least = area;
          partner = other;
        }
      };
      for (std::uint32_t d = 1; d <= kRadius; ++d) {
        const bool has_before = d <= i, has_after = i + d < count_;
        const bool after_is_first = d % 2 == 1 && i % 2 == 0;
        if (has_after && after_is_first) offer(i, d, i + d);
        if (has_before) offer(i - d, d, i - d);
        if (has_after && !after_is_first) offer(i, d, i + d);
      }
      partners_[i] = partner;
    }
  }

  bool is_first_of_pair(std::uint32_t i) const { return i < partners_[i] && partners_[partners_[i]] == i; }
  bool is_second_of_pair(std::uint32_t i) const { return partners_[i] < i && partners_[partners_[i]] == i; }

  std::uint32_t count_pairs() const {
    std::uint32_t pairs = 0;
    for (std::uint32_t i = 0; i < count_; ++i) pairs += is_first_of_pair(i) ? 1 : 0;
    return pairs;
  }

  void merge_pairs() {
    std::uint32_t to = 0;
    for (std::uint32_t i = 0; i < count_; ++i) {
      if (is_second_of_pair(i)) continue;
      std::uint32_t link = links_[i];
      if (is_first_of_pair(i)) {
        tree_.add_parent(link, links_[partners_[i]]);
        link = static_cast<std::uint32_t>(tree_.nodes.size()) - 1;
      }
      set_cluster(to++, link);
    }
    count_ = to;
  }

  BinaryTree& tree_;
  std::uint32_t count_;
  std::array<std::vector<float>, 6> planes_;  ///< lower and upper planes of x, y, z
  std::vector<std::uint32_t> links_;          ///< link word of each cluster's subtree
  std::vector<std::uint32_t> partners_;       ///< the cluster that each cluster has found
};

template <std::uint32_t kRadius>
void run_rounds(BinaryTree& tree, sim::Stop stop, std::vector<std::uint32_t>& clusters) {
  PlocRounds<kRadius> rounds(tree);
  while (rounds.count() > 1) {
    if (stop != nullptr && stop()) throw sim::Cancelled{};
    clusters.push_back(rounds.count());
    rounds.run_round();
  }
}

}  // namespace

BinaryTree build_ploc(std::span<const Bounds> boxes, const BvhConfig& config, sim::Stop stop,
                      std::vector<std::uint32_t>& clusters) {
  BinaryTree tree;
  tree.items = morton_order(boxes, config.morton_bits).items;
  tree.boxes.reserve(boxes.size());
  for (const std::uint32_t item : tree.items) tree.boxes.push_back(boxes[item]);
  tree.nodes.reserve(boxes.size());
  config.ploc_radius == 8 ? run_rounds<8>(tree, stop, clusters) : run_rounds<16>(tree, stop, clusters);
  return tree;
}

}  // namespace traces
