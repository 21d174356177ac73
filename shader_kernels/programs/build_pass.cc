#include "shader_kernels/programs/build_pass.h"

#include <utility>

#include "shader_kernels/programs/build_kernels.h"
#include "shader_kernels/programs/pose_kernels.h"

namespace kernels {

namespace {

constexpr std::uint32_t kBatchSpace = 64 * 1024;  // bytes of the tile buffer for a batch of kernels that build trees

/// Returns the bytes from the beginning of region kSamples to that of region kBuild. Each region begins on a new line.
std::uint64_t build_offset(const FrameRequirements& needs) {
  constexpr std::uint64_t kLine = 64;
  std::uint64_t bytes = 0;
  for (const traces::Region region : {traces::Region::kSamples, traces::Region::kRates}) {
    bytes += (needs.region_bytes[static_cast<std::size_t>(region)] + kLine - 1) / kLine * kLine;
  }
  return bytes;
}

}  // namespace

BuildPass::BuildPass(std::unique_ptr<FrameProgram> program, const traces::MemoryImage& image,
                     const traces::TreeBuilds& builds, std::uint32_t frame)
    : LeadingPass(std::move(program), frame),
      builds_(builds),
      passes_(kBatchSpace, build_offset(LeadingPass::requirements())) {
  add_pose_passes(builds.pose, passes_);
  if (!has_unit()) add_build_passes(image, builds, passes_);
}

FrameRequirements BuildPass::requirements() const {
  FrameRequirements needs = LeadingPass::requirements();
  needs.region_bytes[static_cast<std::size_t>(traces::Region::kBuild)] = passes_.scratch_bytes();
  if (has_unit()) {
    needs.build = builds_.sizes;
  } else {
    needs.region_bytes[static_cast<std::size_t>(traces::Region::kTree)] = end_of_trees(builds_);
  }
  return needs;
}

void BuildPass::record_entry(std::uint32_t entry, StreamBuilder& stream, TileResult& out) const {
  const std::uint32_t first_build = passes_.entry_count();
  if (entry < first_build) return passes_.record_entry(entry, stream, out.work);
  const traces::TreeBuild& build = builds_.trees[entry - first_build];
  traces::set_build_arrays(build, out.work);
  stream.add_build(build.items);
  out.work.after_all = entry == first_build && first_build > 0;
}

}  // namespace kernels
