#pragma once
#include "hw_models/dram/dram_channel.h"
#include "hw_models/memory/l2_bank.h"
#include "hw_models/memory/tile_book.h"
#include "hw_models/srp/observer.h"

namespace hw {

/// Watchers of a machine: are told what it does while it does it, and change nothing. None of them need be there.
struct Watchers {
  TileBook* book = nullptr;  ///< gets an account of each tile
  Observer* cores = nullptr;
  L2Bank::Watcher* l2 = nullptr;
  DramChannel::Watcher* dram = nullptr;
};

}  // namespace hw
