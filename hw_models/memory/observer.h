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

/// Kinds of units that send memory requests.
enum class RequesterKind : std::uint8_t {
  kNodes,      ///< L1 caches of traversal units
  kTriangles,  ///< L1 caches of intersection units
  kShading,    ///< data caches of shader cores
  kTransfers,  ///< DMA engines
  kRecords,    ///< memory interfaces, which carry rays and hits through memory
  kRaster,     ///< rasterisers
  kBuild,      ///< the tree builder
  kCount
};
inline constexpr std::size_t kRequesterKinds = static_cast<std::size_t>(RequesterKind::kCount);
constexpr std::array<std::string_view, kRequesterKinds> names_of(RequesterKind) {
  return {"nodes", "triangles", "shading", "transfers", "records", "raster", "build"};
}

// Events of a simulated machine. `tile`: the tile that caused the event; kNoTile if there is none.

/// Event: the tile dispatcher has sent a tile to a core. Tile tags are unique among tiles in flight.
struct TileDispatched {
  TileTag tile = kNoTile;
  std::uint32_t core = 0;
  sim::Time at = 0;
};
/// Event: the tile dispatcher has been notified by a core that a tile is finished.
struct TileFinished {
  TileTag tile = kNoTile;
  sim::Time at = 0;
};
/// Event: a tile has occupied one of a core's tile slots.
struct TileStarted {
  std::uint32_t core = 0, slot = 0;
  TileTag tile = kNoTile;
  sim::Time at = 0;
};
/// Event: a tile has left its tile slot of a core.
struct TileEnded {
  std::uint32_t core = 0, slot = 0;
  sim::Time at = 0;
};
/// Event: a loop on the array of a shader core has ended; its last item has left the pipeline.
struct LoopEnded {
  std::uint32_t core = 0;
  traces::KernelId kernel = 0;
  sim::Time begin = 0, configured = 0, start = 0,
            /// Times of the loop: start of the kernel switch, start of the stall for bank conflicts, start of the loop,
            /// end of the loop.
      end = 0;
  sim::Time stalled = 0;     ///< time for which the loop stalled on data cache misses
  std::uint64_t cycles = 0;  ///< shader core cycles charged to the kernel for this loop
  std::uint32_t items = 0;
  std::uint32_t launches = 0;  ///< number of chunks of launches that ran in the loop
  TileTag tile = kNoTile;      ///< tile of the loop's first chunk
};
/// Event: a tile is charged its share of the cycles of a loop on the shader core's array.
struct LoopCharged {
  TileTag tile = kNoTile;
  std::uint64_t cycles = 0;
};
/// Event: the first ray of a batch has entered the T&I unit. `rays`: number of rays in the T&I unit at that time.
struct BatchStarted {
  std::uint32_t core = 0, slot = 0, node = 0;
  std::uint64_t rays = 0;
  sim::Time at = 0;
};
/// Event: the last hit of a batch has returned from the T&I unit. `rays`: number of rays in the T&I unit at that time.
struct BatchEnded {
  std::uint32_t core = 0, slot = 0, node = 0;
  const traces::WorkNode* batch = nullptr;
  std::uint64_t rays = 0;
  sim::Time at = 0;
};
/// Event: a DMA engine has finished a transfer.
struct TransferEnded {
  std::uint32_t core = 0;
  TileTag tile = kNoTile;
  Area area = Area::kPicture;
  bool to_memory = false;
  Addr base = 0;
  std::uint32_t bytes = 0;
  sim::Time begin = 0, end = 0;
};
/// Steps of the tree builder on a tree: passes over its triangles or instances, and the invalidation of caches after
/// it.
enum class BuildPass : std::uint8_t { kSort, kMerge, kHierarchy, kRefit, kInvalidate };
constexpr std::array<std::string_view, 5> names_of(BuildPass) {
  return {"sort", "merge", "hierarchy", "refit", "invalidate"};
}
/// Event: the tree builder has ended a step on a tree.
struct BuildPassEnded {
  BuildPass pass = BuildPass::kSort;
  TileTag tile = kNoTile;
  std::uint32_t items = 0;  ///< triangles or instances of the tree
  std::uint32_t runs = 0;   ///< runs of sorted records that the pass writes (kSort) or reads; 0 for other steps
  sim::Time begin = 0, end = 0;
};
/// Event: a core port has forwarded a request to read or write a line.
struct LineRequested {
  TileTag tile = kNoTile;
  RequesterKind requester = RequesterKind::kNodes;
};
/// Event: an L2 bank has looked up a read.
struct L2LookedUp {
  TileTag tile = kNoTile;
  bool hit = false;
  sim::Time at = 0;
};
/// Event: an L2 bank has filled a line from memory.
struct L2Filled {
  TileTag tile = kNoTile;
};
/// Event: an L2 bank has accepted a write.
struct L2Written {
  TileTag tile = kNoTile;
};
/// Event: a DRAM channel has opened a row for a request.
struct RowActivated {
  TileTag tile = kNoTile;
};
/// State of a DRAM bank when it is accessed: the requested row is open, no row is open, or another row is open.
enum class RowState : std::uint8_t { kHit, kMiss, kConflict };
/// Event: a DRAM channel has booked the data transfer of a request. `end`: end of the transfer on the data bus.
struct DramServed {
  MemRequest request;
  RowState row = RowState::kHit;
  sim::Time end = 0;
};

/// An event of any kind. Frequent kinds are first, because handle_event() compares kinds in this order.
using Event = std::variant<LineRequested, L2LookedUp, DramServed, L2Filled, RowActivated, L2Written, LoopCharged,
                           BatchStarted, BatchEnded, TransferEnded, LoopEnded, TileDispatched, TileFinished,
                           TileStarted, TileEnded, BuildPassEnded>;

/// Receives the events of a simulated machine as they happen. An observer does not change the simulation.
class Observer {
 public:
  virtual ~Observer() = default;
  virtual void on_event(const Event& event) = 0;
};

/// Sends an event to an observer. Not inlined, so that a unit without an observer pays only for one test.
template <class E>
[[gnu::cold, gnu::noinline]] void notify(Observer& observer, const E& event) {
  observer.on_event(event);
}

/// Handlers of an observer's events, built from one lambda per kind of event to be handled.
template <class... Handlers>
struct HandleEvents : Handlers... {
  using Handlers::operator()...;
};
template <class... Handlers>
HandleEvents(Handlers...) -> HandleEvents<Handlers...>;

/// Calls the handler of the event's kind, if there is one. Compares kinds one by one, because std::visit calls through
/// a table of functions.
template <class Handlers, class... Kinds>
void handle_event(const std::variant<Kinds...>& event, const Handlers& handlers) {
  const auto handle_kind = [&]<class Kind>() {
    if constexpr (std::is_invocable_v<Handlers, const Kind&>) {
      const Kind* found = std::get_if<Kind>(&event);
      if (found != nullptr) handlers(*found);
      return found != nullptr;
    }
    return false;
  };
  (handle_kind.template operator()<Kinds>() || ...);
}

/// An observer that forwards events to several observers.
class ObserverList final : public Observer {
 public:
  /// Adds an observer to which events are forwarded; a null pointer is ignored.
  void add(Observer* observer) {
    if (observer != nullptr) observers_.push_back(observer);
  }
  /// Returns the observer to attach to the machine: the only one in the list, this list if it has several, or null.
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
