#include "hw_models/tni/node_prefetcher.h"

#include <algorithm>
#include <cassert>
#include <utility>

#include "traces/walk.h"

namespace hw {

NodePrefetcher::NodePrefetcher(const TrvConfig& config, const TreeInMemory& tree,
                               std::shared_ptr<const Treelets> treelets)
    : depth_(config.prefetch_depth),
      keeps_stacks_(config.prefetch == Prefetch::kStack),
      can_issue_(config.l1.mshrs >= 2),
      tree_(tree),
      treelets_(std::move(treelets)) {
  constexpr std::size_t kUsualStackDepth = 128;
  if (!keeps_stacks_) return;
  stacks_.resize(config.rays);
  for (RayStack& stack : stacks_) stack.links.reserve(kUsualStackDepth);
}

void NodePrefetcher::begin_ray(std::uint32_t slot) {
  if (!keeps_stacks_) return;
  stacks_[slot].links.clear();
  stacks_[slot].popped = false;
}

void NodePrefetcher::push_entry(std::uint32_t slot, std::uint32_t link) {
  if (!keeps_stacks_) return;
  stacks_[slot].links.push_back(link);
  stacks_[slot].popped = false;
}

void NodePrefetcher::push_entries_of(std::uint32_t slot, std::uint32_t node, std::uint32_t hits) {
  const auto& children = tree_.wide_links[node].child;
  for (std::uint32_t position = traces::hit_count_of(hits); position-- > 1;) {
    push_entry(slot, children[traces::hit_slot_of(hits, position)]);
  }
}

void NodePrefetcher::pop_entry(std::uint32_t slot, std::uint32_t resident, std::uint32_t culled) {
  if (!keeps_stacks_) return;
  RayStack& stack = stacks_[slot];
  take_entry(slot);
  if (std::exchange(stack.popped, true)) {
    const std::uint32_t count = std::min(depth_, resident);
    assert(count <= stack.links.size());
    stats_.stack_reads += count;
    for (std::uint32_t i = culled + 1; i <= count; ++i) queue_link(stack.links[stack.links.size() - i], slot);
  }
}

void NodePrefetcher::take_entry(std::uint32_t slot) {
  if (!keeps_stacks_) return;
  assert(!stacks_[slot].links.empty());
  stacks_[slot].links.pop_back();
}

void NodePrefetcher::note_miss(std::uint32_t slot, std::uint32_t node) {
  if (treelets_ == nullptr) return;
  const std::uint32_t treelet = treelets_->treelet_with_root(node);
  if (treelet == Treelets::kNone || treelet == last_treelet_) return;
  last_treelet_ = treelet;
  for (const Addr line : treelets_->lines_below_root(treelet)) queue_line(line, slot);
}

void NodePrefetcher::queue_link(std::uint32_t link, std::uint32_t slot) {
  if (traces::is_instance(link)) return queue_line(tree_.line_of_instance(traces::link_instance(link)), slot);
  if (traces::is_leaf(link)) return;
  lines_.clear();
  append_node_lines(tree_, link, lines_);
  for (const Addr line : lines_) queue_line(line, slot);
}

void NodePrefetcher::queue_line(Addr line, std::uint32_t slot) {
  if (!can_issue_ || queue_.size() == TrvConfig::kPrefetchQueue) {
    stats_.dropped += 1;
    return;
  }
  queue_.push_back({line, slot});
}

bool NodePrefetcher::issue_prefetch(FetchStage& fetch, std::uint64_t cycle) {
  if (!has_work(fetch)) return false;
  const Queued next = queue_.front();
  queue_.pop_front();
  stats_.probes += 1;
  stats_.requests += fetch.prefetch_line(next.line, next.slot, cycle);
  return true;
}

}  // namespace hw
