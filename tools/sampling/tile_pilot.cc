#include "tools/sampling/tile_pilot.h"

#include <algorithm>

#include "hw_models/frame/tile_lines.h"
#include "hw_models/machines/gpu_config.h"

namespace tools {
namespace {

// Latencies of a tile alone on the machine: start of a chunk, transfer of a ray to the T&I unit and back, and a step of
// the longest ray with cache hits.
constexpr double kLaunchCycles = 10, kRayCycles = 20, kStepCycles = 12;

/// Reads a line; true if it was a hit.
bool read(hw::CacheTags& tags, hw::Addr line) {
  if (tags.probe(line)) return true;
  tags.fill(line);
  return false;
}

}  // namespace

TilePilot::TilePilot(const hw::GpuConfig& config, const traces::Layout& layout,
                     std::span<const hw::KernelSchedule> kernels, double thinning, double slots)
    : config_(config),
      layout_(layout),
      kernels_(kernels),
      thinning_(thinning),
      slots_(slots),
      srp_cycle_(static_cast<double>(config.clocks.srp.clock().period()) /
                 static_cast<double>(config.clocks.tni.clock().period())),
      l2_(config.l2.cache) {
  for (std::uint32_t c = 0; c < config.cores; ++c) {
    cores_.push_back({std::vector<hw::CacheTags>(config.tni.trvs, hw::CacheTags(config.tni.trv.l1)),
                      hw::CacheTags(config.tni.ist.l1), hw::CacheTags(config.srp.data_cache)});
  }
}

TileTraits TilePilot::look(const traces::TileWork& work) {
  Core& core = cores_[work.tile % cores_.size()];
  steps_.assign(work.ray_begin.size(), 0);
  std::uint64_t visits = 0, l1_misses = 0, data_misses = 0, l2_misses = 0;
  const auto second_level = [&](hw::Addr line) { l2_misses += !read(l2_, line); };
  const std::size_t trvs = core.trvs.size();
  hw::for_each_line(
      work, layout_,
      [&](std::uint32_t ray, hw::Addr line) {
        visits += 1;
        steps_[ray] += 1;
        if (read(core.trvs[ray % trvs], line)) return;
        l1_misses += 1;
        second_level(line);
      },
      [&](hw::Addr line) {
        if (read(core.ist, line)) return;
        l1_misses += 1;
        second_level(line);
      },
      [&](hw::Addr line) {
        if (read(core.data, line)) return;
        data_misses += 1;
        second_level(line);
      });
  TileTraits t{.tiles = 1,
               .visits = thinning_ * static_cast<double>(visits),
               .l1_misses = thinning_ * static_cast<double>(l1_misses),
               .data_misses = thinning_ * static_cast<double>(data_misses),
               .l2_misses = thinning_ * static_cast<double>(l2_misses)};
  std::uint64_t tests = 0;
  for (std::size_t i = 0; i < work.ray_begin.size(); ++i) {
    for (const std::uint32_t* step = &work.walk[work.ray_begin[i]]; traces::kind_of(*step) != traces::StepKind::kEnd;
         ++step) {
      if (traces::kind_of(*step) != traces::StepKind::kLeaf || traces::is_enter(*step)) continue;
      tests += traces::count_of(*step);
      steps_[i] += traces::count_of(*step);
      ++step;
    }
  }
  t.tests = thinning_ * static_cast<double>(tests);
  for (const traces::WorkNode& node : work.nodes) {
    if (node.kind == traces::WorkNode::Kind::kLaunch)
      t.array += thinning_ * static_cast<double>(node.items + node.idle) * kernels_[node.kernel].ii;
  }
  t.spills = spills(work);
  t.path = path(work);
  return t;
}

double TilePilot::spills(const traces::TileWork& work) {
  made_.assign(work.nodes.size(), 0);
  for (const traces::WorkNode& node : work.nodes) {
    if (node.kind == traces::WorkNode::Kind::kRays) made_[node.inputs.front().node] += thinning_ * node.items;
  }
  double spilled = 0;
  for (const double rays : made_) spilled += std::max(0.0, rays - slots_);
  return spilled;
}

double TilePilot::path(const traces::TileWork& work) {
  done_.assign(work.nodes.size(), 0);
  double last = 0;
  for (std::size_t n = 0; n < work.nodes.size(); ++n) {
    const traces::WorkNode& node = work.nodes[n];
    double at = 0;
    for (const traces::Edge& edge : node.inputs) at = std::max(at, done_[edge.node]);
    if (node.kind == traces::WorkNode::Kind::kLaunch) {
      const hw::KernelSchedule& kernel = kernels_[node.kernel];
      at += kLaunchCycles + srp_cycle_ * (kernel.depth + thinning_ * (node.items + node.idle) * kernel.ii);
    } else if (node.kind == traces::WorkNode::Kind::kRays) {
      const auto first = steps_.begin() + node.first;
      const std::uint32_t longest = *std::max_element(first, first + node.items);
      double all = 0;
      for (std::uint32_t i = 0; i < node.items; ++i) all += first[i];
      at += kRayCycles + std::max(kStepCycles * longest, thinning_ * all / config_.tni.trvs);
    }
    done_[n] = at;
    last = std::max(last, at);
  }
  return last;
}

double TilePilot::cost(const TileTraits& t) const {
  const double cores = config_.cores;
  return (0.8 * t.array * srp_cycle_ + 0.9 * t.tests + 0.3 * t.visits / config_.tni.trvs + 0.8 * t.data_misses +
          240 * t.tiles) /
             cores +
         0.15 * t.l2_misses;
}

}  // namespace tools
