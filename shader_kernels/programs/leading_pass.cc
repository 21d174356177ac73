#include "shader_kernels/programs/leading_pass.h"

namespace kernels {

std::uint32_t LeadingPass::pass_end(std::uint32_t tile_index) const {
  const std::uint32_t leading = leading_entries();
  return tile_index < leading ? leading : leading + program_->pass_end(tile_index - leading);
}

void LeadingPass::begin_pass(std::uint32_t tile_index, const traces::Tracer& tracer) {
  if (tile_index >= leading_entries()) program_->begin_pass(tile_index - leading_entries(), tracer);
}

void LeadingPass::run_tile(std::uint32_t tile_index, const traces::Tracer& tracer, bool record, TileResult& out) const {
  const std::uint32_t leading = leading_entries();
  if (tile_index >= leading) {
    program_->run_tile(tile_index - leading, tracer, record, out);
    if (tile_index == leading && leading > 0 && is_awaited()) out.work.after_all = true;
    return;
  }
  out.clear_for_pass_entry(frame_, program_->tiles() + tile_index);
  StreamBuilder stream(out.work, out.buffer.scratch.spare_nodes, record);
  if (record) record_entry(tile_index, stream, out);
  stream.finish();
}

void LeadingPass::commit_tile(const TileResult& tile) {
  if (tile.tile < program_->tiles()) program_->commit_tile(tile);
}

}  // namespace kernels
