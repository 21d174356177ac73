#include "hw_models/tni/node_prefetcher.h"

#include <algorithm>
#include <cassert>
#include <utility>

#include "traces/walk.h"

namespace hw {

NodePrefetcher::NodePrefetcher(const TrvConfig& config, const TreeInMemory& tree,
                               std::shared_ptr<const Treelets> treelets, sim::Link<LeafPrefetch>* leaves_out)
    : depth_(config.prefetch_depth),
      keeps_stacks_(config.prefetch == Prefetch::kStack),
      can_issue_(config.l1.mshrs >= 2),
      tree_(tree),
      treelets_(std::move(treelets)),
      leaves_out_(leaves_out) {
  constexpr std::size_t kUsualStackDepth = 128;
  map_reads_.reserve(TrvConfig::kMapReads);
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
  if (!can_issue_ || map_reads_.size() == TrvConfig::kMapReads) {
    stats_.dropped += 1;
    return;
  }
  last_treelet_ = treelet;
  map_reads_.push_back({treelet, slot, treelets_->line_of_entry(node)});
}

bool NodePrefetcher::advance_map_read(MapRead& read) {
  read.is_missing = false;
  stats_.map_reads += 1;
  if (!read.in_entry && read.line == treelets_->last_line_of_list(read.treelet)) {
    for (const std::uint32_t link : treelets_->links_below_root(read.treelet)) queue_link(link, read.slot);
    return false;
  }
  read.line = read.in_entry ? treelets_->first_line_of_list(read.treelet) : read.line + kLineBytes;
  read.in_entry = false;
  return true;
}

void NodePrefetcher::read_map(FetchStage& fetch, std::uint64_t cycle) {
  const auto read = std::ranges::find_if(map_reads_, [](const MapRead& waiting) { return !waiting.is_missing; });
  const L1Cache::UnitRead found = fetch.read_for_unit(read->line, fetch.slot_tile(read->slot), cycle);
  if (!found.is_hit) {
    stats_.map_misses += 1;
    stats_.map_fills += found.is_request ? 1 : 0;
    read->is_missing = true;
  } else if (!advance_map_read(*read)) {
    map_reads_.erase(read);
  }
}

void NodePrefetcher::fill_line(Addr line) {
  std::erase_if(map_reads_,
                [&](MapRead& read) { return read.is_missing && read.line == line && !advance_map_read(read); });
}

void NodePrefetcher::queue_link(std::uint32_t link, std::uint32_t slot) {
  if (traces::is_instance(link)) return queue_line(tree_.line_of_instance(traces::link_instance(link)), slot);
  if (traces::is_leaf(link)) {
    if (leaves_out_ == nullptr || leaves_.size() == TrvConfig::kPrefetchQueue) {
      stats_.dropped += 1;
    } else {
      leaves_.push_back({link, slot});
    }
    return;
  }
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
  if (!fetch.can_prefetch()) return false;
  if (reads_map()) {
    read_map(fetch, cycle);
    return true;
  }
  if (queue_.empty()) return false;
  const Queued next = queue_.front();
  queue_.pop_front();
  stats_.probes += 1;
  stats_.requests += fetch.prefetch_line(next.line, fetch.slot_tile(next.slot), cycle);
  return true;
}

bool NodePrefetcher::send_leaf(const FetchStage& fetch, sim::Time now) {
  if (leaves_.empty() || !leaves_out_->can_push(now)) return false;
  const QueuedLeaf next = leaves_.front();
  leaves_.pop_front();
  leaves_out_->push(now, {traces::leaf_first(next.link), static_cast<std::uint8_t>(traces::leaf_count(next.link)),
                          fetch.slot_tile(next.slot)});
  stats_.leaves += 1;
  return true;
}

sim::Time NodePrefetcher::next_wake(const FetchStage& fetch, sim::Time next) const {
  if (fetch.can_prefetch() && (!queue_.empty() || reads_map())) return next;
  return leaves_.empty() ? sim::kNever : std::max(next, leaves_out_->push_at());
}

}  // namespace hw
