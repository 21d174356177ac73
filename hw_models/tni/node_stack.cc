#include "hw_models/tni/node_stack.h"

#include <algorithm>
#include <cassert>

namespace hw {

void NodeStack::begin_at(std::uint32_t start) {
  entries_.clear();
  start_ = start;
  resident_ = 0;
  instance_ = traces::kNone;
  parent_ = 0;
}

void NodeStack::push(std::uint32_t node, std::uint32_t hits, std::uint32_t capacity, StackStats& stats) {
  constexpr std::uint32_t kSlots = (1U << traces::kMaxWidth * traces::kSlotBits) - 1;
  entries_.push_back({{node, instance_}, (hits & kSlots) >> traces::kSlotBits, traces::hit_count_of(hits) - 1});
  if (capacity == 0) return;
  stats.pushes += 1;
  if (resident_ == capacity) {
    stats.dropped += 1;
  } else {
    resident_ += 1;
  }
}

std::optional<std::uint32_t> NodeStack::pop(const TreeInMemory& tree, StackStats& stats) {
  if (resident_ == 0) return {};
  stats.pops += 1;
  stats.entry_updates += entries_.back().left > 1;
  return take_child(tree);
}

std::uint32_t NodeStack::take_child(const TreeInMemory& tree) {
  assert(!entries_.empty() && "a pop from an empty stack");
  Entry& entry = entries_.back();
  parent_ = entry.origin.node;
  instance_ = entry.origin.instance;
  const std::uint32_t link = tree.wide_links[parent_].child[entry.slots & (traces::kMaxWidth - 1)];
  entry.slots >>= traces::kSlotBits;
  entry.left -= 1;
  if (entry.left == 0) {
    entries_.pop_back();
    resident_ -= resident_ != 0;
  }
  return link;
}

std::uint32_t NodeStack::resident_children() const {
  std::uint32_t children = 0;
  for (std::uint32_t i = 1; i <= resident_; ++i) children += entries_[entries_.size() - i].left;
  return children;
}

void NodeStack::restart(const StackRules& rules, const TreeInMemory& tree, RestartPath& path, StackStats& stats) {
  assert(!entries_.empty() && "a pop from an empty stack");
  const std::uint32_t youngest = entries_.back().origin.node;
  if (rules.scheme == StackScheme::kParent) {
    path.plan_climb(parent_, instance_, youngest, tree);
  } else {
    path.plan_path(entries_.back().origin,
                   rules.scheme == StackScheme::kRestartTrail ? start_ : entries_.front().origin.node, tree);
  }
  stats.restarts += 1;
  // The last child of an entry is entered without a push.
  const auto all = static_cast<std::uint32_t>(entries_.size());
  const std::uint32_t found = rules.scheme == StackScheme::kParent ? 1 : all;
  const std::uint32_t unpushed = rules.continues_without_pop() && entries_.back().left == 1 ? 1 : 0;
  const std::uint32_t kept = std::min(found - unpushed, rules.capacity);
  resident_ = kept + unpushed;
  if (rules.capacity == 0) return;
  stats.pushes += found - unpushed;
  stats.dropped += found - unpushed - kept;
}

}  // namespace hw
