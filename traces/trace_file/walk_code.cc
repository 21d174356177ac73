#include "traces/trace_file/walk_code.h"

#include <array>
#include <bit>

#include "traces/trace_file/bytes.h"
#include "traces/walk.h"

namespace traces {
namespace {

enum Pop : std::uint32_t { kNext = 0, kCullAll = 1, kEndHere = 2, kCullSome = 3 };

/// Collects bits, lowest first.
class BitWriter {
 public:
  explicit BitWriter(char* out) : out_(out) {}
  void put(std::uint64_t value, std::uint32_t bits) {
    held_ |= value << count_;
    count_ += bits;
    if (count_ < 32) return;
    std::memcpy(out_, &held_, 4);
    out_ += 4;
    held_ >>= 32;
    count_ -= 32;
  }
  /// Where the bytes end.
  char* end() {
    std::memcpy(out_, &held_, 8);
    return out_ + (count_ + 7) / 8;
  }

 private:
  char* out_;
  std::uint64_t held_ = 0;
  std::uint32_t count_ = 0;
};

struct NoBits {
  void put(std::uint64_t, std::uint32_t) {}
};

/// Exit phases of 4 bits each as 2 bits each, and back.
constexpr std::uint32_t squeeze(std::uint32_t x) {
  x &= 0x33333333U;
  x = (x | x >> 2) & 0x0f0f0f0fU;
  x = (x | x >> 4) & 0x00ff00ffU;
  return (x | x >> 8) & 0x0000ffffU;
}
constexpr std::uint32_t spread(std::uint32_t x) {
  x = (x | x << 8) & 0x00ff00ffU;
  x = (x | x << 4) & 0x0f0f0f0fU;
  return (x | x << 2) & 0x33333333U;
}

/// The lowest bit of every nibble that is not 0.
constexpr std::uint32_t nonzero(std::uint32_t phases) {
  phases |= phases >> 1;
  return (phases | phases >> 2) & 0x11111111U;
}

/// Whether just the first `tested` triangles of a leaf have an exit phase, and there are any.
constexpr bool are_tested(std::uint32_t phases, std::uint32_t tested) {
  return tested != 0 && nonzero(phases) == (0x11111111U & (0xffffffffU >> (32 - 4 * tested)));
}

/// Bits that say how many entries are culled; stacks hold kMaxTreeDepth entries of each level.
constexpr std::uint32_t kCullBits = 7;
static_assert(kMaxTreeDepth == 1U << kCullBits);
constexpr std::uint32_t cull_bits(bool levels) { return kCullBits + (levels ? 1 : 0); }
constexpr std::size_t kStackSize = 2 * std::size_t{kMaxTreeDepth} + 1;

/// Follows walks on a tree, word by word.
class Follower {
 public:
  Follower(const Links& links, const std::uint32_t* words, const std::uint32_t* end)
      : links_(links.nodes), roots_(links.roots), cull_bits_(cull_bits(!links.roots.empty())), at_(words), end_(end) {}

  const std::uint32_t* at() const { return at_; }
  std::uint64_t steps() const { return steps_; }

  /// One ray's walk, as bits into `out`. False if it is none on this tree.
  template <class Bits>
  bool follow(Bits& out) {
    std::uint32_t link = 0, depth = 0;
    for (;;) {
      if (at_ == end_) return false;
      const std::uint32_t word = *at_++;
      if (!is_leaf(link)) {
        const std::uint32_t code = word >> 27;
        if (link >= links_.size() || node_of(word) != link || code > 7 || ((1U << code) & 0x70U) != 0) return false;
        steps_ += 1;
        out.put(code, 3);
        const std::uint32_t hits = hits_of(word);
        if (hits != 0) {
          const std::uint32_t near = hits == 3 ? near_of(word) : hits >> 1;
          stack_[depth] = links_[link][1 - near];
          if (hits == 3 && stack_[depth++] == kNoChild) return false;
          link = links_[link][near];
          continue;
        }
      } else if (is_instance(link)) {
        if (word != enter_step(link_instance(link))) return false;
        link = roots_[link_instance(link)];
        continue;
      } else if (!leave_leaf(out, link, word)) {
        return false;
      }
      // A pop or the end.
      if (at_ == end_) return false;
      std::uint32_t next = *at_, culled = 0;
      if (depth != 0) {
        if (kind_of(next) == StepKind::kCull) {
          culled = culled_of(next);
          if (culled == 0 || culled > depth || ++at_ == end_) return false;
          next = *at_;
        }
        depth -= culled;
        if (depth != 0 && kind_of(next) != StepKind::kEnd) {
          out.put(culled != 0 ? kCullSome | culled << 2 : kNext, culled != 0 ? 2 + cull_bits_ : 2);
          link = stack_[--depth];
          continue;
        }
        if (depth != 0 && culled != 0) return false;
        out.put(depth == 0 ? kCullAll : kEndHere, 2);
      }
      if (next != end_step(false) && next != end_step(true)) return false;
      at_ += 1;
      out.put(next & 1, 1);
      return true;
    }
  }

 private:
  template <class Bits>
  bool leave_leaf(Bits& out, std::uint32_t link, std::uint32_t word) {
    if (kind_of(word) != StepKind::kLeaf || first_of(word) != leaf_first(link) || at_ == end_) return false;
    const std::uint32_t phases = *at_++, tested = count_of(word);
    if (tested > leaf_count(link) || (phases & 0xccccccccU) != 0 || !are_tested(phases, tested)) return false;
    steps_ += tested;
    out.put(squeeze(phases), 2 * leaf_count(link));
    return true;
  }

  const std::vector<std::array<std::uint32_t, 2>>& links_;
  const std::vector<std::uint32_t>& roots_;
  const std::uint32_t cull_bits_;
  const std::uint32_t *at_, *end_;
  std::uint64_t steps_ = 0;
  std::array<std::uint32_t, kStackSize> stack_;
};

[[noreturn]] void no_walk() { throw sim::InputError("a ray's walk is none on this tree"); }

/// Where the bits of a tile are read and the words of its walks are written.
struct Cursor {
  const char* bits;
  std::uint64_t end;  ///< the number of bits
  std::uint32_t* out;
  std::uint32_t* last;  ///< the end of the words
  std::uint64_t at = 0;
  std::uint64_t steps = 0;
};

/// Decodes a leaf's tests from the bits that come next; returns how many of these they take.
inline std::uint32_t decode_leaf(std::uint64_t window, std::uint32_t link, Cursor& c) {
  const std::uint32_t size = 2 * leaf_count(link);
  const std::uint32_t phases = spread(static_cast<std::uint32_t>(window) & ((1U << size) - 1));
  const std::uint32_t tested = static_cast<std::uint32_t>(std::bit_width(phases) + 3) / 4;
  if (!are_tested(phases, tested)) no_walk();
  *c.out++ = leaf_step(leaf_first(link), tested);
  *c.out++ = phases;
  c.steps += tested;
  return size;
}

/// Decodes one ray's walk.
template <bool kLevels>
inline void decode_walk(const Links& links, Cursor& c) {
  const std::array<std::uint32_t, 2>* const tree = links.nodes.data();
  const auto nodes = static_cast<std::uint32_t>(links.nodes.size());
  // Child entered first, for each code of a visit.
  constexpr std::array<std::uint8_t, 8> kNear = {0, 0, 1, 0, 0, 0, 0, 1};
  std::array<std::uint32_t, kStackSize> stack;
  std::uint32_t link = 0, depth = 0;
  for (;;) {
    if (c.at >= c.end || c.out >= c.last) no_walk();
    std::uint64_t window = load<std::uint64_t>(c.bits + (c.at >> 3)) >> (c.at & 7);
    if (!is_leaf(link)) {
      const std::uint32_t code = window & 7;
      if (link >= nodes || ((1U << code) & 0x70U) != 0) no_walk();
      *c.out++ = code << 27 | link;
      c.steps += 1;
      c.at += 3;
      const std::uint32_t hits = code & 3;
      if (hits != 0) {
        const std::uint32_t near = kNear[code];
        stack[depth] = tree[link][1 - near];
        if (hits == 3 && stack[depth++] == kNoChild) no_walk();
        link = tree[link][near];
        continue;
      }
      window >>= 3;
    } else if (kLevels && is_instance(link)) {
      *c.out++ = enter_step(link_instance(link));
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
      window >>= 2;
      if (pop == kCullSome) {
        const std::uint32_t culled = window & ((1U << cull_bits(kLevels)) - 1);
        c.at += cull_bits(kLevels);
        if (culled == 0 || culled >= depth) no_walk();
        *c.out++ = cull_step(culled);
        depth -= culled;
        link = stack[--depth];
        continue;
      }
      if (pop == kCullAll) *c.out++ = cull_step(depth);
    }
    *c.out++ = end_step((window & 1) != 0);
    c.at += 1;
    return;
  }
}

/// decode_walks() for trees of two levels, or of one.
template <bool kLevels>
std::uint64_t decode(std::string_view bits, const Links& links, std::uint32_t rays, std::uint32_t words,
                     TileWork& work) {
  constexpr std::uint32_t kMostWords = 4;  // that a step and what follows it make
  work.walk.resize(std::size_t{words} + kMostWords);
  work.ray_begin.resize(rays);
  std::uint32_t* const begin = work.walk.data();
  Cursor c{.bits = bits.data(), .end = 8 * bits.size(), .out = begin, .last = begin + words};
  for (std::uint32_t& ray : work.ray_begin) {
    ray = static_cast<std::uint32_t>(c.out - begin);
    decode_walk<kLevels>(links, c);
  }
  if (c.out != c.last || (c.at + 7) / 8 != bits.size()) no_walk();
  work.walk.resize(words);
  return c.steps;
}

}  // namespace

bool encode_walks(const TileWork& work, const Links& links, std::string& out) {
  const std::size_t before = out.size();
  out.resize(before + 4 * work.walk.size() + kBitsPadding);  // a word never takes more than 4 bytes
  BitWriter bits(out.data() + before);
  const std::uint32_t* begin = work.walk.data();
  Follower follower(links, begin, begin + work.walk.size());
  bool good = true;
  for (std::size_t ray = 0; good && ray < work.ray_begin.size(); ++ray) {
    good = follower.at() == begin + work.ray_begin[ray] && follower.follow(bits);
  }
  good = good && follower.at() == begin + work.walk.size();
  out.resize(good ? static_cast<std::size_t>(bits.end() - out.data()) : before);
  return good;
}

std::uint64_t decode_walks(std::string_view bits, const Links& links, std::uint32_t rays, std::uint32_t words,
                           TileWork& work) {
  return links.roots.empty() ? decode<false>(bits, links, rays, words, work)
                             : decode<true>(bits, links, rays, words, work);
}

std::uint64_t decode_plain_walks(std::string_view bytes, const Links& links, std::uint32_t rays, TileWork& work) {
  work.walk.resize(bytes.size() / 4);
  if (!bytes.empty()) std::memcpy(work.walk.data(), bytes.data(), bytes.size());
  work.ray_begin.resize(rays);
  const std::uint32_t* begin = work.walk.data();
  Follower follower(links, begin, begin + work.walk.size());
  NoBits none;
  for (std::uint32_t& at : work.ray_begin) {
    at = static_cast<std::uint32_t>(follower.at() - begin);
    if (!follower.follow(none)) no_walk();
  }
  if (follower.at() != begin + work.walk.size()) no_walk();
  return follower.steps();
}

}  // namespace traces
