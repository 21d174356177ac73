#include "traces/accel/bvh_tracer.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cstdint>
#include <limits>
#include <type_traits>

#include "traces/accel/build/two_level.h"
#include "traces/accel/ray_tests.h"
#include "traces/ray.h"
#include "traces/walk.h"

namespace traces {

/// Appends words of canonical walks to a WalkSink, through a small buffer so that a step costs one store.
class WalkRecorder {
 public:
  explicit WalkRecorder(WalkSink& sink) : sink_(sink) {}
  WalkRecorder(const WalkRecorder&) = delete;
  WalkRecorder& operator=(const WalkRecorder&) = delete;

  void begin_ray() { sink_.begin.push_back(static_cast<std::uint32_t>(sink_.words.size() + used_)); }
  /// Flushes the buffer of walk words if it is nearly full. Call before each step, which writes at most kStepWords
  /// words.
  void make_room() {
    if (used_ + kStepWords > buffer_.size()) flush();
  }
  void write_word(std::uint32_t word) { buffer_[used_++] = word; }
  /// Replaces the first word of the ray begun last.
  void replace_first_word(std::uint32_t word) {
    const std::size_t at = sink_.begin.back(), flushed = sink_.words.size();
    (at < flushed ? sink_.words[at] : buffer_[at - flushed]) = word;
  }
  /// Flushes the buffer of walk words. Call after the last ray; a destructor could not throw if memory runs out.
  void finish() { flush(); }

  static constexpr std::size_t kStepWords = 4;

 private:
  void flush() {
    sink_.words.insert(sink_.words.end(), buffer_.begin(), buffer_.begin() + static_cast<std::ptrdiff_t>(used_));
    used_ = 0;
  }

  WalkSink& sink_;
  std::size_t used_ = 0;
  std::array<std::uint32_t, 4096> buffer_;
};

/// Replaces WalkRecorder if no walks of rays are recorded; discards all words.
struct NoWalkRecorder {
  void begin_ray() {}
  void make_room() {}
  void write_word(std::uint32_t) {}
  void finish() {}
};

namespace {

constexpr std::size_t kStackSize = 128;  // entries; deeper than any tree that BvhConfig allows
/// Stack entries in wide trees: a wide tree is no deeper than the binary tree that it is collapsed from.
constexpr std::size_t kWideStackSize = (kMaxWidth - 1) * kStackSize;

/// Returns the phases in which four triangle tests ended, given which lanes passed the distance test and which hit.
constexpr std::uint32_t exit_phases(unsigned in_range, unsigned hit) {
  constexpr std::array<std::uint16_t, 16> kBand = {0x0000, 0x0001, 0x0010, 0x0011, 0x0100, 0x0101, 0x0110, 0x0111,
                                                   0x1000, 0x1001, 0x1010, 0x1011, 0x1100, 0x1101, 0x1110, 0x1111};
  return 0x1111U + kBand[in_range] + kBand[hit];
}

/// An empty type that replaces the ray in world space for a one-level BVH.
struct Nothing {
  explicit Nothing(const auto&) {}
};

/// The traversal of the BVH by one ray. `kSlots`: the slots of a wide node that can have a child, or 0 for a binary
/// tree. `kTwoLevels`: the BVH has two levels.
template <class Lanes, bool kAnyHit, bool kTwoLevels, std::uint32_t kSlots, class Record>
class Walk {
  static constexpr bool kWide = kSlots != 0;
  using Boxes = std::conditional_t<kWide, RayWideBoxes<BoxLanes<Lanes, kSlots>>, RayBoxes<Lanes>>;

 public:
  Walk(const MemoryImage& image, bool is_single_sided, const Ray& ray, Record& record)
      : image_(image),
        ray_(ray),
        record_(record),
        boxes_(image.grid ? BoxRay(ray, image.lower, image.upper, *image.grid) : BoxRay(ray, image.lower, image.upper)),
        triangles_(ray),
        world_(boxes_),
        is_single_sided_(is_single_sided),
        t_min_(ray.t_min),
        limit_(std::min(ray.t_max, std::numeric_limits<float>::max())) {}

  Hit run() {
    traverse(0);
    return end_walk();
  }
  /// Does what run() does, but first visits the subtree of node `predicted`. Returns in `correct` whether an opaque
  /// triangle in that subtree blocks the ray.
  Hit run_from(std::uint32_t predicted, bool& correct) {
    opaque_only_ = true;
    correct = traverse(predicted);
    opaque_only_ = false;
    return correct ? end_walk() : run();
  }

 private:
  /// Visits the subtree of a link. Returns true if a hit ends the walk of an any-hit ray.
  bool traverse(std::uint32_t link) {
    do {
      record_.make_room();
      if (kTwoLevels && is_instance(link)) {
        link = enter_instance(link_instance(link));
      } else if (is_leaf(link)) {
        if (enter_leaf(link)) return true;
        link = pop_entry();
      } else {
        link = visit_node(link);
      }
    } while (link != kNoChild);
    return false;
  }

  Hit end_walk() {
    record_.write_word(end_step(hit_.is_hit()));
    if (hit_.is_hit()) hit_.triangle |= image_.triangles[hit_.triangle].hit_flags();
    return kTwoLevels && hit_.is_hit() ? with_instance(hit_, hit_instance_) : hit_;
  }

  struct Entry {
    std::uint32_t link;
    float enter;
  };

  /// Transforms the ray into the space of an instance and returns the root of the instance's tree. Boxes of the root
  /// determine the rounding margin of box tests.
  std::uint32_t enter_instance(std::uint32_t instance) {
    record_.write_word(instance_step(instance));
    const InstanceRecord& record = image_.instances[instance];
    const Bounds root = tree_bounds(image_, record.root);
    const Ray ray = to_object_space(record, ray_);
    boxes_ = Boxes(BoxRay(ray, root.lower, root.upper));
    triangles_ = RayTriangles<Lanes>(ray);
    instance_ = instance;
    floor_ = depth_;
    return record.root;
  }

  /// Tests the boxes of all children of a node and returns the link to visit next.
  std::uint32_t visit_node(std::uint32_t index) {
    if constexpr (kWide) {
      return visit_wide_node(index);
    } else {
      return visit_binary_node(index);
    }
  }

  std::uint32_t visit_wide_node(std::uint32_t index) {
    const WideNode& node = image_.wide_nodes[index];
    alignas(32) float enter[kMaxWidth];
    const unsigned mask = boxes_.template entry_distances<kSlots>(node, t_min_, limit_, enter);
    record_.write_word(wide_step(index));
    if (mask == 0) {
      record_.write_word(0);
      return pop_entry();
    }
    const auto first = static_cast<std::uint32_t>(std::countr_zero(mask));
    const unsigned others = mask & (mask - 1);
    if (others == 0) {
      record_.write_word(wide_hits(mask, first));
      return node.child[first];
    }
    return order_children(node, enter, mask, first, others);
  }

  /// Sorts the hit children (ChildOrder). Pushes all but the first, the last first, and returns the first.
  std::uint32_t order_children(const WideNode& node, const float* enter, unsigned mask, std::uint32_t first,
                               unsigned others) {
    std::uint32_t slots[kMaxWidth] = {first};
    std::uint32_t count = 1;
    if (image_.child_order != ChildOrder::kSort)
      return push_children(node, enter, mask, slots, order_by_slot(enter, mask, slots));
    for (; others != 0; others &= others - 1) {
      const auto slot = static_cast<std::uint32_t>(std::countr_zero(others));
      std::uint32_t at = count++;
      for (; at != 0 && enter[slot] < enter[slots[at - 1]]; --at) slots[at] = slots[at - 1];
      slots[at] = slot;
    }
    return push_children(node, enter, mask, slots, count);
  }

  /// Writes the slots of the hit children in an order that does not sort by distance, and returns their number.
  std::uint32_t order_by_slot(const float* enter, unsigned mask, std::uint32_t* slots) const {
    std::uint32_t count = 0;
    if (image_.child_order == ChildOrder::kOctant) {
      // A slot's octant is that of the ray that enters its child last.
      const std::uint32_t opposite = boxes_.octant() ^ (kMaxWidth - 1);
      for (std::uint32_t i = 0; i < kMaxWidth; ++i) {
        if ((mask >> (i ^ opposite) & 1U) != 0) slots[count++] = i ^ opposite;
      }
      return count;
    }
    for (unsigned left = mask; left != 0; left &= left - 1) {
      slots[count++] = static_cast<std::uint32_t>(std::countr_zero(left));
    }
    const auto nearer = [&](std::uint32_t a, std::uint32_t b) { return enter[a] < enter[b]; };
    std::uint32_t* const nearest = std::min_element(slots, slots + count, nearer);
    std::rotate(slots, nearest, nearest + 1);
    return count;
  }

  std::uint32_t push_children(const WideNode& node, const float* enter, unsigned mask, const std::uint32_t* slots,
                              std::uint32_t count) {
    std::uint32_t order = 0;
    for (std::uint32_t i = count; i-- > 1;) {
      order |= slots[i] << (kSlotBits * i);
      stack_[depth_++] = {node.child[slots[i]], enter[slots[i]]};
    }
    record_.write_word(wide_hits(mask, order | slots[0]));
    return node.child[slots[0]];
  }

  std::uint32_t visit_binary_node(std::uint32_t index) {
    const NodeRecord& node = image_.nodes[index];
    unsigned hits = 0;
    const Lanes enter = boxes_.entry_distances(node, RayBoxes<Lanes>::distance_limits(t_min_, limit_), hits);
    if (hits == 3) {
      const float first = enter.lane_0(), second = enter.lane_1();
      const std::uint32_t near = second < first ? 1 : 0;
      record_.write_word(visit_step(index, hits, near));
      stack_[depth_++] = {node.child[1 - near], std::max(first, second)};
      return node.child[near];
    }
    record_.write_word(visit_step(index, hits, 0));
    return hits == 0 ? pop_entry() : node.child[hits >> 1];
  }

  std::uint32_t pop_entry() {
    std::uint32_t culled = 0;
    std::uint32_t link = kNoChild;
    while (depth_ != 0) {
      const Entry& top = stack_[--depth_];
      if (top.enter <= limit_) {
        link = top.link;
        break;
      }
      ++culled;
    }
    if (culled != 0) record_.write_word(cull_step(culled));
    if constexpr (kTwoLevels) {
      if (depth_ < floor_) {  // the entry was pushed before the ray entered the instance
        boxes_ = world_;
        instance_ = kNone;
        floor_ = 0;
      }
    }
    return link;
  }

  /// Tests the triangles of a leaf. Returns true if a hit ends the walk of an any-hit ray.
  bool enter_leaf(std::uint32_t link) {
    const std::uint32_t first = leaf_first(link);
    const std::uint32_t count = leaf_count(link);
    std::uint32_t tested = 0, phases = 0;
    bool ends = false;
    while (tested < count && !ends) {
      const std::uint32_t group = std::min(count - tested, 4U);
      std::uint32_t done = group;
      const std::uint32_t exits = test_group(first + tested, done, ends);
      phases |= (exits & (0xffffU >> (16 - 4 * done))) << (4 * tested);
      tested += done;
    }
    record_.write_word(leaf_step(first, tested));
    record_.write_word(phases);
    return ends;
  }

  /// Tests `count` triangles and returns their exit phases. If an opaque triangle (without flags) blocks an any-hit
  /// ray, sets `ends` and reduces `count` to the triangles up to that one.
  std::uint32_t test_group(std::uint32_t first, std::uint32_t& count, bool& ends) {
    const auto result = triangles_.test_triangles(&image_.triangles[first], count);
    const unsigned lanes = (1U << count) - 1;
    unsigned reached = less_equal_mask(Lanes::from_float(t_min_), result.t) & lanes;
    if (is_single_sided_) reached &= ~result.culled_mask(&image_.triangles[first], count);
    unsigned in_range = reached & less_equal_mask(result.t, Lanes::from_float(limit_));
    if (in_range == 0) return exit_phases(0, 0);
    const unsigned inside = result.inside_mask();
    unsigned hits = in_range & inside;
    if (hits == 0) return exit_phases(in_range, 0);

    // A hit shortens the ray for the triangles that follow in the leaf.
    for (unsigned lane = 0; lane < count; ++lane) {
      if (((hits >> lane) & 1U) == 0) continue;
      if (kAnyHit && image_.triangles[first + lane].hit_flags() == 0) {
        hit_ = Hit{};  // drops a flagged candidate at the same distance
        accept_hit(result, lane, first + lane);
        count = lane + 1;
        ends = true;
        break;
      }
      if (kAnyHit && opaque_only_) continue;
      accept_hit(result, lane, first + lane);
      const unsigned earlier = (2U << lane) - 1;
      in_range = (in_range & earlier) | (reached & less_equal_mask(result.t, Lanes::from_float(limit_)) & ~earlier);
      hits = in_range & inside;
    }
    return exit_phases(in_range, hits);
  }

  void accept_hit(const typename RayTriangles<Lanes>::Result& result, unsigned lane, std::uint32_t triangle) {
    alignas(16) float t[4], u[4], v[4], sum[4];
    result.t.store(t);
    if (hit_.is_hit() && t[lane] == hit_.t && loses_tie(triangle)) return;
    result.u.store(u);
    result.v.store(v);
    result.sum.store(sum);
    const float weight_u = std::clamp(u[lane] / sum[lane], 0.0F, 1.0F);
    hit_ = {t[lane], weight_u, std::clamp(v[lane] / sum[lane], 0.0F, 1 - weight_u), triangle};
    limit_ = hit_.t;
    if constexpr (kTwoLevels) hit_instance_ = instance_;
  }

  /// True if a hit of `triangle` is ignored: it is as far away as the current hit, whose triangle has the lower
  /// `source`.
  bool loses_tie(std::uint32_t triangle) const {
    if (kTwoLevels && instance_ != hit_instance_) return instance_ > hit_instance_;
    return image_.triangles[triangle].source > image_.triangles[hit_.triangle].source;
  }

  const MemoryImage& image_;
  const Ray& ray_;
  Record& record_;
  Boxes boxes_;
  RayTriangles<Lanes> triangles_;
  /// The ray in world space, stored because `boxes_` may have the ray in the space of an instance.
  [[no_unique_address]] const std::conditional_t<kTwoLevels, Boxes, Nothing> world_;
  std::uint32_t instance_ = kNone;  ///< instance into whose space the ray is transformed, or kNone
  std::uint32_t hit_instance_ = kNone;
  std::size_t floor_ = 0;       ///< number of stack entries when the ray entered the instance
  const bool is_single_sided_;  ///< some triangles of the image are single-sided
  bool opaque_only_ = false;    ///< hits of triangles with flags are ignored
  const float t_min_;
  float limit_;  ///< end of the ray: t_max, or the distance of the hit found so far
  Hit hit_;
  std::size_t depth_ = 0;
  std::array<Entry, (kTwoLevels ? 2 : 1) * (kWide ? kWideStackSize : kStackSize)> stack_;
};

template <class Lanes, bool kAnyHit, bool kTwoLevels, std::uint32_t kSlots, class Record>
void trace_all(const MemoryImage& image, std::span<const Ray> rays, std::span<Hit> hits, Record&& record) {
  const bool is_single_sided = image.has_single_sided();
  for (std::size_t i = 0; i < rays.size(); ++i) {
    record.begin_ray();
    record.make_room();
    hits[i] = Walk<Lanes, kAnyHit, kTwoLevels, kSlots, std::remove_reference_t<Record>>(image, is_single_sided, rays[i],
                                                                                        record)
                  .run();
  }
}

/// Traces shadow rays with look-ups of predicted nodes, in a tree of one level.
template <class Lanes, std::uint32_t kSlots>
void trace_predicted(const MemoryImage& image, std::span<const Ray> rays, std::span<Hit> hits, WalkRecorder& record,
                     TilePredictions& tile) {
  const bool is_single_sided = image.has_single_sided();
  for (std::size_t i = 0; i < rays.size(); ++i) {
    record.begin_ray();
    record.make_room();
    record.write_word(0);  // replaced below
    const std::uint32_t hash = tile.predictor().hash_of(rays[i]), node = tile.look_up(hash);
    Walk<Lanes, true, false, kSlots, WalkRecorder> walk(image, is_single_sided, rays[i], record);
    bool correct = false, stored = false;
    hits[i] = node == kNone ? walk.run() : walk.run_from(node, correct);
    if (hits[i].is_hit() && !hits[i].is_flagged() && !correct) {
      const std::uint32_t above = tile.predictor().node_to_store(hits[i].triangle_index());
      stored = above != kNone;
      if (stored) tile.add_update({hash, above});
    }
    record.replace_first_word(look_up_step(node == kNone ? kNoPrediction : node, correct, stored));
  }
  record.finish();
}

template <class Lanes>
void trace_predicted(const MemoryImage& image, std::span<const Ray> rays, std::span<Hit> hits, WalkSink& walk) {
  WalkRecorder record(walk);
  if (!image.is_wide()) {
    trace_predicted<Lanes, 0>(image, rays, hits, record, *walk.predictions);
  } else if (image.wide_slots() <= 4) {
    trace_predicted<Lanes, 4>(image, rays, hits, record, *walk.predictions);
  } else {
    trace_predicted<Lanes, kMaxWidth>(image, rays, hits, record, *walk.predictions);
  }
}

/// Calls `f` with a template argument for a truth value that is known only at run time.
void with_constant(bool value, auto&& f) { value ? f(std::true_type{}) : f(std::false_type{}); }

template <class Lanes>
void trace_with(const MemoryImage& image, std::span<const Ray> rays, bool any, std::span<Hit> hits, WalkSink* walk) {
  const auto with = [&](auto&& record) {
    with_constant(any, [&](auto any_hit) {
      with_constant(image.has_two_levels(), [&](auto levels) {
        if (!image.is_wide()) {
          trace_all<Lanes, any_hit.value, levels.value, 0>(image, rays, hits, record);
        } else if (image.wide_slots() <= 4) {
          trace_all<Lanes, any_hit.value, levels.value, 4>(image, rays, hits, record);
        } else {
          trace_all<Lanes, any_hit.value, levels.value, kMaxWidth>(image, rays, hits, record);
        }
      });
    });
    record.finish();
  };
  walk != nullptr ? with(WalkRecorder(*walk)) : with(NoWalkRecorder{});
}

}  // namespace

BvhTracer::BvhTracer(const MemoryImage& image, Arithmetic arithmetic) : image_(image), arithmetic_(arithmetic) {
  assert(image.node_count() != 0);
}

BvhTracer::BvhTracer(const MemoryImage& image, const PredictorConfig& predictor) : BvhTracer(image) {
  if (predictor.enabled) predictor_.emplace(image, predictor);
}

void BvhTracer::trace(std::span<const Ray> rays, RayKind kind, std::span<Hit> hits, WalkSink* walk) const {
  assert(hits.size() == rays.size());
  const bool any = kind == RayKind::kShadow;
  if (any && walk != nullptr && walk->predictions != nullptr) {
    arithmetic_ == Arithmetic::kNative ? trace_predicted<NativeLanes>(image_, rays, hits, *walk)
                                       : trace_predicted<PortableLanes>(image_, rays, hits, *walk);
    return;
  }
  if (arithmetic_ == Arithmetic::kNative) {
    trace_with<NativeLanes>(image_, rays, any, hits, walk);
  } else {
    trace_with<PortableLanes>(image_, rays, any, hits, walk);
  }
}

}  // namespace traces
