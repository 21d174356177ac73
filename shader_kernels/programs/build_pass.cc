#include "shader_kernels/programs/build_pass.h"

#include <utility>

#include "shader_kernels/programs/wavefront/tile_graph.h"

namespace kernels {

namespace {

constexpr std::uint32_t kBatchSpace = 64 * 1024;  // bytes of the tile buffer for a batch of kernels that build trees

}  // namespace

BuildPass::BuildPass(std::unique_ptr<FrameProgram> program, const traces::MemoryImage& image,
                     const traces::TreeBuilds& builds, std::uint32_t frame)
    : FrameProgram(0, 0), program_(std::move(program)), builds_(builds), frame_(frame) {
  if (builds.engine == traces::BuildEngine::kSrp && !builds.trees.empty()) kernels_.emplace(image, kBatchSpace);
}

std::uint32_t BuildPass::pass_end(std::uint32_t tile_index) const {
  return tile_index < build_count() ? build_count() : build_count() + program_->pass_end(tile_index - build_count());
}

FrameRequirements BuildPass::requirements() const {
  FrameRequirements needs = program_->requirements();
  if (builds_.engine == traces::BuildEngine::kUnit) needs.build = builds_.sizes;
  if (kernels_) {
    needs.region_bytes[static_cast<std::size_t>(traces::Region::kBuild)] = kernels_->scratch_bytes();
    needs.region_bytes[static_cast<std::size_t>(traces::Region::kTree)] = kernels_->tree_bytes();
  }
  return needs;
}

void BuildPass::begin_pass(std::uint32_t tile_index, const traces::Tracer& tracer) {
  if (tile_index >= build_count()) program_->begin_pass(tile_index - build_count(), tracer);
}

void BuildPass::run_tile(std::uint32_t tile_index, const traces::Tracer& tracer, bool record, TileResult& out) const {
  if (tile_index >= build_count()) {
    program_->run_tile(tile_index - build_count(), tracer, record, out);
    // The trees must be complete before rays read them, unless rays read other copies.
    if (tile_index == build_count() && build_count() > 0 && builds_.sizes.shadow_bytes == 0) out.work.after_all = true;
    return;
  }
  out.clear_for_pass_entry(frame_, program_->tiles() + tile_index);
  StreamBuilder stream(out.work, out.buffer.scratch.spare_nodes, record);
  if (record && kernels_) {
    kernels_->record_entry(tile_index, stream, out.work);
  } else if (record) {
    const traces::TreeBuild& build = builds_.trees[tile_index];
    traces::set_build_arrays(build, out.work);
    stream.add_build(build.items);
  }
  stream.finish();
}

void BuildPass::commit_tile(const TileResult& tile) {
  if (tile.tile < program_->tiles()) program_->commit_tile(tile);
}

}  // namespace kernels
