#include "traces/accel/bvh_tracer.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <limits>

#include "traces/accel/box_test.h"
#include "traces/accel/lanes.h"
#include "traces/accel/recorder.h"
#include "traces/accel/triangle_test.h"
#include "traces/walk.h"

namespace traces {
namespace {

constexpr std::size_t kStackSize = 128;  // deeper than BvhConfig lets a tree become

/// The four exit phases of a group of tests, given which pass the distance test and which pass both.
constexpr std::uint32_t phases_of(unsigned in_range, unsigned hit) {
  constexpr std::array<std::uint16_t, 16> kSpread = {0x0000, 0x0001, 0x0010, 0x0011, 0x0100, 0x0101, 0x0110, 0x0111,
                                                     0x1000, 0x1001, 0x1010, 0x1011, 0x1100, 0x1101, 0x1110, 0x1111};
  return 0x1111U + kSpread[in_range] + kSpread[hit];
}

/// The walk of one ray.
template <class Lanes, bool kAnyHit, class Record>
class Walk {
 public:
  Walk(const MemoryImage& image, const Ray& ray, Record& record)
      : image_(image),
        record_(record),
        boxes_(image.grid ? RayBoxes<Lanes>(ray, image.lower, image.upper, *image.grid)
                          : RayBoxes<Lanes>(ray, image.lower, image.upper)),
        triangles_(ray),
        t_min_(ray.t_min),
        limit_(std::min(ray.t_max, std::numeric_limits<float>::max())) {}

  Hit run() {
    std::uint32_t link = 0;
    do {
      record_.make_room();
      if (is_leaf(link)) {
        if (enter_leaf(link)) break;
        link = pop();
      } else {
        link = visit(link);
      }
    } while (link != kNoChild);
    record_.write(end_step(hit_.is_hit()));
    if (hit_.is_hit()) hit_.triangle |= image_.triangles[hit_.triangle].flags();
    return hit_;
  }

 private:
  struct Entry {
    std::uint32_t link;
    float enter;
  };

  /// Tests both children; returns where to go on.
  std::uint32_t visit(std::uint32_t index) {
    const NodeRecord& node = image_.nodes[index];
    unsigned hits = 0;
    const Lanes enter = boxes_.enter(node, RayBoxes<Lanes>::limits(t_min_, limit_), hits);
    if (hits == 3) {
      const float first = enter.lane0(), second = enter.lane1();
      const std::uint32_t near = second < first ? 1 : 0;
      record_.write(visit_step(index, hits, near));
      stack_[depth_++] = {node.child[1 - near], std::max(first, second)};
      return node.child[near];
    }
    record_.write(visit_step(index, hits, 0));
    return hits == 0 ? pop() : node.child[hits >> 1];
  }

  std::uint32_t pop() {
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
    if (culled != 0) record_.write(cull_step(culled));
    return link;
  }

  /// Tests the triangles of a leaf, for any-hit rays up to the first that ends the walk; says whether there was one.
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
    record_.write(leaf_step(first, tested));
    record_.write(phases);
    return ends;
  }

  /// Tests `count` triangles and returns their exit phases. Of an any-hit ray a triangle without flags `ends` the walk
  /// and lowers `count` to those up to it.
  std::uint32_t test_group(std::uint32_t first, std::uint32_t& count, bool& ends) {
    const auto result = triangles_.test(&image_.triangles[first], count);
    const unsigned lanes = (1U << count) - 1;
    const unsigned reached = less_equal(Lanes::all(t_min_), result.t) & lanes;
    unsigned in_range = reached & less_equal(result.t, Lanes::all(limit_));
    if (in_range == 0) return phases_of(0, 0);
    const unsigned inside = result.inside();
    unsigned hits = in_range & inside;
    if (hits == 0) return phases_of(in_range, 0);

    // A hit shortens the ray for the triangles behind it in the leaf.
    for (unsigned lane = 0; lane < count; ++lane) {
      if (((hits >> lane) & 1U) == 0) continue;
      if (kAnyHit && image_.triangles[first + lane].flags() == 0) {
        hit_ = Hit{};  // whatever is at the same distance
        accept(result, lane, first + lane);
        count = lane + 1;
        ends = true;
        break;
      }
      accept(result, lane, first + lane);
      const unsigned earlier = (2U << lane) - 1;
      in_range = (in_range & earlier) | (reached & less_equal(result.t, Lanes::all(limit_)) & ~earlier);
      hits = in_range & inside;
    }
    return phases_of(in_range, hits);
  }

  void accept(const typename RayTriangles<Lanes>::Result& result, unsigned lane, std::uint32_t triangle) {
    alignas(16) float t[4], u[4], v[4], sum[4];
    result.t.store(t);
    if (hit_.is_hit() && t[lane] == hit_.t &&
        image_.triangles[triangle].source > image_.triangles[hit_.triangle].source) {
      return;
    }
    result.u.store(u);
    result.v.store(v);
    result.sum.store(sum);
    const float weight_u = std::clamp(u[lane] / sum[lane], 0.0F, 1.0F);
    hit_ = {t[lane], weight_u, std::clamp(v[lane] / sum[lane], 0.0F, 1 - weight_u), triangle};
    limit_ = hit_.t;
  }

  const MemoryImage& image_;
  Record& record_;
  const RayBoxes<Lanes> boxes_;
  const RayTriangles<Lanes> triangles_;
  const float t_min_;
  float limit_;  ///< nothing behind this is of interest: t_max, later the hit
  Hit hit_;
  std::size_t depth_ = 0;
  std::array<Entry, kStackSize> stack_;
};

template <class Lanes, bool kAnyHit, class Record>
void trace_all(const MemoryImage& image, std::span<const Ray> rays, std::span<Hit> hits, Record&& record) {
  for (std::size_t i = 0; i < rays.size(); ++i) {
    record.begin_ray();
    record.make_room();
    hits[i] = Walk<Lanes, kAnyHit, std::remove_reference_t<Record>>(image, rays[i], record).run();
  }
}

template <class Lanes>
void dispatch(const MemoryImage& image, std::span<const Ray> rays, bool any, std::span<Hit> hits, WalkSink* walk) {
  if (walk != nullptr) {
    any ? trace_all<Lanes, true>(image, rays, hits, Recorder(*walk))
        : trace_all<Lanes, false>(image, rays, hits, Recorder(*walk));
  } else {
    any ? trace_all<Lanes, true>(image, rays, hits, NoRecorder{})
        : trace_all<Lanes, false>(image, rays, hits, NoRecorder{});
  }
}

}  // namespace

BvhTracer::BvhTracer(const MemoryImage& image, Arithmetic arithmetic) : image_(image), arithmetic_(arithmetic) {
  assert(!image.nodes.empty());
}

void BvhTracer::trace(std::span<const Ray> rays, RayKind kind, std::span<Hit> hits, WalkSink* walk) const {
  assert(hits.size() == rays.size());
  const bool any = kind == RayKind::kShadow;
  if (arithmetic_ == Arithmetic::kNative) {
    dispatch<NativeLanes>(image_, rays, any, hits, walk);
  } else {
    dispatch<PortableLanes>(image_, rays, any, hits, walk);
  }
}

}  // namespace traces
