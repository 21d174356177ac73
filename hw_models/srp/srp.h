#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "hw_models/memory/cache.h"
#include "hw_models/memory/observer.h"
#include "hw_models/memory/unit_names.h"
#include "hw_models/srp/array_loop.h"
#include "hw_models/srp/messages.h"
#include "hw_models/srp/schedule.h"
#include "hw_models/srp/srp_config.h"
#include "hw_models/srp/srp_stats.h"
#include "hw_models/srp/tile_buffer.h"
#include "hw_models/srp/tile_run.h"
#include "hw_models/tni/messages.h"
#include "sim/link.h"
#include "sim/ring.h"
#include "sim/time.h"
#include "sim/unit_report.h"
#include "traces/accel/memory_image.h"

namespace hw {

/// A batch of rays that a shader core is sending to the T&I unit, and its progress.
struct RayFeed {
  std::uint32_t tile = 0, batch = 0;
  std::uint32_t next = 0;         ///< index of the next ray of the batch to send
  std::uint64_t after_spill = 0;  ///< the rays wait until this number of spill transfers has finished
};

/// The batches of rays that a shader core is sending to the T&I unit, and the number of the core's rays in that unit.
struct RayFeeder {
  std::vector<RayFeed> feeds;   ///< batches of rays being sent, in the order of the launches that produce them
  sim::Time next_at = 0;        ///< time at which the direct interface accepts the next ray
  std::uint64_t in_flight = 0;  ///< number of rays in the T&I unit

  void note_sent(sim::Time now) {
    idle_ = time_without_rays(now);
    in_flight += 1;
  }
  void record_return_time(sim::Time now) {
    if (--in_flight == 0) empty_since_ = now;
  }
  /// Returns the total time up to `now` in which the T&I unit had no ray.
  sim::Time time_without_rays(sim::Time now) const { return idle_ + (in_flight == 0 ? now - empty_since_ : 0); }

 private:
  sim::Time idle_ = 0;  ///< total time before `empty_since_` in which the T&I unit had no ray
  sim::Time empty_since_ = 0;
};

/// The shader core (SRP) of a GPU core: executes the kernel launches of the core's tiles, sends their rays to the T&I
/// unit and starts DMA transfers.
///
///   tiles --> [ launches: oldest tile, then consumers, first ] --> array: switch + depth + (n-1) II + stalls
///   rays  <-- [ tile buffer: a slot for each ray and its hit ] <-- hits
///                        [ transfers whose inputs are done ] --> DMA
///                  [ waves and batches whose inputs are done ] <--> rasteriser, if there is one
///
/// 1. A launch runs in chunks of items. Ready chunks of the same kernel may be merged into one loop. Each loop pays for
/// prologue and drain, and for a kernel switch if the array ran another kernel.
/// 2. A kernel switch takes `switch_cycles`, and more if the kernel must first be loaded into configuration memory.
/// 3. A chunk starts only if its rays fit into free ray slots. The first rays of a younger tile must leave room for
/// rays of the oldest tile.
/// 4. If nothing else can make progress, the oldest tile's ready launch starts without free slots. Its rays without a
/// slot are spilled to memory.
/// 5. The array is scheduled statically, so a late data-cache line stalls the whole array. Cycles lost to bank
/// conflicts are charged before the loop starts.
///
/// Not modelled: the code between loops (VLIW mode), except for the switch cost; transfer of configurations from memory
/// to the core; separate base addresses and constants for each launch of a merged loop.
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
    sim::Link<RasterJob>* raster_out = nullptr;  ///< null if the core has no rasteriser
    sim::Link<RasterDone>* raster_in = nullptr;
  };
  /// Properties of the frame and of other units on which a shader core depends.
  struct Frame {
    const traces::Layout* layout = nullptr;
    std::span<const KernelSchedule> kernels;   ///< schedules of all kernels, by KernelId
    std::span<const BankConflicts> conflicts;  ///< tile buffer bank conflicts of all kernels, by KernelId
    traces::FrameRequirements needs;
    sim::Time ray_interval = 0;        ///< minimum time between two rays on the direct interface
    std::array<Addr, kAreas> areas{};  ///< start addresses of the memory areas; this core spills rays to kSpill
    std::uint32_t encode_cycles = 0;   ///< cycles in which the DMA sRGB-encodes a line of pixels; 0: no encoding
    std::uint32_t plane_bytes = 0;     ///< bytes that a rasteriser writes to the tile buffer per sample
    bool ideal = false;                ///< kernels take no time
    bool ideal_buffer = false;         ///< the tile buffer is unlimited and has no bank conflicts
    bool ideal_cache = false;          ///< every probe of the data cache hits
    Observer* observer = nullptr;
    std::uint32_t core = 0;  ///< number of this shader core's core, reported in events
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
  std::size_t clear_cache() { return cache_.clear(); }

 private:
  static constexpr std::uint32_t kNoItem = 0xffffffffU;    ///< no item: value of `lines_of_item` while `lines` is empty
  static constexpr std::uint64_t kAccessBytes = 16;        ///< bytes of one tile buffer access
  static constexpr std::uint32_t kSpillTag = 0xffffffffU;  ///< tag of DMA jobs for spilled rays
  // A handle identifies a ray or node: slot of its tile (high bits) and index within the tile.
  static constexpr std::uint32_t kTileShift = 24;
  static_assert(kMaxRays == 1U << kTileShift);
  static constexpr std::uint32_t handle_of(std::uint32_t tile, std::uint32_t index) {
    return (tile << kTileShift) | index;
  }
  static constexpr std::uint32_t tile_of_handle(std::uint32_t handle) { return handle >> kTileShift; }
  static constexpr std::uint32_t index_of_handle(std::uint32_t handle) { return handle & ((1U << kTileShift) - 1); }
  /// Progress of the data cache loads of the loop on the array.
  struct Loads {
    /// A loop item that waits for data cache lines.
    struct Item {
      sim::Time needed = 0;  ///< array time (ArrayLoop) at which the item needs the lines
      std::uint32_t slot = 0;
    };
    sim::Ring<Item> queue;
    std::uint64_t missing = 0;                 ///< mask of the loop items, modulo 64, that wait for lines
    std::vector<std::uint32_t> lines_missing;  ///< number of lines for which each of these items waits
    std::vector<Addr> lines;
    std::uint32_t lines_of_item = kNoItem;  ///< loop item whose cache lines are listed in `lines`
    bool mshrs_full = false;                ///< the array is stalled because no MSHR is free
  };
  /// State of the launch scheduler, which chooses the kernel launch that the shader core's array runs next.
  struct Launch {
    bool check_pending = false;          ///< a launch may have become ready since the last check
    bool is_blocked = false;             ///< a launch is ready but has too few free ray slots
    std::uint32_t kernel = 0xffffffffU;  ///< kernel for which the shader core's array is configured
    ConfigMemory config_memory;
  };
  /// Shader core jobs that wait to be sent to the DMA and to the rasteriser.
  struct Transfers {
    sim::Ring<DmaJob> dma;
    sim::Ring<RasterJob> raster;
    std::uint64_t spills_started = 0, spills_done = 0;
    std::uint64_t awaited = 0;  ///< number of transfers in progress for which work graph nodes wait
  };
  /// Occupancy of T&I unit and array since the last tick, for the counters `fed` and `awaited`.
  struct Occupancy {
    bool tni_had_rays = false, array_was_busy = false;
    sim::Time until = 0;  ///< time up to which both counters are updated
  };

  // Functions that handle tiles.
  void take_tile(sim::Time now);
  /// Returns the slot of the tile to which a border update belongs; tiles_.size() if the message is a new tile.
  std::uint32_t find_in_flight_slot(const TileJob& job) const;
  bool has_room(const TileJob& job) const {
    return by_age_.size() < tiles_.size() || find_in_flight_slot(job) != tiles_.size();
  }
  void finish_items(sim::Time now, std::uint32_t tile, std::uint32_t node, std::uint32_t items);
  void end_tile(sim::Time now, std::uint32_t tile);

  // Functions that run the loop on the array and its loads.
  void run_array(sim::Time now);
  void fill_arrived_line(sim::Time now);
  bool issue_loads(sim::Time now);
  bool load_all_items(sim::Time now);
  void issue_loads_that_hit();
  bool request_lines(sim::Time now, std::uint32_t item);
  bool ensure_loads_in_time(sim::Time now);
  std::span<const traces::Access> accesses_of(std::uint32_t item) const;
  void collect_lines(std::uint32_t item);
  void finish_chunk(sim::Time now);
  void notify_loop_end(sim::Time now, std::uint64_t cycles) const;

  // Functions of the launch scheduler.
  void start_chunk(sim::Time now);
  bool has_ray_slots(std::uint32_t tile, std::uint32_t node) const;
  void begin_chunk(sim::Time now, std::uint32_t tile, std::uint32_t node);
  std::uint64_t switch_to_kernel(traces::KernelId kernel);
  void add_chunk(std::uint32_t tile, std::uint32_t node);
  void join_ready_launches(const traces::WorkNode& work);

  // Functions that exchange rays and hits with the T&I unit.
  bool feed_ray(sim::Time now);
  void take_hit(sim::Time now);
  void notify_batch_end(sim::Time now, std::uint32_t tile, std::uint32_t ray) const;
  /// Returns the time at which the next ray of a batch can be sent to the T&I unit; kNever if not known yet.
  sim::Time ray_ready_at(const RayFeed& feed) const;

  // Functions that start and finish transfers and rasteriser jobs.
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
  /// Times at which the next message of each kind arrives at the shader core: tile or border update, hit, cache line,
  /// finished transfer.
  struct {
    sim::Time tiles = sim::kNever, hits = sim::kNever, lines = sim::kNever, transfers = sim::kNever;
  } arrivals_;
  TileBuffer buffer_;
  L1Cache cache_;
  std::vector<TileRun> tiles_;
  std::vector<std::uint32_t> by_age_;  ///< slot numbers of the tiles in flight, oldest tile first
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
