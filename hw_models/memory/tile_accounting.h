#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "hw_models/memory/observer.h"

namespace hw {

/// Account of one tile: core, times, and use of shared units. A request is charged to the tile that causes it.
struct TileAccount {
  std::uint32_t core = 0;
  sim::Time dispatched = 0, finished = 0;
  /// Cycles of the shader core's array that are charged to the tile. The cycles of a loop, from kernel switch to drain,
  /// are divided among the loop's items.
  std::uint64_t srp_cycles = 0;
  /// Lines that the tile has read from or written to the memory system, by RequesterKind.
  std::array<std::uint64_t, kRequesterKinds> lines{};
  std::uint64_t l2_hits = 0, l2_misses = 0, l2_fills = 0, l2_writes = 0;
  std::uint64_t dram_reads = 0, dram_writes = 0, activates = 0;  ///< DRAM lines read and written; DRAM rows opened
};

/// Observer that charges events to tiles: one account per tile, in dispatch order, and one account for events without a
/// tile.
class TileAccounting final : public Observer {
 public:
  /// Reserves memory for the accounts of `tiles` tiles.
  explicit TileAccounting(std::size_t tiles) { accounts_.reserve(tiles); }
  TileAccounting(const TileAccounting&) = delete;
  TileAccounting& operator=(const TileAccounting&) = delete;

  void on_event(const Event& event) override;

  const std::vector<TileAccount>& tiles() const { return accounts_; }
  /// Moves the accounts of all tiles, in dispatch order, out of this object. Call at the end of a run.
  std::vector<TileAccount> take_accounts() { return std::move(accounts_); }
  const TileAccount& account_without_tile() const { return rest_; }

 private:
  void add_account(const TileDispatched& event);
  TileAccount& account_of(TileTag tile) {
    if (tile == kNoTile) [[unlikely]]
      return rest_;
    return accounts_[newest_ - ((newest_ - tile) & kTileTagMask)];
  }

  std::vector<TileAccount> accounts_;
  std::size_t newest_ = 0;  ///< index of the last account in `accounts_`
  TileAccount rest_;
};

}  // namespace hw
