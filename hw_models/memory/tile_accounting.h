#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "hw_models/memory/observer.h"

namespace hw {

/// When and where a tile was worked on, and what was done for it in units that tiles share. The requester is charged.
struct TileAccount {
  std::uint32_t core = 0;
  sim::Time dispatched = 0, finished = 0;
  std::uint64_t srp_cycles = 0;  ///< cycles of loops on the array, from switch to drain; shared by a loop's items
  std::array<std::uint64_t, kRequesterKinds> lines{};  ///< requested from the memory side, or written to it
  std::uint64_t l2_hits = 0, l2_misses = 0, l2_fills = 0, l2_writes = 0;
  std::uint64_t dram_reads = 0, dram_writes = 0, activates = 0;  ///< in lines; rows opened
};

/// Observer that keeps an account of each tile, in dispatch order, and one of all that is done for no tile.
class TileAccounting final : public Observer {
 public:
  /// Reserves space for `tiles` accounts.
  explicit TileAccounting(std::size_t tiles) { accounts_.reserve(tiles); }
  TileAccounting(const TileAccounting&) = delete;
  TileAccounting& operator=(const TileAccounting&) = delete;

  void on_event(const Event& event) override;

  const std::vector<TileAccount>& tiles() const { return accounts_; }
  /// Hands over the accounts when the run is finished.
  std::vector<TileAccount> take_tiles() { return std::move(accounts_); }
  const TileAccount& rest() const { return rest_; }

 private:
  TileAccount& of(TileTag tile) {
    if (tile == kNoTile) [[unlikely]]
      return rest_;
    const std::size_t newest = accounts_.size() - 1;
    return accounts_[newest - ((newest - tile) & kTileTagMask)];
  }

  std::vector<TileAccount> accounts_;
  TileAccount rest_;
};

}  // namespace hw
