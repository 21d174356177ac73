#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "hw_models/memory/messages.h"
#include "hw_models/memory/observer.h"
#include "hw_models/memory/unit_names.h"
#include "hw_models/srp/messages.h"
#include "hw_models/srp/tile_buffer.h"
#include "sim/link.h"
#include "sim/named.h"
#include "sim/unit_report.h"

namespace hw {

/// The tiles of a frame, which the tile dispatcher takes in the order of the tile list. This base class has no tiles.
class TileSource {
 public:
  virtual ~TileSource() = default;
  /// Returns the work of the next tile, or null at the end of the frame. The work is valid until release_work(work).
  virtual const traces::TileWork* next() { return nullptr; }
  virtual void release_work([[maybe_unused]] const traces::TileWork* work) {}
  /// Called when the tile that next() returned last is dispatched to a core at time `now`.
  virtual void note_dispatched([[maybe_unused]] sim::Time now) {}
};

/// Sends tiles to the cores in the order of the tile list, and tracks which tile borders are in memory.
///
///   tile list --> [one tile a cycle, round robin over cores with room] --> cores
///   borders written, tiles finished --> [tiles that import them] --------> updates for cores
///
/// 1. A tile goes to the next core, in round-robin order, that has room for a tile.
/// 2. A tile may be dispatched before the borders that it imports are in memory. Only the transfers that read these
/// borders wait, until the dispatcher sends the core an update.
/// 3. A tile marked `after_all` (TileWork) waits until all tiles before it are finished. It begins a later pass, in
/// which a core may have more tiles at once.
/// 4. Work of the tree builder goes to the builder, in list order. If trees are built while rays read others, a tile
/// marked `after_all` does not wait for them.
/// 5. There is no deadlock. Borders belong to earlier tiles, which are dispatched first. So the oldest tile imports
/// only borders of finished tiles (docs/design/machine.md).
class TileDispatcher {
 public:
  static constexpr const char* kName = "tile_dispatcher";
  static constexpr Block kBlock = Block::kInterconnect;
  enum class CycleReason : std::uint8_t { kIdle, kDispatching, kCoresFull, kWaiting, kCount };
  static constexpr auto kReasons = sim::reasons<CycleReason>({
      {CycleReason::kIdle, sim::idle_reason("idle", "every tile is dispatched")},
      {CycleReason::kDispatching, sim::working_reason("dispatching", "a tile was dispatched to a core")},
      {CycleReason::kCoresFull, sim::waiting_reason("cores_full", "no core has room for a tile")},
      {CycleReason::kWaiting, sim::waiting_reason("waiting", "the next tile waits for all earlier tiles")},
  });
  struct Stats {
    std::uint64_t dispatched = 0, finished = 0, borders = 0, early = 0;
    static void describe(auto& s, auto&& counter) {
      counter(NAMED(s.dispatched), "tiles dispatched to cores");
      counter(NAMED(s.finished), "tiles finished by cores");
      counter(NAMED(s.borders), "borders of tiles that the cores have written to memory");
      counter(NAMED(s.early), "tiles dispatched before all their imported borders were in memory");
    }
  };
  struct Links {
    std::vector<sim::Link<TileJob>*> to_core;
    std::vector<sim::Link<TileDone>*> from_core;
    /// Links to and from the tree builder; null if there is none.
    sim::Link<TileJob>* to_builder = nullptr;
    sim::Link<TileDone>* from_builder = nullptr;
    bool builds_overlap = false;  ///< tiles do not wait for the tree builder
    /// Links to the L2 banks for the Flush message after the last tile; may be empty.
    std::vector<sim::Link<Flush>*> to_l2;
    Observer* observer = nullptr;
  };

  /// `starts`: for each core, the first cycle in which it may get a tile; empty: cycle 0 for all.
  TileDispatcher(TileSource& source, TilesInFlight tiles_per_core, Links links, sim::Clock clock,
                 std::span<const std::uint32_t> starts = {});
  TileDispatcher(const TileDispatcher&) = delete;
  TileDispatcher& operator=(const TileDispatcher&) = delete;

  sim::Time tick(sim::Time now);
  const sim::Clock& clock() const { return clock_; }
  const Stats& stats() const { return stats_; }
  const sim::Activity<CycleReason>& activity() const { return activity_; }
  void finish(sim::Time end) { activity_.finish(end); }
  /// True if tiles are left to dispatch.
  bool has_more_tiles() const { return next_ != nullptr; }
  /// True if all tiles have been dispatched and finished.
  bool is_done() const { return next_ == nullptr && stats_.dispatched == stats_.finished; }
  std::string state() const;

  /// Returns the maximum number of messages in flight from a core to the dispatcher: for each of its tiles, one per
  /// border and one for the end of the tile.
  static constexpr std::size_t max_messages(std::size_t tiles_per_core) {
    return tiles_per_core * (traces::kMostBorders + 1);
  }

 private:
  /// A dispatched tile that imports borders which are not in memory yet.
  struct Importer {
    std::size_t core = 0;
    TileJob job;
    bool update_pending = false;
  };

  bool dispatch_tile(sim::Time now);
  bool dispatch_build(sim::Time now);
  /// Sends the next entry of the tile list to a core or, with the number of cores, to the tree builder.
  void send_next(sim::Time now, std::size_t core, sim::Link<TileJob>& link);
  void note_finished(sim::Time now, const TileDone& done);
  /// True if the next tile must wait for all earlier tiles (`after_all`) and some of them are unfinished.
  bool next_tile_must_wait() const;
  bool has_room(std::size_t core) const;
  void collect_messages(sim::Time now);
  void note_borders_written(std::uint32_t tile, std::uint32_t borders);
  std::uint32_t missing_borders(const traces::TileWork& work) const;
  void notify_importers(sim::Time now);
  void flush_l2(sim::Time now);

  TileSource& source_;
  const TilesInFlight tiles_per_core_;
  Links links_;
  const sim::Clock clock_;
  const traces::TileWork* next_;
  std::vector<std::uint32_t> in_flight_;
  std::uint32_t builds_in_flight_ = 0;
  std::vector<sim::Time> start_at_;    ///< earliest time at which each core may get its first tile
  std::vector<std::uint8_t> written_;  ///< mask of each tile's borders that are in memory, by tile number
  std::vector<Importer> importers_;    ///< dispatched tiles that import borders not yet in memory, in dispatch order
  std::size_t turn_ = 0;
  bool has_samples_ = false;    ///< a tile with samples has been dispatched (geometry passes have none)
  bool is_later_pass_ = false;  ///< an `after_all` tile was dispatched after a tile with samples
  bool flushed_ = false;
  Stats stats_;
  sim::Activity<CycleReason> activity_;
};

}  // namespace hw
