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

/// Kinds of units that request memory lines.
enum class RequesterKind : std::uint8_t {
  kNodes,      ///< the L1s of traversal units
  kTriangles,  ///< the L1 of an intersection unit
  kShading,    ///< the data cache of a shader core
  kTransfers,  ///< a DMA
  kRecords,    ///< rays and hits that go through memory
  kRaster,     ///< a rasteriser
  kCount
};
inline constexpr std::size_t kRequesterKinds = static_cast<std::size_t>(RequesterKind::kCount);
constexpr std::array<std::string_view, kRequesterKinds> names_of(RequesterKind) {
  return {"nodes", "triangles", "shading", "transfers", "records", "raster"};
}

// Events of a simulated machine. `tile`: the tile that caused the event; kNoTile if no tile did.

/// Event: the tile dispatcher has sent a tile to a core. Tags are unique among tiles in flight.
struct TileDispatched {
  TileTag tile = kNoTile;
  std::uint32_t core = 0;
  sim::Time at = 0;
};
/// Event: the tile dispatcher has received a core's message that a tile is finished.
struct TileFinished {
  TileTag tile = kNoTile;
  sim::Time at = 0;
};
/// Events: a tile has occupied one of a core's tile slots, or has left it.
struct TileStarted {
  std::uint32_t core = 0, slot = 0;
  TileTag tile = kNoTile;
  sim::Time at = 0;
};
struct TileEnded {
  std::uint32_t core = 0, slot = 0;
  sim::Time at = 0;
};
/// Event: a loop on the array of a shader core has ended, with the last item out of the pipeline.
struct LoopEnded {
  std::uint32_t core = 0;
  traces::KernelId kernel = 0;
  sim::Time begin = 0, configured = 0, start = 0,
            end = 0;         ///< start of the kernel switch, of the bank conflicts and of the loop; end of the loop
  sim::Time stalled = 0;     ///< time in which the loop stalled for lines of the data cache
  std::uint64_t cycles = 0;  ///< shader core cycles charged to the kernel
  std::uint32_t items = 0;
  std::uint32_t launches = 0;  ///< chunks of launches that ran in the loop
  TileTag tile = kNoTile;      ///< tile of the first chunk
};
/// Event: a tile is charged its share of the cycles of a loop on the shader core's array.
struct LoopCharged {
  TileTag tile = kNoTile;
  std::uint64_t cycles = 0;
};
/// Events: the first ray of a batch has entered the T&I unit, or the last hit of a batch has returned. `rays`: number
/// of all rays of the core in the T&I unit at that time.
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
/// Event: a DMA has finished a transfer.
struct TransferEnded {
  std::uint32_t core = 0;
  TileTag tile = kNoTile;
  Area area = Area::kPicture;
  bool to_memory = false;
  Addr base = 0;
  std::uint32_t bytes = 0;
  sim::Time begin = 0, end = 0;
};
/// Event: a core port has forwarded a request to read or write a line.
struct LineRequested {
  TileTag tile = kNoTile;
  RequesterKind requester = RequesterKind::kNodes;
};
/// Events of an L2 bank: a read has been looked up, a line has been filled, a write has been accepted.
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
/// Event: a DRAM channel has opened a row for a request.
struct RowActivated {
  TileTag tile = kNoTile;
};
/// State in which a request found its DRAM bank: the row open, no row open, or another row open.
enum class RowState : std::uint8_t { kHit, kMiss, kConflict };
/// Event: a DRAM channel has booked the data transfer of a request. `end`: time at which the last data will have passed
/// the bus.
struct DramServed {
  MemRequest request;
  RowState row = RowState::kHit;
  sim::Time end = 0;
};

using Event =
    std::variant<TileDispatched, TileFinished, TileStarted, TileEnded, LoopEnded, LoopCharged, BatchStarted, BatchEnded,
                 TransferEnded, LineRequested, L2LookedUp, L2Filled, L2Written, RowActivated, DramServed>;

/// Receives the events of a simulated machine as they happen. An observer does not change the simulation.
class Observer {
 public:
  virtual ~Observer() = default;
  virtual void on_event(const Event& event) = 0;
};

/// Sends an event to an observer. Out of line, so that a unit without an observer pays only for one test.
template <class E>
[[gnu::cold, gnu::noinline]] void notify(Observer& observer, const E& event) {
  observer.on_event(event);
}

/// Event handler for std::visit, built from one lambda for each kind of event to be handled. Other kinds are ignored.
template <class... Handlers>
struct HandleEvents : Handlers... {
  using Handlers::operator()...;
  template <class Other>
  requires(!(std::is_invocable_v<Handlers, const Other&> || ...)) void operator()(const Other&) const {}
};
template <class... Handlers>
HandleEvents(Handlers...) -> HandleEvents<Handlers...>;

/// An observer that forwards events to several observers.
class ObserverList final : public Observer {
 public:
  /// Adds an observer to the list; a null pointer is ignored.
  void add(Observer* observer) {
    if (observer != nullptr) observers_.push_back(observer);
  }
  /// Returns the observer to attach to the machine: this list, its only observer, or null if the list is empty.
  Observer* attached_observer() {
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
