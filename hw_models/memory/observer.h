#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <type_traits>
#include <variant>
#include <vector>

#include "hw_models/memory/messages.h"
#include "sim/time.h"
#include "traces/stream.h"

namespace hw {

/// Purpose for which a line is requested.
enum class RequesterKind : std::uint8_t {
  kNodes,      ///< the L1s of traversal units
  kTriangles,  ///< the L1 of an intersection unit
  kShading,    ///< the data cache of a shader core
  kTransfers,  ///< a DMA
  kRecords,    ///< rays and hits on their way through memory
  kRaster,     ///< a rasteriser
  kCount
};
inline constexpr std::size_t kRequesterKinds = static_cast<std::size_t>(RequesterKind::kCount);
constexpr std::array<std::string_view, kRequesterKinds> names_of(RequesterKind) {
  return {"nodes", "triangles", "shading", "transfers", "records", "raster"};
}

// Events of a machine. `tile` is the tile for which something is done, kNoTile if it is done for none.

/// The dispatcher hands a tile to a core. Tags repeat, but not among tiles in flight.
struct TileDispatched {
  TileTag tile = kNoTile;
  std::uint32_t core = 0;
  sim::Time at = 0;
};
/// The dispatcher has received the end of a tile.
struct TileFinished {
  TileTag tile = kNoTile;
  sim::Time at = 0;
};
/// A tile occupies a slot of a core, or leaves it.
struct TileStarted {
  std::uint32_t core = 0, slot = 0;
  TileTag tile = kNoTile;
  sim::Time at = 0;
};
struct TileEnded {
  std::uint32_t core = 0, slot = 0;
  sim::Time at = 0;
};
/// A loop on the array of a shader core has drained.
struct LoopEnded {
  std::uint32_t core = 0;
  traces::KernelId kernel = 0;
  sim::Time begin = 0, configured = 0, start = 0, end = 0;  ///< switch, bank conflicts, the loop itself
  sim::Time stalled = 0;                                    ///< within the loop, for lines of the data cache
  std::uint64_t cycles = 0;                                 ///< those of the shader core that are charged to the kernel
  std::uint32_t items = 0;
  std::uint32_t launches = 0;  ///< chunks of launches in it
  TileTag tile = kNoTile;      ///< that of the first
};
/// A tile's share of a loop's cycles.
struct LoopCharged {
  TileTag tile = kNoTile;
  std::uint64_t cycles = 0;
};
/// The first ray of a batch enters the T&I unit, or its last hit returns. `rays`: all that are then in the unit.
struct BatchStarted {
  std::uint32_t core = 0, slot = 0, node = 0;
  std::uint64_t rays = 0;
  sim::Time at = 0;
};
struct BatchEnded {
  std::uint32_t core = 0, slot = 0, node = 0;
  const traces::WorkNode* batch = nullptr;
  std::uint64_t rays = 0;
  sim::Time at = 0;
};
/// A DMA has finished a transfer.
struct TransferEnded {
  std::uint32_t core = 0;
  TileTag tile = kNoTile;
  Area area = Area::kPicture;
  bool to_memory = false;
  Addr base = 0;
  std::uint32_t bytes = 0;
  sim::Time begin = 0, end = 0;
};
/// A core port passes on a request, or a write, of a line.
struct LineRequested {
  TileTag tile = kNoTile;
  RequesterKind requester = RequesterKind::kNodes;
};
/// Events of an L2 bank: a read was looked up, a line was filled, a write was accepted.
struct L2LookedUp {
  TileTag tile = kNoTile;
  bool hit = false;
  sim::Time at = 0;
};
struct L2Filled {
  TileTag tile = kNoTile;
};
struct L2Written {
  TileTag tile = kNoTile;
};
/// A channel opens a row for a request.
struct RowActivated {
  TileTag tile = kNoTile;
};
/// State of the bank's row that a request of a channel found.
enum class RowState : std::uint8_t { kHit, kMiss, kConflict };
/// A channel books the data of a request; `end` is when the last of them will have passed the bus.
struct DramServed {
  MemRequest request;
  RowState row = RowState::kHit;
  sim::Time end = 0;
};

using Event =
    std::variant<TileDispatched, TileFinished, TileStarted, TileEnded, LoopEnded, LoopCharged, BatchStarted, BatchEnded,
                 TransferEnded, LineRequested, L2LookedUp, L2Filled, L2Written, RowActivated, DramServed>;

/// Receives the events of a machine as they happen. It changes nothing, and no unit depends on it.
class Observer {
 public:
  virtual ~Observer() = default;
  virtual void on_event(const Event& event) = 0;
};

/// Sends an event to a unit's observer. Out of line: units test whether they have one, and that is all it costs them
/// without one.
template <class E>
[[gnu::cold, gnu::noinline]] void notify(Observer& observer, const E& event) {
  observer.on_event(event);
}

/// Handler of some kinds of events, for std::visit: a lambda for each of them; all others are ignored.
template <class... Handlers>
struct HandleEvents : Handlers... {
  using Handlers::operator()...;
  template <class Other>
  requires(!(std::is_invocable_v<Handlers, const Other&> || ...)) void operator()(const Other&) const {}
};
template <class... Handlers>
HandleEvents(Handlers...) -> HandleEvents<Handlers...>;

/// Passes events on to several observers.
class ObserverList final : public Observer {
 public:
  /// Null is ignored.
  void add(Observer* observer) {
    if (observer != nullptr) observers_.push_back(observer);
  }
  /// Returns what a machine should be given: null if nothing observes.
  Observer* get() {
    if (observers_.size() > 1) return this;
    return observers_.empty() ? nullptr : observers_.front();
  }
  void on_event(const Event& event) override {
    for (Observer* observer : observers_) observer->on_event(event);
  }

 private:
  std::vector<Observer*> observers_;
};

}  // namespace hw
