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

/// Kind of unit that requests a line.
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

// Events of a machine. `tile` is the tile that caused the event; kNoTile: none.

/// The dispatcher has sent a tile to a core. Tags are unique among tiles in flight.
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
/// A tile has occupied a slot of a core, or has left it.
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
  sim::Time begin = 0, configured = 0, start = 0,
            end = 0;         ///< of the switch, the bank conflicts, the loop; and its end
  sim::Time stalled = 0;     ///< stall time within the loop, for lines of the data cache
  std::uint64_t cycles = 0;  ///< shader core cycles charged to the kernel
  std::uint32_t items = 0;
  std::uint32_t launches = 0;  ///< chunks of launches in the loop
  TileTag tile = kNoTile;      ///< tile of the first chunk
};
/// A tile's share of a loop's cycles.
struct LoopCharged {
  TileTag tile = kNoTile;
  std::uint64_t cycles = 0;
};
/// The first ray of a batch has entered the T&I unit, or its last hit has returned. `rays`: all rays of the core in the
/// unit at that time.
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
/// A core port has passed on a request to read or write a line.
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
/// A channel has opened a row for a request.
struct RowActivated {
  TileTag tile = kNoTile;
};
/// State of the bank that a request of a channel found.
enum class RowState : std::uint8_t { kHit, kMiss, kConflict };
/// A channel has booked the data of a request. `end`: when the last of them will have passed the bus.
struct DramServed {
  MemRequest request;
  RowState row = RowState::kHit;
  sim::Time end = 0;
};

using Event =
    std::variant<TileDispatched, TileFinished, TileStarted, TileEnded, LoopEnded, LoopCharged, BatchStarted, BatchEnded,
                 TransferEnded, LineRequested, L2LookedUp, L2Filled, L2Written, RowActivated, DramServed>;

/// Receives the events of a machine as they happen. It does not change the simulation.
class Observer {
 public:
  virtual ~Observer() = default;
  virtual void on_event(const Event& event) = 0;
};

/// Sends an event to a unit's observer. Out of line, so that without an observer a unit pays only one test.
template <class E>
[[gnu::cold, gnu::noinline]] void notify(Observer& observer, const E& event) {
  observer.on_event(event);
}

/// Handler of events for std::visit: one lambda for each handled kind; other kinds are ignored.
template <class... Handlers>
struct HandleEvents : Handlers... {
  using Handlers::operator()...;
  template <class Other>
  requires(!(std::is_invocable_v<Handlers, const Other&> || ...)) void operator()(const Other&) const {}
};
template <class... Handlers>
HandleEvents(Handlers...) -> HandleEvents<Handlers...>;

/// Forwards events to several observers.
class ObserverList final : public Observer {
 public:
  /// Adds an observer; null is ignored.
  void add(Observer* observer) {
    if (observer != nullptr) observers_.push_back(observer);
  }
  /// Returns the observer for the machine; null if the list is empty.
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
