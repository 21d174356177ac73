#include "hw_models/memory/tile_accounting.h"

namespace hw {

void TileAccounting::on_event(const Event& event) {
  handle_event(
      event, HandleEvents{
                 [&](const LineRequested& e) { account_of(e.tile).lines[static_cast<std::size_t>(e.requester)] += 1; },
                 [&](const L2LookedUp& e) { (e.hit ? account_of(e.tile).l2_hits : account_of(e.tile).l2_misses) += 1; },
                 [&](const DramServed& e) {
                   TileAccount& account = account_of(e.request.tile);
                   (e.request.write ? account.dram_writes : account.dram_reads) += 1;
                 },
                 [&](const L2Filled& e) { account_of(e.tile).l2_fills += 1; },
                 [&](const RowActivated& e) { account_of(e.tile).activates += 1; },
                 [&](const L2Written& e) { account_of(e.tile).l2_writes += 1; },
                 [&](const LoopCharged& e) { account_of(e.tile).srp_cycles += e.cycles; },
                 [&](const TileDispatched& e) { add_account(e); },
                 [&](const TileFinished& e) { account_of(e.tile).finished = e.at; },
             });
}

/// Adds the account of a tile. Not inlined, so that the handlers of frequent events need no stack frame.
[[gnu::noinline]] void TileAccounting::add_account(const TileDispatched& event) {
  newest_ = accounts_.size();
  accounts_.push_back({.core = event.core, .dispatched = event.at});
}

}  // namespace hw
