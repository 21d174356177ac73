#include "hw_models/srp/srp.h"

namespace hw {

void Srp::start_raster(std::uint32_t tile, std::uint32_t node) {
  raster_.push_back({&tiles_[tile].work(), node, handle_of(tile, node), tiles_[tile].owner()});
  if (tiles_[tile].is_awaited(node)) transfers_awaited_ += 1;
}

/// Hands nodes to the rasteriser and takes them back.
void Srp::meet_rasteriser(sim::Time now) {
  if (links_.raster_in->can_pop(now)) {
    const std::uint32_t tag = links_.raster_in->pop(now).tag;
    const std::uint32_t tile = tile_of_handle(tag), node = index_of_handle(tag);
    const traces::WorkNode& done = tiles_[tile].node(node);
    if (done.kind == traces::WorkNode::Kind::kRaster) {
      buffer_.write((std::uint64_t{done.items} * frame_.plane_bytes + kAccess - 1) / kAccess);
    }
    if (tiles_[tile].is_awaited(node)) transfers_awaited_ -= 1;
    finish_items(now, tile, node, done.items);
  }
  if (raster_.empty() || !links_.raster_out->can_push(now)) return;
  links_.raster_out->push(now, raster_.front());
  raster_.pop_front();
}

}  // namespace hw
