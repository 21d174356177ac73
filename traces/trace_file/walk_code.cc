#include "traces/trace_file/walk_code.h"

#include <array>
#include <vector>

#include "traces/trace_file/bytes.h"
#include "traces/trace_file/walk_bits.h"
#include "traces/walk.h"

namespace traces {
namespace {

/// Writes bits, lowest first.
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
  /// Flushes and returns the end of the bytes.
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

/// Checks walks against a tree, word by word.
class Follower {
 public:
  Follower(const Links& links, const std::uint32_t* words, const std::uint32_t* end)
      : links_(links.nodes), roots_(links.roots), cull_bits_(cull_bits(!links.roots.empty())), at_(words), end_(end) {}

  const std::uint32_t* at() const { return at_; }
  const WalkSteps& steps() const { return steps_; }

  /// Checks one ray's walk and writes its bits to `out`. False if the walk does not fit the tree.
  template <class Bits>
  bool follow(Bits& out) {
    std::uint32_t link = 0, depth = 0;
    for (;;) {
      if (at_ == end_) return false;
      const std::uint32_t word = *at_++;
      if (!is_leaf(link)) {
        const std::uint32_t code = word >> 27;
        if (link >= links_.size() || node_of(word) != link || code > 7 || ((1U << code) & 0x70U) != 0) return false;
        steps_.visits += 1;
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
      // A pop or the end follows.
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
    steps_.tests += tested;
    out.put(squeeze(phases), 2 * leaf_count(link));
    return true;
  }

  const std::vector<std::array<std::uint32_t, 2>>& links_;
  const std::vector<std::uint32_t>& roots_;
  const std::uint32_t cull_bits_;
  const std::uint32_t *at_, *end_;
  WalkSteps steps_;
  std::array<std::uint32_t, kStackSize> stack_;
};

}  // namespace

bool encode_walks(const TileWork& work, const Links& links, std::string& out) {
  const std::size_t before = out.size();
  out.resize(before + 4 * work.walk.size() + kBitsPadding);  // a word takes at most 4 bytes
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

WalkSteps decode_plain_walks(std::string_view bytes, const Links& links, std::uint32_t rays, TileWork& work) {
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
