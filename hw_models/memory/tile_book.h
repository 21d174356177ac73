#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <utility>
#include <vector>

#include "hw_models/memory/messages.h"
#include "sim/time.h"

namespace hw {

/// Purpose that a line is asked for.
enum class Asker : std::uint8_t {
  kNodes,      ///< the L1s of traversal units
  kTriangles,  ///< the L1 of an intersection unit
  kShading,    ///< the data cache of a shader core
  kTransfers,  ///< a DMA
  kRecords,    ///< rays and hits on their way through memory
  kRaster,     ///< a rasteriser
  kCount
};
inline constexpr std::size_t kAskers = static_cast<std::size_t>(Asker::kCount);
constexpr std::array<std::string_view, kAskers> names_of(Asker) {
  return {"nodes", "triangles", "shading", "transfers", "records", "raster"};
}

/// When and where a tile was worked on, and what was done for it in units that tiles share. Who asks is charged.
struct TileAccount {
  std::uint32_t core = 0;
  sim::Time dispatched = 0, finished = 0;
  std::uint64_t srp_cycles = 0;  ///< cycles of loops on the array, from switch to drain; shared by a loop's items
  std::array<std::uint64_t, kAskers> lines{};  ///< asked of the memory side, or written to it
  std::uint64_t l2_hits = 0, l2_misses = 0, l2_fills = 0, l2_writes = 0;
  std::uint64_t dram_reads = 0, dram_writes = 0, activates = 0;  ///< in lines; rows opened
};

/// Accounts of a frame's tiles, in the order in which they were handed out, and one of all that no tile asked for.
/// Units add to it as they work; nothing of the machine ever reads it.
class TileBook {
 public:
  /// Room for so many tiles is made at once.
  explicit TileBook(std::size_t tiles) { accounts_.reserve(tiles); }
  TileBook(const TileBook&) = delete;
  TileBook& operator=(const TileBook&) = delete;

  /// The next tile of the list goes to a core. Its name is that of an earlier one whose last request has long been
  /// answered.
  Owner open(std::uint32_t core, sim::Time now) {
    accounts_.push_back({.core = core, .dispatched = now});
    return static_cast<Owner>((accounts_.size() - 1) & kOwnerMask);
  }
  void close(Owner owner, sim::Time now) { of(owner).finished = now; }
  /// One more of that kind; out of line and apart, so that machines without a book pay for a comparison alone.
  [[gnu::cold, gnu::noinline]] void count(Owner owner, std::uint64_t TileAccount::*kind);
  /// A line more that was asked for; for ports that tell those with a book from those without (CorePort::tick()).
  void count(Owner owner, Asker asker) { of(owner).lines[static_cast<std::size_t>(asker)] += 1; }
  TileAccount& of(Owner owner) {
    if (owner == kNoOwner) [[unlikely]]
      return rest_;
    const std::size_t newest = accounts_.size() - 1;
    return accounts_[newest - ((newest - owner) & kOwnerMask)];
  }

  /// Number among all tiles of the one that is named so, given that of another which was in flight at the same time.
  static std::uint32_t number_near(Owner owner, std::uint32_t other) {
    const std::uint32_t ahead = (owner - other) & kOwnerMask;
    return ahead <= kOwnerMask / 2 ? other + ahead : other + ahead - (kOwnerMask + 1);
  }

  const std::vector<TileAccount>& tiles() const { return accounts_; }
  /// When the run is over.
  std::vector<TileAccount> take_tiles() { return std::move(accounts_); }
  const TileAccount& rest() const { return rest_; }

 private:
  static constexpr std::uint32_t kOwnerMask = 0x7fff;  ///< far more than can be in flight
  static_assert(kNoOwner > kOwnerMask);

  std::vector<TileAccount> accounts_;
  TileAccount rest_;
};

}  // namespace hw
