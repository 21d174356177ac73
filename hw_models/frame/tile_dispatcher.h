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
#include "sim/activity.h"
#include "sim/link.h"
#include "sim/named.h"

namespace hw {

/// Source of a frame's work, tile by tile, in the order of the tile list.
class TileSource {
 public:
  virtual ~TileSource() = default;
  /// The next tile's work, or null when the frame has no more. It stays valid until given back.
  virtual const traces::TileWork* next() = 0;
  virtual void give_back(const traces::TileWork* work) = 0;
  /// The work that next() gave last goes to a core at `now`.
  virtual void dispatched([[maybe_unused]] sim::Time now) {}
};

/// Hands the tiles of the list to the cores, each in turn as it has room for one, in the order of the list, and keeps
/// account of the borders that are in memory. A tile is handed out whether the borders that it imports are there or
/// not: only its transfers that read them wait for news. A tile after all others (TileWork::after_all) holds up those
/// behind it until all before it are finished; it begins a later pass, of whose tiles a core may have more at once.
///
///   tile list --> [one tile a cycle, round robin over cores with room] --> cores
///   borders written, tiles finished --> [those who import them] ---------> news for cores
///
/// Nobody waits for ever: a border is of an earlier tile, which has been handed out before, and the oldest tile of all
/// imports borders of finished tiles alone (docs/design/machine.md).
class TileDispatcher {
 public:
  static constexpr const char* kName = "tile_dispatcher";
  static constexpr Block kBlock = Block::kInterconnect;
  enum class CycleReason : std::uint8_t { kIdle, kDispatching, kCoresFull, kWaiting, kCount };
  static constexpr auto kReasons = sim::reasons<CycleReason>({
      {CycleReason::kIdle, sim::idle("idle", "every tile is out")},
      {CycleReason::kDispatching, sim::working("dispatching", "a tile went to a core")},
      {CycleReason::kCoresFull, sim::waiting("cores_full", "no core has room for a tile")},
      {CycleReason::kWaiting, sim::waiting("waiting", "the next tile needs all before it to be finished")},
  });
  struct Stats {
    std::uint64_t dispatched = 0, finished = 0, borders = 0, early = 0;
    static void describe(auto& s, auto&& counter) {
      counter(NAMED(s.dispatched), "tiles handed to cores");
      counter(NAMED(s.finished), "tiles the cores are through with");
      counter(NAMED(s.borders), "borders of tiles that the cores have written to memory");
      counter(NAMED(s.early), "tiles handed out before all borders that they import were there");
    }
  };
  struct Links {
    std::vector<sim::Link<TileJob>*> to_core;
    std::vector<sim::Link<TileDone>*> from_core;
    std::vector<sim::Link<Flush>*> to_l2;  ///< told when the last tile is finished; may be none
    Observer* observer = nullptr;
  };

  /// `starts`: cycles before a core may get its first tile, one of each core; empty: none.
  TileDispatcher(TileSource& source, TilesInFlight tiles_per_core, Links links, sim::Clock clock,
                 std::span<const std::uint32_t> starts = {});
  TileDispatcher(const TileDispatcher&) = delete;
  TileDispatcher& operator=(const TileDispatcher&) = delete;

  sim::Time tick(sim::Time now);
  const sim::Clock& clock() const { return clock_; }
  const Stats& stats() const { return stats_; }
  const sim::Activity<CycleReason>& activity() const { return activity_; }
  void finish(sim::Time end) { activity_.finish(end); }
  /// There are tiles in the list.
  bool has_more() const { return next_ != nullptr; }
  /// The list is empty and every tile has come back.
  bool done() const { return next_ == nullptr && stats_.dispatched == stats_.finished; }
  std::string state() const;

  /// Most messages under way from a core with so many tiles: their borders and ends.
  static constexpr std::size_t most_done(std::size_t tiles) { return tiles * (traces::kMostBorders + 1); }

 private:
  /// A tile in flight that lacks borders.
  struct Importer {
    std::size_t core = 0;
    TileJob job;
    bool has_news = false;
  };

  bool dispatch(sim::Time now);
  /// The next tile must be alone with those behind it.
  bool must_wait() const;
  bool has_room(std::size_t core) const;
  void collect(sim::Time now);
  void written(std::uint32_t tile, std::uint32_t borders);
  std::uint32_t missing(const traces::TileWork& work) const;
  void notify_importers(sim::Time now);
  void flush(sim::Time now);

  TileSource& source_;
  const TilesInFlight tiles_per_core_;
  Links links_;
  const sim::Clock clock_;
  const traces::TileWork* next_;
  std::vector<std::uint32_t> in_flight_;
  std::vector<sim::Time> start_at_;    ///< before it a core gets no tile
  std::vector<std::uint8_t> written_;  ///< borders in memory by number of tile, a bit each
  std::vector<Importer> importers_;    ///< in the order of the list
  std::size_t turn_ = 0;
  bool has_samples_ = false;    ///< a tile with samples has been handed out: a geometry pass has none
  bool is_later_pass_ = false;  ///< a tile after all others has been handed out, behind such
  bool flushed_ = false;
  Stats stats_;
  sim::Activity<CycleReason> activity_;
};

}  // namespace hw
