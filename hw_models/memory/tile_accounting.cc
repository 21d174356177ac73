#include "hw_models/memory/tile_accounting.h"

namespace hw {

void TileAccounting::on_event(const Event& event) {
  std::visit(HandleEvents{
                 [&](const TileDispatched& e) { accounts_.push_back({.core = e.core, .dispatched = e.at}); },
                 [&](const TileFinished& e) { account_of(e.tile).finished = e.at; },
                 [&](const LoopCharged& e) { account_of(e.tile).srp_cycles += e.cycles; },
                 [&](const LineRequested& e) { account_of(e.tile).lines[static_cast<std::size_t>(e.requester)] += 1; },
                 [&](const L2LookedUp& e) { (e.hit ? account_of(e.tile).l2_hits : account_of(e.tile).l2_misses) += 1; },
                 [&](const L2Filled& e) { account_of(e.tile).l2_fills += 1; },
                 [&](const L2Written& e) { account_of(e.tile).l2_writes += 1; },
                 [&](const RowActivated& e) { account_of(e.tile).activates += 1; },
                 [&](const DramServed& e) {
                   TileAccount& account = account_of(e.request.tile);
                   (e.request.write ? account.dram_writes : account.dram_reads) += 1;
                 },
             },
             event);
}

}  // namespace hw
