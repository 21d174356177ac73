#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "hw_models/memory/l1_cache.h"
#include "hw_models/memory/observer.h"
#include "hw_models/memory/unit_names.h"
#include "hw_models/srp/array_loop.h"
#include "hw_models/srp/bank_conflicts.h"
#include "hw_models/srp/messages.h"
#include "hw_models/srp/ray_feeder.h"
#include "hw_models/srp/schedule.h"
#include "hw_models/srp/srp_config.h"
#include "hw_models/srp/srp_stats.h"
#include "hw_models/srp/tile_buffer.h"
#include "hw_models/srp/tile_run.h"
#include "hw_models/tni/messages.h"
#include "sim/activity.h"
#include "sim/link.h"
#include "sim/ring.h"
#include "traces/accel/memory_image.h"

namespace hw {

/// The shader core (SRP) of a GPU core executes the kernel launches of the core's tiles, sends their rays to the T&I
/// unit and starts DMA transfers of their data.
///
///   tiles --> [ launches: oldest tile, then consumers, first ] --> array: switch + depth + (n-1) II + stalls
///   rays  <-- [ tile buffer: a slot for each ray and its hit ] <-- hits
///                        [ transfers whose inputs are done ] --> DMA
///                  [ waves and batches whose inputs are done ] <--> rasteriser, if there is one
///
/// 1. A launch runs in chunks. Chunks of one kernel that are ready together may run as one loop. Each loop pays a
/// kernel switch (if the array runs another kernel), prologue and drain.
/// 2. A switch to a kernel in configuration memory takes `switch_cycles`; the rows of other kernels are loaded first.
/// 3. A chunk starts only if its rays fit into free ray slots. The first rays of a younger tile leave room for those of
/// the oldest tile.
/// 4. If nothing else can make progress, the oldest tile's launch starts anyway, and rays without a slot are spilled to
/// memory.
/// 5. The array is scheduled statically: a data-cache line that is late stalls the whole array. Cycles lost to bank
/// conflicts are charged before the loop starts.
///
/// Not modelled: VLIW mode between loops beyond the switch cost, transfer of configurations from memory to the core,
/// the cost of separate base addresses and constants for each launch of a merged loop.
class Srp {
 public:
  static constexpr const char* kName = "core.srp";
  static constexpr Block kBlock = Block::kSrp;
  enum class CycleReason : std::uint8_t {
    kStarved,
    kRunning,
    kSwitching,
    kCacheMiss,
    kBanks,
    kWaiting,
    kBorders,
    kNoSlots,
    kCount
  };
  static constexpr auto kReasons = sim::reasons<CycleReason>({
      {CycleReason::kStarved, sim::idle_reason("starved", "no tile")},
      {CycleReason::kRunning, sim::working_reason("running", "a kernel's loop is on the array")},
      {CycleReason::kSwitching, sim::working_reason("switching", "the array is being configured for another kernel")},
      {CycleReason::kCacheMiss, sim::waiting_reason("cache_miss", "the array is stalled for a line of the data cache")},
      {CycleReason::kBanks, sim::working_reason("banks", "the array is stalled by bank conflicts in the tile buffer")},
      {CycleReason::kWaiting, sim::waiting_reason("waiting", "launches wait for rays in the T&I unit, or for the DMA")},
      {CycleReason::kBorders,
       sim::waiting_reason("borders", "only transfers that wait for borders of other tiles are left")},
      {CycleReason::kNoSlots, sim::waiting_reason("no_slots", "a launch waits for free ray slots in the tile buffer")},
  });
  using Stats = SrpStats;
  struct Links {
    sim::Link<TileJob>& tiles_in;
    sim::Link<TileDone>& tiles_out;
    sim::Link<RayJob>& rays_out;
    sim::Link<RayDone>& hits_in;
    sim::Link<MemRequest>& memory_out;
    sim::Link<MemResponse>& memory_in;
    sim::Link<DmaJob>& dma_out;
    sim::Link<DmaDone>& dma_in;
    sim::Link<RasterJob>* raster_out = nullptr;  ///< null: the core has no rasteriser
    sim::Link<RasterDone>* raster_in = nullptr;
  };
  /// Properties of the frame and the configuration that a shader core needs in addition to its own settings.
  struct Frame {
    const traces::Layout* layout = nullptr;
    std::span<const KernelSchedule> kernels;   ///< by KernelId
    std::span<const BankConflicts> conflicts;  ///< by KernelId
    traces::FrameRequirements needs;
    sim::Time ray_interval = 0;        ///< time between rays on the direct interface
    std::array<Addr, kAreas> areas{};  ///< start addresses; this core's ray slots spill to kSpill
    std::uint32_t encode_cycles = 0;   ///< cycles of the DMA to sRGB-encode a line of pixels; 0: no encoding
    std::uint32_t plane_bytes = 0;     ///< bytes that a rasteriser writes to the tile buffer per sample
    bool ideal = false;                ///< kernels cost no time
    bool ideal_buffer = false;         ///< the tile buffer is unlimited and has no bank conflicts
    bool ideal_cache = false;          ///< every probe of the data cache hits
    Observer* observer = nullptr;
    std::uint32_t core = 0;  ///< number of this core, for events
  };

  Srp(const SrpConfig& config, const TileBufferConfig& buffer, const Frame& frame, Links links, std::uint16_t client,
      sim::Clock clock);
  Srp(const Srp&) = delete;
  Srp& operator=(const Srp&) = delete;

  sim::Time tick(sim::Time now);
  const sim::Clock& clock() const { return clock_; }
  const Stats& stats() const { return stats_; }
  std::uint64_t retired_items() const {
    return stats_.tiles + stats_.items + stats_.rays + stats_.hits + stats_.cache_fills;
  }
  const sim::Activity<CycleReason>& activity() const { return activity_; }
  const TileBuffer& tile_buffer() const { return buffer_; }
  std::span<const KernelUse> kernel_use() const { return kernel_use_; }
  void finish(sim::Time end);
  std::string state() const;
  bool warm_line(Addr line) { return cache_.warm_line(line); }
  const CacheTags& cache_tags() const { return cache_.tags(); }
  void set_cache_tags(const CacheTags& tags) { cache_.set_tags(tags); }

 private:
  static constexpr std::uint32_t kNoItem = 0xffffffffU;    ///< marks that the lines of no item are collected
  static constexpr std::uint64_t kAccessBytes = 16;        ///< bytes of an access to the tile buffer
  static constexpr std::uint32_t kSpillTag = 0xffffffffU;  ///< tag of DMA jobs for spilled rays
  // A handle combines the slot of a tile in flight (high bits) with the index of a ray or node in the tile.
  static constexpr std::uint32_t kTileShift = 24;
  static_assert(kMaxRays == 1U << kTileShift);
  static constexpr std::uint32_t handle_of(std::uint32_t tile, std::uint32_t index) {
    return (tile << kTileShift) | index;
  }
  static constexpr std::uint32_t tile_of_handle(std::uint32_t handle) { return handle >> kTileShift; }
  static constexpr std::uint32_t index_of_handle(std::uint32_t handle) { return handle & ((1U << kTileShift) - 1); }
  /// Progress of the data cache loads of the loop that the array runs.
  struct Loads {
    /// A loop item that waits for cache lines.
    struct Item {
      sim::Time needed = 0;  ///< array time at which the item needs the lines
      std::uint32_t slot = 0;
    };
    sim::Ring<Item> queue;
    std::uint64_t missing = 0;                 ///< mask of the slots of items that wait for lines
    std::vector<std::uint32_t> lines_missing;  ///< lines that each slot waits for
    std::vector<Addr> lines;
    std::uint32_t lines_of_item = kNoItem;  ///< loop item to which `lines` belongs
    bool mshrs_full = false;                ///< the array is stalled because no MSHR is free
  };
  /// State of the shader core's launch scheduler, which chooses the kernel launch that the array runs next.
  struct Launch {
    bool check_pending = false;          ///< an event may have made a launch ready
    bool is_blocked = false;             ///< a launch was ready but found too few free ray slots
    std::uint32_t kernel = 0xffffffffU;  ///< kernel configured on the array
    ConfigMemory config_memory;
  };
  /// Jobs that wait to be sent to the DMA and to the rasteriser.
  struct Transfers {
    sim::Ring<DmaJob> dma;
    sim::Ring<RasterJob> raster;
    std::uint64_t spills_started = 0, spills_done = 0;
    std::uint64_t awaited = 0;  ///< transfers in progress that nodes wait for
  };
  /// State of the shader core since the last tick, for the counters `fed` and `awaited`.
  struct Occupancy {
    bool tni_had_rays = false, array_was_busy = false;
    sim::Time until = 0;  ///< end of the time accounted so far
  };

  // Tiles.
  void take_tile(sim::Time now);
  /// Returns the slot of the tile in flight to which a border update belongs; tiles_.size() if the job is a new tile.
  std::uint32_t find_in_flight_slot(const TileJob& job) const;
  bool has_room(const TileJob& job) const {
    return by_age_.size() < tiles_.size() || find_in_flight_slot(job) != tiles_.size();
  }
  void finish_items(sim::Time now, std::uint32_t tile, std::uint32_t node, std::uint32_t items);
  void end_tile(sim::Time now, std::uint32_t tile);

  // Array loop and its loads.
  void run_array(sim::Time now);
  void fill_arrived_line(sim::Time now);
  bool issue_loads(sim::Time now);
  bool load_all_items(sim::Time now);
  void issue_ready_hits();
  bool request_lines(sim::Time now, std::uint32_t item);
  bool ensure_loads_in_time(sim::Time now);
  std::span<const traces::Access> accesses_of(std::uint32_t item) const;
  void collect_lines(std::uint32_t item);
  void finish_chunk(sim::Time now);
  void notify_loop_end(sim::Time now, std::uint64_t cycles) const;

  // Launch scheduler.
  void start_chunk(sim::Time now);
  bool has_ray_slots(std::uint32_t tile, std::uint32_t node) const;
  void begin_chunk(sim::Time now, std::uint32_t tile, std::uint32_t node);
  std::uint64_t switch_to_kernel(traces::KernelId kernel);
  void add_chunk(std::uint32_t tile, std::uint32_t node);
  void join_ready_launches(const traces::WorkNode& work);

  // Ray feeder.
  bool feed_ray(sim::Time now);
  void take_hit(sim::Time now);
  void notify_batch_end(sim::Time now, std::uint32_t tile, std::uint32_t ray) const;
  /// Returns the time at which the next ray of a batch can be sent; kNever if it is not known yet.
  sim::Time ray_ready_at(const RayFeed& feed) const;

  // Transfers.
  void start_transfers(std::uint32_t tile);
  void queue_raster_job(std::uint32_t tile, std::uint32_t node);
  void take_finished_transfer(sim::Time now);
  void service_rasteriser_links(sim::Time now);

  void account_until(sim::Time now);
  CycleReason current_reason(sim::Time now) const;
  sim::Time next_wake(sim::Time now) const;

  const SrpConfig config_;
  const sim::Clock clock_;
  const Frame frame_;
  Links links_;
  /// Earliest times at which the next tile or border update, hit, cache line and finished transfer can be taken.
  struct {
    sim::Time tiles = sim::kNever, hits = sim::kNever, lines = sim::kNever, transfers = sim::kNever;
  } arrivals_;
  TileBuffer buffer_;
  L1Cache cache_;
  std::vector<TileRun> tiles_;
  std::vector<std::uint32_t> by_age_;  ///< slots of the tiles in flight, oldest tile first
  ArrayLoop loop_;
  Loads loads_;
  Launch launch_;
  RayFeeder rays_;
  Transfers transfers_;
  Occupancy occupancy_;
  std::vector<KernelUse> kernel_use_;
  Stats stats_;
  sim::Activity<CycleReason> activity_;
};

}  // namespace hw
