#include "traces/trace_file/walk_code.h"

#include <algorithm>
#include <array>
#include <bit>
#include <vector>

#include "sim/error.h"
#include "traces/trace_file/bytes.h"
#include "traces/walk.h"

namespace traces {
namespace {

enum Pop : std::uint32_t { kNext = 0, kCullAll = 1, kEndHere = 2, kCullSome = 3 };

/// Packs exit phases of 4 bits each to 2 bits each; unpack_phases() is the inverse.
constexpr std::uint32_t pack_phases(std::uint32_t x) {
  x &= 0x33333333U;
  x = (x | x >> 2) & 0x0f0f0f0fU;
  x = (x | x >> 4) & 0x00ff00ffU;
  return (x | x >> 8) & 0x0000ffffU;
}
constexpr std::uint32_t unpack_phases(std::uint32_t x) {
  x = (x | x << 8) & 0x00ff00ffU;
  x = (x | x << 4) & 0x0f0f0f0fU;
  return (x | x << 2) & 0x33333333U;
}

/// Returns a word in which the lowest bit of each nibble is set if that nibble of `phases` is not 0.
constexpr std::uint32_t nonzero_phases(std::uint32_t phases) {
  phases |= phases >> 1;
  return (phases | phases >> 2) & 0x11111111U;
}

/// True if exactly the first `tested` triangles of a leaf have an exit phase, and `tested` is not 0.
constexpr bool are_tested(std::uint32_t phases, std::uint32_t tested) {
  return tested != 0 && nonzero_phases(phases) == (0x11111111U & (0xffffffffU >> (32 - 4 * tested)));
}

/// Bits of the number of culled entries. A stack has kMaxTreeDepth entries per level, in wide trees up to
/// kMaxWidth - 1 times that number.
constexpr std::uint32_t kCullBits = 7;
static_assert(kMaxTreeDepth == 1U << kCullBits);
constexpr std::uint32_t cull_bits(bool wide, bool levels) {
  return kCullBits + (wide ? kSlotBits : 0) + (levels ? 1 : 0);
}
constexpr std::size_t stack_size(bool wide) {
  return (2 * std::size_t{kMaxTreeDepth} + 1) * (wide ? kMaxWidth - 1 : 1);
}

/// Returns the bits that name one of `count` things.
constexpr std::uint32_t choice_bits(std::uint32_t count) {
  return count < 2 ? 0 : static_cast<std::uint32_t>(std::bit_width(count - 1));
}

/// Returns the position of a slot among the slots of `mask`, in slot order.
constexpr std::uint32_t position_in(std::uint32_t mask, std::uint32_t slot) {
  return static_cast<std::uint32_t>(std::popcount(mask & ((1U << slot) - 1)));
}

/// Returns the slot at a position among the slots of `mask`.
constexpr std::uint32_t slot_at(std::uint32_t mask, std::uint32_t position) {
  for (; position != 0; --position) mask &= mask - 1;
  return static_cast<std::uint32_t>(std::countr_zero(mask));
}

/// State of a walk whose look-up has found a node: whether the walk ends below the node, or continues at the root.
enum class Prediction : std::uint8_t { kNone, kCorrect, kWrong };

[[noreturn]] void throw_invalid_walk() { throw sim::InputError("a ray's walk is none on this tree"); }

/// Appends bits to memory, lowest bit first.
class BitWriter {
 public:
  explicit BitWriter(char* out) : out_(out) {}
  void put_bits(std::uint64_t value, std::uint32_t bits) {
    held_ |= value << count_;
    count_ += bits;
    if (count_ < 32) return;
    std::memcpy(out_, &held_, 4);
    out_ += 4;
    held_ >>= 32;
    count_ -= 32;
  }
  /// Writes the remaining bits and returns the end of the bytes.
  char* finish_bits() {
    std::memcpy(out_, &held_, 8);
    return out_ + (count_ + 7) / 8;
  }

 private:
  char* out_;
  std::uint64_t held_ = 0;
  std::uint32_t count_ = 0;
};

struct NoBits {
  void put_bits(std::uint64_t, std::uint32_t) {}
};

/// Checks, word by word, whether recorded walks of rays are possible in a BVH.
template <bool kWide>
class WalkChecker {
 public:
  WalkChecker(const Links& links, bool look_ups, const std::uint32_t* words, const std::uint32_t* end)
      : look_ups_(look_ups),
        links_(nodes_of(links)),
        roots_(links.roots),
        slots_(links.slots),
        cull_bits_(cull_bits(kWide, !links.roots.empty())),
        at_(words),
        end_(end) {}

  const std::uint32_t* next_word() const { return at_; }
  const WalkSteps& step_counts() const { return steps_; }

  /// Checks the recorded walk of one ray and writes its bits to `out`. Returns false if the walk does not fit the BVH.
  template <class Bits>
  bool follow_walk(Bits& out) {
    std::uint32_t link = 0, depth = 0;
    Prediction prediction = Prediction::kNone;
    if (look_ups_ && !follow_look_up(out, link, prediction)) return false;
    for (;;) {
      if (at_ == end_) return false;
      const std::uint32_t word = *at_++;
      if (kWide && !is_leaf(link)) {
        std::uint32_t hits = 0;
        if (!follow_wide_visit(out, link, word, depth, hits)) return false;
        if (hits != 0) {
          link = links_[link][hit_slot_of(hits, 0)];
          continue;
        }
      } else if (!is_leaf(link)) {
        const std::uint32_t code = word >> 27;
        if (link >= links_.size() || node_of(word) != link || code > 7 || ((1U << code) & 0x70U) != 0) return false;
        steps_.visits += 1;
        out.put_bits(code, 3);
        const std::uint32_t hits = hits_of(word);
        if (hits != 0) {
          const std::uint32_t near = hits == 3 ? near_of(word) : hits >> 1;
          stack_[depth] = links_[link][1 - near];
          if (hits == 3 && stack_[depth++] == kNoChild) return false;
          link = links_[link][near];
          continue;
        }
      } else if (is_instance(link)) {
        if (word != instance_step(link_instance(link))) return false;
        link = roots_[link_instance(link)];
        continue;
      } else if (!leave_leaf(out, link, word)) {
        return false;
      }
      // A pop or the end must follow.
      if (at_ == end_) return false;
      std::uint32_t next = *at_, culled = 0;
      if (prediction == Prediction::kWrong) {
        if (kind_of(next) == StepKind::kCull || kind_of(next) == StepKind::kEnd) return false;
        if (depth == 0) {
          prediction = Prediction::kNone;
          link = 0;
          continue;
        }
      }
      if (depth != 0) {
        if (kind_of(next) == StepKind::kCull) {
          culled = culled_of(next);
          if (culled == 0 || culled > depth || ++at_ == end_) return false;
          next = *at_;
        }
        depth -= culled;
        if (depth != 0 && kind_of(next) != StepKind::kEnd) {
          out.put_bits(culled != 0 ? kCullSome | culled << 2 : kNext, culled != 0 ? 2 + cull_bits_ : 2);
          link = stack_[--depth];
          continue;
        }
        if (depth != 0 && culled != 0) return false;
        out.put_bits(depth == 0 ? kCullAll : kEndHere, 2);
      }
      if (next != end_step(true) && (next != end_step(false) || prediction == Prediction::kCorrect)) return false;
      at_ += 1;
      out.put_bits(next & 1, 1);
      return true;
    }
  }

 private:
  using Nodes = std::vector<std::array<std::uint32_t, kWide ? kMaxWidth : 2>>;
  static const Nodes& nodes_of(const Links& links) {
    if constexpr (kWide) {
      return links.wide_nodes;
    } else {
      return links.nodes;
    }
  }

  /// Checks the look-up with which a walk may begin. Sets `link` to the node at which the walk begins.
  template <class Bits>
  bool follow_look_up(Bits& out, std::uint32_t& link, Prediction& prediction) {
    if (at_ == end_) return false;
    const std::uint32_t word = *at_;
    out.put_bits(is_look_up(word), 1);
    if (!is_look_up(word)) return true;
    at_ += 1;
    const bool predicted = node_of(word) != kNoPrediction, correct = is_correct_look_up(word);
    out.put_bits((predicted ? 2U : 0U) | (stores_hit(word) ? 1U : 0U), 2);
    if (!predicted) return !correct;
    out.put_bits(std::uint64_t{node_of(word)} << 1 | (correct ? 1U : 0U), 1 + kNodeBits);
    link = node_of(word);
    prediction = correct ? Prediction::kCorrect : Prediction::kWrong;
    return link != 0 && link < links_.size();
  }

  /// Checks the two words of a wide visit and pushes all hit children but the nearest.
  template <class Bits>
  bool follow_wide_visit(Bits& out, std::uint32_t link, std::uint32_t word, std::uint32_t& depth, std::uint32_t& hits) {
    if (link >= links_.size() || word != wide_step(link) || at_ == end_) return false;
    hits = *at_++;
    steps_.visits += 1;
    std::uint32_t left = hit_mask_of(hits);
    if (left >> slots_ != 0) return false;
    out.put_bits(left, slots_);
    const std::uint32_t count = hit_count_of(hits);
    if ((hits & ((1U << (kMaxWidth * kSlotBits)) - 1)) >> (kSlotBits * count) != 0) return false;
    for (std::uint32_t i = 0; i < count; ++i) {
      const std::uint32_t slot = hit_slot_of(hits, i);
      if ((left >> slot & 1U) == 0 || links_[link][slot] == kNoChild) return false;
      out.put_bits(position_in(left, slot), choice_bits(count - i));
      left &= ~(1U << slot);
    }
    for (std::uint32_t i = count; i-- > 1;) stack_[depth++] = links_[link][hit_slot_of(hits, i)];
    return true;
  }

  template <class Bits>
  bool leave_leaf(Bits& out, std::uint32_t link, std::uint32_t word) {
    if (kind_of(word) != StepKind::kLeaf || first_of(word) != leaf_first(link) || at_ == end_) return false;
    const std::uint32_t phases = *at_++, tested = count_of(word);
    if (tested > leaf_count(link) || (phases & 0xccccccccU) != 0 || !are_tested(phases, tested)) return false;
    steps_.tests += tested;
    out.put_bits(pack_phases(phases), 2 * leaf_count(link));
    return true;
  }

  const bool look_ups_;
  const Nodes& links_;
  const std::vector<std::uint32_t>& roots_;
  const std::uint32_t slots_;
  const std::uint32_t cull_bits_;
  const std::uint32_t *at_, *end_;
  WalkSteps steps_;
  std::array<std::uint32_t, stack_size(kWide)> stack_;
};

template <bool kWide>
bool encode_checked(const TileWork& work, const Links& links, bool look_ups, std::string& out) {
  const std::size_t before = out.size();
  out.resize(before + 4 * work.walk.size() + kBitsPadding);  // a word takes at most 4 bytes
  BitWriter bits(out.data() + before);
  const std::uint32_t* begin = work.walk.data();
  WalkChecker<kWide> follower(links, look_ups, begin, begin + work.walk.size());
  bool good = true;
  for (std::size_t ray = 0; good && ray < work.ray_begin.size(); ++ray) {
    good = follower.next_word() == begin + work.ray_begin[ray] && follower.follow_walk(bits);
  }
  good = good && follower.next_word() == begin + work.walk.size();
  out.resize(good ? static_cast<std::size_t>(bits.finish_bits() - out.data()) : before);
  return good;
}

template <bool kWide>
WalkSteps check_plain_walks(const Links& links, bool look_ups, TileWork& work) {
  const std::uint32_t* begin = work.walk.data();
  WalkChecker<kWide> follower(links, look_ups, begin, begin + work.walk.size());
  NoBits none;
  for (std::uint32_t& at : work.ray_begin) {
    at = static_cast<std::uint32_t>(follower.next_word() - begin);
    if (!follower.follow_walk(none)) throw_invalid_walk();
  }
  if (follower.next_word() != begin + work.walk.size()) throw_invalid_walk();
  return follower.step_counts();
}

}  // namespace

bool has_look_ups(const TileWork& work) {
  return std::ranges::any_of(work.ray_begin, [&](std::uint32_t begin) { return is_look_up(work.walk[begin]); });
}

bool encode_walks(const TileWork& work, const Links& links, bool look_ups, std::string& out) {
  return links.is_wide() ? encode_checked<true>(work, links, look_ups, out)
                         : encode_checked<false>(work, links, look_ups, out);
}

WalkSteps decode_plain_walks(std::string_view bytes, const Links& links, bool look_ups, std::uint32_t rays,
                             TileWork& work) {
  work.walk.resize(bytes.size() / 4);
  if (!bytes.empty()) std::memcpy(work.walk.data(), bytes.data(), bytes.size());
  work.ray_begin.resize(rays);
  return links.is_wide() ? check_plain_walks<true>(links, look_ups, work)
                         : check_plain_walks<false>(links, look_ups, work);
}

namespace {

constexpr std::uint32_t kMostWords = 4;  // number of words that a step and what follows it can write

/// State of the decoder of walks: the input bits and the output words. Output grows only as far as input has been
/// decoded, so a forged count cannot exhaust memory.
struct Cursor {
  Cursor(std::string_view from, std::uint32_t count, std::vector<std::uint32_t>& to)
      : bits(from.data()), end(8 * from.size()), words(count), walk(to) {
    make_room(std::max<std::size_t>(kFirstRoom, to.capacity()), 0);
  }
  std::uint32_t word_count() const { return static_cast<std::uint32_t>(out - walk.data()); }
  void grow_output() {
    const std::uint32_t done = word_count();
    if (done >= words) throw_invalid_walk();
    make_room(2 * walk.size(), done);
  }

  const char* bits;
  const std::uint64_t end;    ///< number of encoded bits of the input
  const std::uint32_t words;  ///< expected number of output words
  std::vector<std::uint32_t>& walk;
  std::uint32_t* out;
  std::uint32_t* last;  ///< end of the output, minus the space for one step
  std::uint64_t at = 0;
  WalkSteps steps;

 private:
  static constexpr std::size_t kFirstRoom = std::size_t{1} << 16;
  void make_room(std::size_t room, std::uint32_t done) {
    walk.resize(std::min(room, std::size_t{words} + kMostWords));
    out = walk.data() + done;
    last = walk.data() + walk.size() - kMostWords;
  }
};

/// Decodes the triangle tests of a leaf from the next bits. Returns the number of bits read.
inline std::uint32_t decode_leaf(std::uint64_t window, std::uint32_t link, Cursor& c) {
  const std::uint32_t size = 2 * leaf_count(link);
  const std::uint32_t phases = unpack_phases(static_cast<std::uint32_t>(window) & ((1U << size) - 1));
  const std::uint32_t tested = static_cast<std::uint32_t>(std::bit_width(phases) + 3) / 4;
  if (!are_tested(phases, tested)) throw_invalid_walk();
  *c.out++ = leaf_step(leaf_first(link), tested);
  *c.out++ = phases;
  c.steps.tests += tested;
  return size;
}

/// Decodes the hit children of a wide visit from the next bits and pushes all but the nearest. Returns the visit's
/// second word.
inline std::uint32_t decode_wide_visit(std::uint64_t window, const std::array<std::uint32_t, kMaxWidth>& children,
                                       std::uint32_t slots, std::uint32_t* stack, std::uint32_t& depth,
                                       std::uint32_t& used) {
  const auto mask = static_cast<std::uint32_t>(window) & ((1U << slots) - 1);
  used = slots;
  std::uint32_t left = mask, order = 0, count = 0;
  for (auto more = static_cast<std::uint32_t>(std::popcount(mask)); more != 0; --more, ++count) {
    const std::uint32_t bits = choice_bits(more);
    const std::uint32_t position = static_cast<std::uint32_t>(window >> used) & ((1U << bits) - 1);
    if (position >= more) throw_invalid_walk();
    const std::uint32_t slot = slot_at(left, position);
    if (children[slot] == kNoChild) throw_invalid_walk();
    used += bits;
    order |= slot << (kSlotBits * count);
    left &= ~(1U << slot);
  }
  for (; count > 1; --count) stack[depth++] = children[hit_slot_of(order, count - 1)];
  return wide_hits(mask, order);
}

/// Decodes the look-up with which a walk may begin. Sets `link` to the node at which the walk begins.
inline Prediction decode_look_up(std::uint32_t nodes, Cursor& c, std::uint32_t& link) {
  if (c.at >= c.end) throw_invalid_walk();
  if (c.out >= c.last) c.grow_output();
  const std::uint64_t window = load_unaligned<std::uint64_t>(c.bits + (c.at >> 3)) >> (c.at & 7);
  c.at += 1;
  if ((window & 1) == 0) return Prediction::kNone;
  c.at += 2;
  const bool stored = (window >> 1 & 1) != 0, predicted = (window >> 2 & 1) != 0;
  if (!predicted) {
    *c.out++ = look_up_step(kNoPrediction, false, stored);
    return Prediction::kNone;
  }
  c.at += 1 + kNodeBits;
  const bool correct = (window >> 3 & 1) != 0;
  link = node_of(static_cast<std::uint32_t>(window >> 4));
  if (link == 0 || link >= nodes) throw_invalid_walk();
  *c.out++ = look_up_step(link, correct, stored);
  return correct ? Prediction::kCorrect : Prediction::kWrong;
}

/// Decodes the recorded walk of one ray.
template <bool kLevels, bool kWide>
inline void decode_walk(const Links& links, bool look_ups, Cursor& c) {
  const std::array<std::uint32_t, 2>* const tree = links.nodes.data();
  const auto nodes = static_cast<std::uint32_t>(links.node_count());
  // Which child is entered first, for each code of a visit.
  constexpr std::array<std::uint8_t, 8> kNear = {0, 0, 1, 0, 0, 0, 0, 1};
  std::array<std::uint32_t, stack_size(kWide)> stack;
  std::uint32_t link = 0, depth = 0;
  Prediction prediction = look_ups ? decode_look_up(nodes, c, link) : Prediction::kNone;
  for (;;) {
    if (c.at >= c.end) throw_invalid_walk();
    if (c.out >= c.last) c.grow_output();
    std::uint64_t window = load_unaligned<std::uint64_t>(c.bits + (c.at >> 3)) >> (c.at & 7);
    if (kWide && !is_leaf(link)) {
      if (link >= nodes) throw_invalid_walk();
      const auto& children = links.wide_nodes[link];
      std::uint32_t used = 0;
      const std::uint32_t hits = decode_wide_visit(window, children, links.slots, stack.data(), depth, used);
      *c.out++ = wide_step(link);
      *c.out++ = hits;
      c.steps.visits += 1;
      c.at += used;
      if (hits != 0) {
        link = children[hit_slot_of(hits, 0)];
        continue;
      }
      window >>= used;
    } else if (!is_leaf(link)) {
      const std::uint32_t code = window & 7;
      if (link >= nodes || ((1U << code) & 0x70U) != 0) throw_invalid_walk();
      *c.out++ = code << 27 | link;
      c.steps.visits += 1;
      c.at += 3;
      const std::uint32_t hits = code & 3;
      if (hits != 0) {
        const std::uint32_t near = kNear[code];
        stack[depth] = tree[link][1 - near];
        if (hits == 3 && stack[depth++] == kNoChild) throw_invalid_walk();
        link = tree[link][near];
        continue;
      }
      window >>= 3;
    } else if (kLevels && is_instance(link)) {
      *c.out++ = instance_step(link_instance(link));
      link = links.roots[link_instance(link)];
      continue;
    } else {
      const std::uint32_t size = decode_leaf(window, link, c);
      c.at += size;
      window >>= size;
    }
    if (depth != 0) {
      const std::uint32_t pop = window & 3;
      c.at += 2;
      if (pop == kNext) {
        link = stack[--depth];
        continue;
      }
      if (prediction == Prediction::kWrong) throw_invalid_walk();
      window >>= 2;
      if (pop == kCullSome) {
        const auto culled = static_cast<std::uint32_t>(window & ((1U << cull_bits(kWide, kLevels)) - 1));
        c.at += cull_bits(kWide, kLevels);
        if (culled == 0 || culled >= depth) throw_invalid_walk();
        *c.out++ = cull_step(culled);
        depth -= culled;
        link = stack[--depth];
        continue;
      }
      if (pop == kCullAll) *c.out++ = cull_step(depth);
    } else if (prediction == Prediction::kWrong) {
      prediction = Prediction::kNone;
      link = 0;
      continue;
    }
    if (prediction == Prediction::kCorrect && (window & 1) == 0) throw_invalid_walk();
    *c.out++ = end_step((window & 1) != 0);
    c.at += 1;
    return;
  }
}

/// Decodes the recorded walks of rays through a BVH of one or two levels.
template <bool kLevels, bool kWide>
WalkSteps decode_levels(std::string_view bits, const Links& links, bool look_ups, std::uint32_t rays,
                        std::uint32_t words, TileWork& work) {
  Cursor c(bits, words, work.walk);
  work.ray_begin.resize(rays);
  for (std::uint32_t& ray : work.ray_begin) {
    ray = c.word_count();
    decode_walk<kLevels, kWide>(links, look_ups, c);
  }
  if (c.word_count() != words || (c.at + 7) / 8 != bits.size()) throw_invalid_walk();
  work.walk.resize(words);
  return c.steps;
}

}  // namespace

WalkSteps decode_walks(std::string_view bits, const Links& links, bool look_ups, std::uint32_t rays,
                       std::uint32_t words, TileWork& work) {
  if (links.is_wide()) {
    return links.roots.empty() ? decode_levels<false, true>(bits, links, look_ups, rays, words, work)
                               : decode_levels<true, true>(bits, links, look_ups, rays, words, work);
  }
  return links.roots.empty() ? decode_levels<false, false>(bits, links, look_ups, rays, words, work)
                             : decode_levels<true, false>(bits, links, look_ups, rays, words, work);
}

}  // namespace traces
