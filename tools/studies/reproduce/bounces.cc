#include "tools/studies/reproduce/bounces.h"

#include <algorithm>

#include "hw_models/machines/ray_machine.h"
#include "hw_models/tni/treelets.h"
#include "traces/accel/bvh_tracer.h"
#include "traces/walk.h"

namespace tools::reproduce {
namespace {

using traces::RayKind;

/// Tracer that keeps a copy of all rays by bounce. Only for one thread.
class BounceRecorder final : public traces::Tracer {
 public:
  explicit BounceRecorder(const traces::MemoryImage& image) : tracer_(image) {}

  void trace(std::span<const traces::Ray> rays, RayKind kind, std::span<traces::Hit> hits,
             traces::WalkSink* walk) const override {
    tracer_.trace(rays, kind, hits, walk);
    if (kind == RayKind::kPrimary) {
      bounce_ = 0;
    } else if (kind != RayKind::kShadow && last_ != RayKind::kReflection) {
      bounce_ += 1;
    }
    if (bounces_.size() <= bounce_) bounces_.resize(bounce_ + 1);
    BounceRays& bounce = bounces_[bounce_];
    std::vector<traces::Ray>& list = kind == RayKind::kShadow ? bounce.shadows : bounce.paths;
    list.insert(list.end(), rays.begin(), rays.end());
    last_ = kind == RayKind::kRefraction ? RayKind::kReflection : kind;
  }
  std::vector<BounceRays> take_bounces() { return std::move(bounces_); }

 private:
  const traces::BvhTracer tracer_;
  mutable std::vector<BounceRays> bounces_;
  mutable std::size_t bounce_ = 0;
  mutable RayKind last_ = RayKind::kPrimary;  ///< kind of the last rays; kReflection also for refracted rays
};

}  // namespace

std::vector<BounceRays> record_bounces(const Inputs& inputs, const kernels::ProgramSpec& program) {
  BounceRecorder recorder(inputs.image);
  render_frame(inputs, program, recorder, 1);
  return recorder.take_bounces();
}

PlayedRays play_rays(const Inputs& inputs, std::span<const traces::Ray> rays, RayKind kind) {
  hw::RayMachine machine(*inputs.config.gpu, inputs.image, inputs.parents, rays, kind,
                         [](const hw::RayProgress&) { return true; });
  machine.run();
  return {machine.unit_reports(), machine.elapsed_cycles()};
}

double lines_per_thousand_rays(const Inputs& inputs, std::span<const traces::Ray> rays, RayKind kind) {
  constexpr std::size_t kBlock = 1000;
  const hw::TreeInMemory tree = hw::tree_in_memory(inputs.image, inputs.parents);
  const traces::BvhTracer tracer(inputs.image);
  std::vector<std::uint32_t> words, begin;
  std::vector<traces::Hit> hits(kBlock);
  std::vector<hw::Addr> lines, of_node;
  std::size_t blocks = 0, distinct = 0;
  for (; rays.size() >= kBlock; rays = rays.subspan(kBlock)) {
    words.clear(), begin.clear(), lines.clear();
    traces::WalkSink sink{words, begin};
    tracer.trace(rays.first(kBlock), kind, hits, &sink);
    for (std::size_t i = 0; i < words.size(); ++i) {
      if (traces::kind_of(words[i]) == traces::StepKind::kVisit) {
        of_node.clear();
        hw::append_node_lines(tree, traces::node_of(words[i]), of_node);
        lines.insert(lines.end(), of_node.begin(), of_node.end());
        if (traces::is_wide(words[i])) ++i;  // skips the word of hits
      } else if (traces::kind_of(words[i]) == traces::StepKind::kLeaf && !traces::is_enter(words[i])) {
        ++i;  // skips the word of exit phases
      }
    }
    std::ranges::sort(lines);
    distinct += static_cast<std::size_t>(std::unique(lines.begin(), lines.end()) - lines.begin());
    blocks += 1;
  }
  return blocks == 0 ? 0 : static_cast<double>(distinct) / static_cast<double>(blocks);
}

}  // namespace tools::reproduce
