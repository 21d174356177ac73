#include <algorithm>
#include <array>
#include <bit>
#include <vector>

#include "traces/trace_file/bytes.h"
#include "traces/trace_file/walk_bits.h"
#include "traces/trace_file/walk_code.h"
#include "traces/walk.h"

namespace traces {
namespace {

constexpr std::uint32_t kMostWords = 4;  // of a step and what follows it

/// Decoder state: the input bits and the output words. Output grows only as far as input has been decoded, so a forged
/// count cannot exhaust memory.
struct Cursor {
  Cursor(std::string_view from, std::uint32_t count, std::vector<std::uint32_t>& to)
      : bits(from.data()), end(8 * from.size()), words(count), walk(to) {
    make_room(std::max<std::size_t>(kFirstRoom, to.capacity()), 0);
  }
  std::uint32_t written() const { return static_cast<std::uint32_t>(out - walk.data()); }
  void grow() {
    const std::uint32_t done = written();
    if (done >= words) no_walk();
    make_room(2 * walk.size(), done);
  }

  const char* bits;
  const std::uint64_t end;    ///< number of bits
  const std::uint32_t words;  ///< expected number of words
  std::vector<std::uint32_t>& walk;
  std::uint32_t* out;
  std::uint32_t* last;  ///< end of the output, less the room for one step
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

/// Decodes a leaf's tests from the next bits and returns the number of bits used.
inline std::uint32_t decode_leaf(std::uint64_t window, std::uint32_t link, Cursor& c) {
  const std::uint32_t size = 2 * leaf_count(link);
  const std::uint32_t phases = spread(static_cast<std::uint32_t>(window) & ((1U << size) - 1));
  const std::uint32_t tested = static_cast<std::uint32_t>(std::bit_width(phases) + 3) / 4;
  if (!are_tested(phases, tested)) no_walk();
  *c.out++ = leaf_step(leaf_first(link), tested);
  *c.out++ = phases;
  c.steps.tests += tested;
  return size;
}

/// Decodes one ray's walk.
template <bool kLevels>
inline void decode_walk(const Links& links, Cursor& c) {
  const std::array<std::uint32_t, 2>* const tree = links.nodes.data();
  const auto nodes = static_cast<std::uint32_t>(links.nodes.size());
  // Child entered first, by the code of a visit.
  constexpr std::array<std::uint8_t, 8> kNear = {0, 0, 1, 0, 0, 0, 0, 1};
  std::array<std::uint32_t, kStackSize> stack;
  std::uint32_t link = 0, depth = 0;
  for (;;) {
    if (c.at >= c.end) no_walk();
    if (c.out >= c.last) c.grow();
    std::uint64_t window = load<std::uint64_t>(c.bits + (c.at >> 3)) >> (c.at & 7);
    if (!is_leaf(link)) {
      const std::uint32_t code = window & 7;
      if (link >= nodes || ((1U << code) & 0x70U) != 0) no_walk();
      *c.out++ = code << 27 | link;
      c.steps.visits += 1;
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

/// Decodes walks for trees of one or two levels.
template <bool kLevels>
WalkSteps decode(std::string_view bits, const Links& links, std::uint32_t rays, std::uint32_t words, TileWork& work) {
  Cursor c(bits, words, work.walk);
  work.ray_begin.resize(rays);
  for (std::uint32_t& ray : work.ray_begin) {
    ray = c.written();
    decode_walk<kLevels>(links, c);
  }
  if (c.written() != words || (c.at + 7) / 8 != bits.size()) no_walk();
  work.walk.resize(words);
  return c.steps;
}

}  // namespace

WalkSteps decode_walks(std::string_view bits, const Links& links, std::uint32_t rays, std::uint32_t words,
                       TileWork& work) {
  return links.roots.empty() ? decode<false>(bits, links, rays, words, work)
                             : decode<true>(bits, links, rays, words, work);
}

}  // namespace traces
