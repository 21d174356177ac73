#include "shader_kernels/programs/build_pass.h"

#include <utility>

namespace kernels {

namespace {

constexpr std::uint32_t kBatchSpace = 64 * 1024;  // bytes of the tile buffer for a batch of kernels that build trees

}  // namespace

BuildPass::BuildPass(std::unique_ptr<FrameProgram> program, const traces::MemoryImage& image,
                     const traces::TreeBuilds& builds, std::uint32_t frame)
    : LeadingPass(std::move(program), frame), builds_(builds) {
  if (builds.engine == traces::BuildEngine::kSrp && !builds.trees.empty()) kernels_.emplace(image, kBatchSpace);
}

FrameRequirements BuildPass::requirements() const {
  FrameRequirements needs = LeadingPass::requirements();
  if (builds_.engine == traces::BuildEngine::kUnit) needs.build = builds_.sizes;
  if (kernels_) {
    needs.region_bytes[static_cast<std::size_t>(traces::Region::kBuild)] = kernels_->scratch_bytes();
    needs.region_bytes[static_cast<std::size_t>(traces::Region::kTree)] = kernels_->tree_bytes();
  }
  return needs;
}

void BuildPass::record_entry(std::uint32_t entry, StreamBuilder& stream, TileResult& out) const {
  if (kernels_) return kernels_->record_entry(entry, stream, out.work);
  const traces::TreeBuild& build = builds_.trees[entry];
  traces::set_build_arrays(build, out.work);
  stream.add_build(build.items);
}

}  // namespace kernels
