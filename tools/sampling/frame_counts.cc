#include "tools/sampling/frame_counts.h"

#include <algorithm>
#include <memory>
#include <optional>

#include "hw_models/frame/tile_lines.h"
#include "shader_kernels/catalogue.h"
#include "shader_kernels/graph.h"
#include "tools/host/process.h"
#include "tools/run/frame/front_end.h"
#include "tools/sampling/pilot.h"
#include "traces/accel/bvh_tracer.h"

namespace tools {
namespace {

/// Largest number of trees that are built to count a sequence. Chosen: updating the tree of 600,000 triangles takes as
/// long as simulating a frame of 128x64, and counts need not be exact.
constexpr std::uint32_t kCountedTrees = 8;

/// Triangles and instances of the trees that the machine builds and refits for a frame.
struct TreeItems {
  double built = 0, refitted = 0;
};

TreeItems count_tree_items(const traces::TreeBuilds& builds) {
  TreeItems items;
  for (const traces::TreeBuild& tree : builds.trees) (tree.job.refit ? items.refitted : items.built) += tree.items;
  return items;
}

}  // namespace

FrameCounter::FrameCounter() {
  for (const kernels::KernelInfo& kernel : kernels::kernel_catalogue()) {
    operations_.push_back(kernels::count_executed_ops(kernel.graph));
  }
}

void FrameCounter::begin_frame(const traces::Layout& layout) {
  layout_ = &layout;
  frame_begin_ = tile_ + 1;
  const std::size_t lines = layout.end / hw::kLineBytes + 1;
  if (stamps_.size() < lines) stamps_.resize(lines);
  counts_ = {};
}

void FrameCounter::read_line(hw::Addr line, double& distinct) {
  const std::size_t index = line / hw::kLineBytes;
  if (index >= stamps_.size()) stamps_.resize(index + 1);
  std::uint32_t& stamp = stamps_[index];
  if (stamp == tile_) return;
  counts_.tile_lines += 1;
  if (stamp < frame_begin_) distinct += 1;
  stamp = tile_;
}

void FrameCounter::add_tile(const traces::TileWork& work) {
  tile_ += 1;
  steps_.assign(work.ray_begin.size(), 0);
  hw::for_each_line_of_tile(
      work, *layout_, 0,
      [&](std::uint32_t ray, hw::Addr line) {
        steps_[ray] += 1;
        read_line(line, counts_.tree_lines);
      },
      [&](std::uint32_t, hw::Addr line) { read_line(line, counts_.tree_lines); },
      [&](hw::Addr line) { read_line(line, counts_.data_lines); });
  for (std::size_t ray = 0; ray < work.ray_begin.size(); ++ray) {
    counts_.visits += steps_[ray];
    const std::uint32_t tests = count_tests(&work.walk[work.ray_begin[ray]]);
    counts_.tests += tests;
    steps_[ray] += tests;
  }
  if (!steps_.empty()) counts_.longest += std::ranges::max(steps_);
  for (const traces::WorkNode& node : work.nodes) {
    if (node.kind == traces::WorkNode::Kind::kLaunch) counts_.operations += operations_[node.kernel] * node.items;
  }
}

std::vector<FrameCounts> count_frames(Inputs& inputs, const kernels::ProgramSpec& spec, std::uint32_t threads,
                                      Progress* progress) {
  FrameCounter counter;
  std::vector<FrameCounts> frames;
  const std::uint32_t first = inputs.config.scene.first_frame, interval = (inputs.frames() - 1) / kCountedTrees + 1;
  const bool charges = inputs.config.build.engine != traces::BuildEngine::kHost;
  const TreeItems of_first = count_tree_items(inputs.builds);
  std::optional<TreeItems> of_moved;  // of the last updated frame
  bool is_old = false;                // the tree lacks movement
  for (std::uint32_t i = 0; i < inputs.frames(); ++i) {
    const bool moved = pose_frame(inputs, first + i);
    is_old = is_old || moved;
    if (is_old && (i % interval == 0 || i + 1 == inputs.frames() || (charges && !of_moved))) {
      update_tree(inputs, threads, progress);
      of_moved = count_tree_items(inputs.builds);
      is_old = false;
    }
    if (progress != nullptr) progress->set_phase("counting work");
    double thinning = 1;
    const std::unique_ptr<kernels::FullProgram> program = make_counting_pilot(inputs, spec, thinning);
    const traces::BvhTracer tracer(inputs.image);
    FrontEnd front_end(*program, tracer, host_threads(threads) - 1);
    counter.begin_frame(inputs.image.layout);
    while (const traces::TileWork* work = front_end.next()) {
      if (is_interrupted()) throw Interrupted{};
      counter.add_tile(*work);
      front_end.release_work(work);
    }
    FrameCounts counts = counter.counts();
    const RenderResult& function = front_end.result();
    const auto rays = [&](traces::RayKind kind) {
      return static_cast<double>(function.rays[static_cast<std::size_t>(kind)]);
    };
    counts.primary = rays(traces::RayKind::kPrimary);
    counts.shadow = rays(traces::RayKind::kShadow);
    counts.reflection = rays(traces::RayKind::kReflection);
    counts.refraction = rays(traces::RayKind::kRefraction);
    for (const auto member : FrameCounts::kAll) counts.*member *= thinning;
    const TreeItems items = i == 0 ? of_first : moved ? of_moved.value_or(TreeItems{}) : TreeItems{};
    counts.built = items.built;
    counts.refitted = items.refitted;
    frames.push_back(counts);
  }
  go_to_frame(inputs, first, threads, progress);
  return frames;
}

}  // namespace tools
