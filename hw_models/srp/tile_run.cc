#include "hw_models/srp/tile_run.h"

#include <algorithm>
#include <cassert>

#include "sim/error.h"

namespace hw {

using traces::Edge;
using traces::WorkNode;

namespace {

/// True if the items of a work graph node are rays, or samples to rasterise, which occupy ray slots of the tile buffer.
/// The launch that produces them allocates the slots.
bool has_ray_slots(const WorkNode& node) {
  return node.kind == WorkNode::Kind::kRays || node.kind == WorkNode::Kind::kRaster;
}

/// Reserves memory for a typical tile, or twice the needed amount if that is more, so that later tiles rarely allocate.
template <class T>
void reserve_with_slack(std::vector<T>& vector, std::size_t needed) {
  constexpr std::size_t kUsual = 4096;
  if (vector.capacity() < needed) vector.reserve(std::max(kUsual, 2 * needed));
}

}  // namespace

void TileRun::start_tile(const traces::TileWork& work, std::uint32_t chunk_items_limit, std::uint32_t missing_borders,
                         TileTag tag) {
  if (work.ray_begin.size() > kMaxRays) {
    throw sim::InputError(
        "render.tile: a tile has more than 16777216 rays; allowed: a smaller tile, depth or number of lights");
  }
  work_ = &work;
  chunk_ = chunk_items_limit;
  missing_ = missing_borders;
  tile_tag_ = tag;
  awaits_border_ = false;
  nodes_left_ = static_cast<std::uint32_t>(work.nodes.size());
  reserve_with_slack(progress_, work.nodes.size());
  reserve_with_slack(batch_of_ray_, work.ray_begin.size());
  reserve_with_slack(transfers_, work.nodes.size());
  reserve_with_slack(chunk_left_, work.ray_begin.size() / chunk_items_limit + work.nodes.size());
  progress_.assign(work.nodes.size(), {});
  batch_of_ray_.resize(work.ray_begin.size());
  transfers_.clear();
  chunk_left_.clear();
  for (std::uint32_t n = 0; n < node_count(); ++n) {
    Progress& p = progress_[n];
    const WorkNode& w = node(n);
    assert(w.items > 0);
    p.follows_rays = std::ranges::any_of(
        w.inputs, [&](const Edge& e) { return has_ray_slots(node(e.node)) || progress_[e.node].follows_rays; });
    if (w.kind == WorkNode::Kind::kRays) {
      assert(w.inputs.size() == 1 && w.inputs.front().kind == Edge::Kind::kEach && "rays come from one launch each");
      progress_[producing_launch(n)].batches += 1;
      p.first_chunk = static_cast<std::uint32_t>(chunk_left_.size());
      for (std::uint32_t left = w.items; left > 0; left -= std::min(left, chunk_items_limit)) {
        chunk_left_.push_back(std::min(left, chunk_items_limit));
      }
      std::fill_n(batch_of_ray_.begin() + w.first, w.items, n);
    } else {
      for (const Edge& e : w.inputs) progress_[e.node].readers += 1;
      if (w.kind != WorkNode::Kind::kLaunch) transfers_.push_back(n);
      if (w.kind == WorkNode::Kind::kRaster) progress_[producing_launch(n)].batches += 1;
    }
  }
  collect_batches();
}

/// Fills `batches_` with the batches of every launch of the tile, launch by launch, in graph order.
void TileRun::collect_batches() {
  std::uint32_t next = 0;
  for (Progress& p : progress_) {
    p.first_batch = next;
    next += p.batches;
    p.batches = 0;
  }
  reserve_with_slack(batches_, next);
  batches_.resize(next);
  for (std::uint32_t n = 0; n < node_count(); ++n) {
    if (!has_ray_slots(node(n))) continue;
    Progress& p = progress_[producing_launch(n)];
    batches_[p.first_batch + p.batches++] = n;
  }
}

std::uint32_t TileRun::available_items(std::uint32_t node_id, const Edge& edge) const {
  const Progress& from = progress_[edge.node];
  if (edge.kind == Edge::Kind::kAll) return releases_dependents(edge.node) ? node(node_id).items : 0;
  const std::uint32_t prefix = node(edge.node).kind == WorkNode::Kind::kRays ? from.prefix : from.done;
  const std::uint32_t map = node(node_id).sources;
  if (map == WorkNode::kNone) return prefix;
  const auto first = work_->sources.begin() + map;
  return static_cast<std::uint32_t>(std::lower_bound(first, first + node(node_id).items, prefix) - first);
}

std::uint32_t TileRun::next_chunk_size(std::uint32_t launch) const {
  return std::min(chunk_, total_items(launch) - done_items(launch));
}

bool TileRun::is_ready(std::uint32_t launch) const {
  if (is_complete(launch)) return false;
  const std::uint32_t want = std::min(done_items(launch) + next_chunk_size(launch), node(launch).items);
  return std::ranges::all_of(node(launch).inputs, [&](const Edge& e) { return available_items(launch, e) >= want; });
}

bool TileRun::has_released_inputs(std::uint32_t node_id) const {
  return std::ranges::all_of(node(node_id).inputs, [&](const Edge& e) { return releases_dependents(e.node); });
}

std::uint32_t TileRun::count_produced_rays(std::uint32_t launch, std::uint32_t first, std::uint32_t items) const {
  std::uint32_t rays = 0;
  for (const std::uint32_t batch : batches_of(launch)) {
    const WorkNode& w = node(batch);
    if (w.sources == WorkNode::kNone) {
      rays += non_idle_items(launch, first, items);
      continue;
    }
    const auto begin = work_->sources.begin() + w.sources;
    const auto low = std::lower_bound(begin, begin + w.items, first);
    rays += static_cast<std::uint32_t>(std::lower_bound(low, begin + w.items, first + items) - low);
  }
  return rays;
}

std::uint32_t TileRun::finish_items(std::uint32_t node_id, std::uint32_t items) {
  progress_[node_id].done += items;
  assert(progress_[node_id].done <= total_items(node_id));
  if (!is_complete(node_id)) return 0;
  nodes_left_ -= 1;
  std::uint32_t freed = 0;
  for (const Edge& e : node(node_id).inputs) {
    if (--progress_[e.node].readers == 0 && has_ray_slots(node(e.node))) freed += node(e.node).items;
  }
  return freed;
}

bool TileRun::finish_ray(std::uint32_t ray) {
  const std::uint32_t n = batch_of(ray);
  Progress& p = progress_[n];
  const std::uint32_t index = ray - node(n).first;
  p.done += 1;
  bool may_be_ready = false;
  std::uint32_t* const chunk_left = &chunk_left_[p.first_chunk];
  if (--chunk_left[index / chunk_] == 0) {
    while (p.prefix < node(n).items && chunk_left[p.prefix / chunk_] == 0) {
      p.prefix = std::min(p.prefix + chunk_, node(n).items);
      may_be_ready = true;
    }
  }
  if (p.done == node(n).items) {
    nodes_left_ -= 1;
    may_be_ready = true;
  }
  return may_be_ready;
}

}  // namespace hw
