#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "hw_models/memory/observer.h"

namespace hw {

/// Account of one tile: its core, its times, and what it used of the units that all tiles share. A request is charged
/// to the tile that causes it.
struct TileAccount {
  std::uint32_t core = 0;
  sim::Time dispatched = 0, finished = 0;
  std::uint64_t srp_cycles = 0;  ///< cycles of loops on the array, from switch to drain, divided among a loop's items
  std::array<std::uint64_t, kRequesterKinds>
      lines{};  ///< lines read from or written to the memory side, by kind of requester
  std::uint64_t l2_hits = 0, l2_misses = 0, l2_fills = 0, l2_writes = 0;
  std::uint64_t dram_reads = 0, dram_writes = 0, activates = 0;  ///< lines read and written; rows opened
};

/// Observer that charges events to tiles: one account for each tile, in dispatch order, and one for events without a
/// tile.
class TileAccounting final : public Observer {
 public:
  /// Reserves memory for the accounts of `tiles` tiles.
  explicit TileAccounting(std::size_t tiles) { accounts_.reserve(tiles); }
  TileAccounting(const TileAccounting&) = delete;
  TileAccounting& operator=(const TileAccounting&) = delete;

  void on_event(const Event& event) override;

  const std::vector<TileAccount>& tiles() const { return accounts_; }
  /// Moves the accounts of all tiles out of this object. Call at the end of a run.
  std::vector<TileAccount> take_accounts() { return std::move(accounts_); }
  const TileAccount& untiled_account() const { return rest_; }

 private:
  TileAccount& account_of(TileTag tile) {
    if (tile == kNoTile) [[unlikely]]
      return rest_;
    const std::size_t newest = accounts_.size() - 1;
    return accounts_[newest - ((newest - tile) & kTileTagMask)];
  }

  std::vector<TileAccount> accounts_;
  TileAccount rest_;
};

}  // namespace hw
