#pragma once
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "hw_models/memory/cache.h"
#include "hw_models/memory/messages.h"
#include "hw_models/memory/unit_names.h"
#include "hw_models/memory/write_combiner.h"
#include "hw_models/raster/raster_unit_config.h"
#include "hw_models/srp/messages.h"
#include "sim/link.h"
#include "sim/named.h"
#include "sim/unit_report.h"
#include "traces/stream.h"

namespace hw {

/// Addresses of the rasterisers' arrays in memory: vertex positions, vertex numbers of triangles, transformed vertices
/// and tile lists, in this order. No two arrays share a cache line.
struct RasterMemory {
  static constexpr std::uint32_t kPositionBytes = 12;     ///< vertex position of the scene: three floats
  static constexpr std::uint32_t kIndexBytes = 12;        ///< vertex numbers of a triangle: three integers
  static constexpr std::uint32_t kTransformedBytes = 16;  ///< transformed vertex, in picture space: four floats
  static constexpr std::uint32_t kEntryBytes = 4;         ///< entry of a tile list: a triangle number

  Addr positions = 0, indices = 0, transformed = 0, lists = 0, end = 0;

  RasterMemory() = default;
  RasterMemory(Addr base, const traces::RasterArraySizes& demands) : positions(base) {
    indices = round_up_to_lines(positions + Addr{demands.vertices} * kPositionBytes);
    transformed = round_up_to_lines(indices + Addr{demands.triangles} * kIndexBytes);
    lists = round_up_to_lines(transformed + Addr{demands.vertices} * kTransformedBytes);
    end = round_up_to_lines(lists + Addr{demands.entries} * kEntryBytes);
  }
  Addr position_address(std::uint32_t vertex) const { return positions + Addr{vertex} * kPositionBytes; }
  Addr index_address(std::uint32_t triangle) const { return indices + Addr{triangle} * kIndexBytes; }
  Addr transformed_address(std::uint32_t vertex) const { return transformed + Addr{vertex} * kTransformedBytes; }
  Addr entry_address(std::uint32_t entry) const { return lists + Addr{entry} * kEntryBytes; }
};

/// Counters of a rasteriser.
struct RasterStats {
  std::uint64_t batches = 0, waves = 0;
  std::uint64_t triangles = 0, triangles_culled = 0, vertices_transformed = 0, vertices_reused = 0;
  std::uint64_t entries_written = 0, entries_read = 0, triangles_set_up = 0;
  std::uint64_t blocks = 0, blocks_hidden = 0, quads = 0, quads_hidden = 0, quad_passes = 0;
  std::uint64_t samples_covered = 0, samples_hidden = 0, samples_failed = 0, samples_passed = 0, samples_out = 0;
  std::uint64_t l1_accesses = 0, l1_hits = 0, l1_misses = 0, l1_fills = 0;
  std::uint64_t writes = 0;

  static void describe(auto& s, auto&& counter) {
    counter(NAMED(s.batches), "batches of triangles added to tile lists");
    counter(NAMED(s.waves), "waves of samples whose primary hits were found");
    counter(NAMED(s.triangles), "triangles of these batches");
    counter(NAMED(s.triangles_culled), "of these, triangles that are culled");
    counter(NAMED(s.vertices_transformed), "vertices transformed", "raster.vertex");
    counter(NAMED(s.vertices_reused), "vertices found in the vertex cache");
    counter(NAMED(s.entries_written), "entries of lists written", "raster.list_entry");
    counter(NAMED(s.entries_read), "entries of lists read");
    counter(NAMED(s.triangles_set_up), "triangles set up for coverage", "raster.setup");
    counter(NAMED(s.blocks), "blocks of pixels tested for coarse coverage", "raster.block");
    counter(NAMED(s.blocks_hidden), "of these, blocks skipped by the hierarchical z buffer");
    counter(NAMED(s.quads), "quads tested for fine coverage");
    counter(NAMED(s.quads_hidden), "quads in skipped blocks");
    counter(NAMED(s.quad_passes), "sample tests of quads: each tests one group of samples of every pixel",
            "raster.quad");
    counter(NAMED(s.samples_covered), "samples covered by triangles: skipped, failed and passed");
    counter(NAMED(s.samples_hidden), "of these, samples in skipped blocks");
    counter(NAMED(s.samples_failed), "of these, samples behind a nearer triangle", "raster.depth_test");
    counter(NAMED(s.samples_passed), "of these, samples nearer than all before", "raster.depth_write");
    counter(NAMED(s.samples_out), "samples written to the tile buffer, with or without a hit", "raster.plane");
    counter(NAMED(s.l1_accesses), "probes of the L1 except those that found no free MSHR");
    counter(NAMED(s.l1_hits), "probes that hit", "cache.l1_read");
    counter(NAMED(s.l1_misses), "probes that missed", "cache.l1_probe");
    counter(NAMED(s.l1_fills), "lines filled", "cache.l1_fill");
    counter(NAMED(s.writes), "lines or parts of lines written: vertices and lists");
  }
};

/// Vertex cache of a rasteriser: the numbers of recently transformed vertices, with FIFO replacement.
class VertexCache {
 public:
  explicit VertexCache(std::uint32_t entries) : entries_(entries, kNothing) {}

  /// Returns true if the vertex cache contains the vertex; otherwise adds the vertex and returns false.
  bool find_or_add(std::uint32_t vertex) {
    if (std::ranges::find(entries_, std::uint64_t{vertex}) != entries_.end()) return true;
    entries_[next_] = vertex;
    next_ = next_ + 1 == entries_.size() ? 0 : next_ + 1;
    return false;
  }

 private:
  static constexpr std::uint64_t kNothing = ~std::uint64_t{0};
  std::vector<std::uint64_t> entries_;
  std::size_t next_ = 0;
};

/// Fetches the cache lines that a rasteriser's next triangles need, in order, before their use.
///
///   triangle --> [ entry of the list ] --> [ numbers of its vertices ] --> [ vertices ] --> ready, oldest first
///
/// 1. Each stage looks up its lines in the L1, triangle by triangle, without waiting. A triangle enters the next stage
/// when its lines have arrived.
/// 2. Triangles of a batch have no list entry to read. Recently transformed vertices are not fetched again.
///
/// Not modelled: the latency of an L1 hit, which the window of triangles hides.
class RasterFetch {
 public:
  RasterFetch(const RasterUnitConfig& config, const RasterMemory& memory, std::uint16_t client, bool ideal,
              RasterStats& stats)
      : memory_(memory),
        l1_(config.l1, client, ideal),
        lookups_(config.lookups),
        slots_(config.window),
        vertex_cache_(config.vertex_cache),
        stats_(stats) {}

  bool has_room() const { return entered_ - left_ < slots_.size(); }
  bool empty() const { return entered_ == left_; }
  /// Adds a triangle to the window of triangles whose lines are fetched. `entry`: index of its tile-list entry, or
  /// kBatch for a triangle of the geometry pass. `tile`: tile to which the requests are charged.
  void add_triangle(const traces::RasterTriangle& triangle, std::uint32_t entry, TileTag tile);
  static constexpr std::uint32_t kBatch = traces::WorkNode::kNone;

  /// True if all lines of the oldest triangle in the rasteriser's window have arrived.
  bool is_ready() const { return !empty() && done_[kLast] > left_ && slot_of(left_).pending == 0; }
  /// Returns the number of vertices of the oldest triangle in the rasteriser's window that must be transformed.
  std::uint32_t missed_vertex_count() const { return slot_of(left_).missed; }
  std::array<std::uint32_t, 3> missed_vertices() const { return slot_of(left_).vertices; }
  void remove_oldest() { left_ += 1; }

  /// Looks up, in the L1, cache lines of the triangles in the rasteriser's window. Returns true if a fetch stage has
  /// advanced.
  bool look_up_lines();
  void fill_line(Addr line);
  void send_request(sim::Time now, sim::Link<MemRequest>& out) { l1_.send_request(now, out); }
  sim::Time next_send_time(sim::Time next, const sim::Link<MemRequest>& out) const {
    return l1_.next_send_time(next, out);
  }
  std::string state() const;
  const CacheTags& l1_tags() const { return l1_.tags(); }
  /// Replaces the contents of the rasteriser's L1. Must be called before the first cycle.
  void set_l1_tags(const CacheTags& tags) { l1_.set_tags(tags); }

 private:
  enum Stage : std::uint8_t { kList, kIndices, kVertices, kStages };
  static constexpr Stage kLast = kVertices;
  static constexpr std::size_t kMostLines = 6;  ///< maximum number of lines that a triangle needs in one stage: three
                                                ///< vertices, each in two lines
  struct Slot {
    const traces::RasterTriangle* triangle = nullptr;
    std::uint32_t entry = kBatch;
    std::uint32_t pending = 0;  ///< number of requested lines that have not arrived
    std::array<Addr, kMostLines> lines{};
    std::uint32_t count = 0, next = 0;  ///< number of lines in the current stage; index of the next to look up
    bool listed = false;                ///< `lines` has been filled for the current stage
    std::uint32_t missed = 0;
    std::array<std::uint32_t, 3> vertices{};  ///< numbers of the triangle's vertices that must be transformed
  };

  Slot& slot_of(std::uint64_t number) { return slots_[number % slots_.size()]; }
  const Slot& slot_of(std::uint64_t number) const { return slots_[number % slots_.size()]; }
  /// Looks up the next cache line of the oldest triangle in a fetch stage of the rasteriser. If the triangle needs no
  /// line, passes it on to the next stage. Returns false if the stage cannot advance. Adds look-ups to `lookups_done`.
  bool advance_stage(Stage stage, std::uint32_t& lookups_done);
  void collect_lines(Stage stage, Slot& slot);
  void collect_vertex_lines(Slot& slot);
  static void add_lines(Slot& slot, Addr first_byte, std::uint32_t bytes);

  const RasterMemory memory_;
  L1Cache l1_;
  const std::uint32_t lookups_;
  std::vector<Slot> slots_;
  std::uint64_t entered_ = 0, left_ = 0;       ///< number of triangles that have entered and left the window so far
  std::array<std::uint64_t, kStages> done_{};  ///< number of triangles that have passed each fetch stage so far
  VertexCache vertex_cache_;
  RasterStats& stats_;
};

/// A core's tile-based rasteriser. In the geometry pass it puts batches of triangles into tile lists. Later it finds
/// the primary hits of waves, which are groups of samples of a tile, with the tile's list, and writes them to the tile
/// buffer.
///
///   batches --> [ fetch: numbers, vertices ] --> [ transform ] --> [ cull, list ] --> vertices, lists --> memory
///   waves   --> [ fetch: list, numbers, vertices ] --> [ set-up ] --> [ blocks, quads, depth ] --> hits
///
/// 1. Jobs (batches and waves) are processed one at a time, in order. Meanwhile, lines for later jobs are fetched.
/// 2. After all triangles of a batch, its list entries are written to memory. After all triangles of a wave, its hits
/// are written to the tile buffer, `plane_width` bytes per cycle.
/// 3. A depth buffer holds the depth and nearest triangle of each sample. The data of a sample in the tile buffer are
/// interpolated once, for its nearest triangle.
/// 4. A wave with more samples than the depth buffer is processed in parts. All triangles are set up again for each
/// part.
///
/// Not modelled: fetching the list again for each part; a limit on the entries of a batch; vertex shaders and skinning
/// (a fixed-function unit transforms vertices); list reads that wait for another core's last list writes (the end of
/// the pass takes longer).
class RasterUnit {
 public:
  static constexpr const char* kName = "core.raster";
  static constexpr Block kBlock = Block::kRaster;
  enum class CycleReason : std::uint8_t {
    kIdle,
    kCovering,
    kListing,
    kSettingUp,
    kTransforming,
    kWriting,
    kFetching,
    kMemory,
    kPortFull,
    kCount
  };
  static constexpr auto kReasons = sim::reasons<CycleReason>({
      {CycleReason::kIdle, sim::idle_reason("idle", "no wave and no batch")},
      {CycleReason::kCovering, sim::working_reason("covering", "blocks and quads of a triangle are tested")},
      {CycleReason::kListing,
       sim::working_reason("listing", "a triangle is added to lists, or a batch's lists are written")},
      {CycleReason::kSettingUp, sim::working_reason("setting_up", "a triangle is set up, and none is being covered")},
      {CycleReason::kTransforming,
       sim::working_reason("transforming", "vertices are transformed, and none is being listed")},
      {CycleReason::kWriting, sim::working_reason("writing", "a wave's hits are written to the tile buffer")},
      {CycleReason::kFetching, sim::working_reason("fetching", "lines are looked up, and no triangle is ready")},
      {CycleReason::kMemory, sim::waiting_reason("memory", "the lines that triangles need are in flight")},
      {CycleReason::kPortFull, sim::waiting_reason("port_full", "writes wait for the port to memory")},
  });
  using Stats = RasterStats;
  struct Links {
    sim::Link<RasterJob>& jobs_in;
    sim::Link<RasterDone>& done_out;
    sim::Link<MemRequest>& memory_out;
    sim::Link<MemResponse>& memory_in;
  };

  RasterUnit(const RasterUnitConfig& config, const RasterMemory& memory, Links links, std::uint16_t client,
             sim::Clock clock, bool ideal_l1 = false);
  RasterUnit(const RasterUnit&) = delete;
  RasterUnit& operator=(const RasterUnit&) = delete;

  sim::Time tick(sim::Time now);
  const sim::Clock& clock() const { return clock_; }
  const Stats& stats() const { return stats_; }
  std::uint64_t retired_items() const {
    return stats_.triangles + stats_.triangles_set_up + stats_.writes + stats_.l1_fills + stats_.batches + stats_.waves;
  }
  const sim::Activity<CycleReason>& activity() const { return activity_; }
  void finish(sim::Time end) { activity_.finish(end); }
  bool idle() const { return !has_jobs() && writes_.empty(); }
  std::string state() const;
  const CacheTags& l1_tags() const { return fetch_.l1_tags(); }
  /// Replaces the contents of the rasteriser's L1. Must be called before the first cycle.
  void set_l1_tags(const CacheTags& tags) { fetch_.set_l1_tags(tags); }

 private:
  struct Job {
    RasterJob job;
    const traces::WorkNode& node() const { return job.work->nodes[job.node]; }
    const traces::RasterWork& work() const { return job.work->raster[node().raster]; }
    bool is_batch() const { return node().kind == traces::WorkNode::Kind::kBin; }
    std::uint32_t triangle_count() const { return work().triangles; }
    const traces::RasterTriangle& triangle_at(std::uint32_t i) const {
      return job.work->raster_triangles[work().first_triangle + i];
    }
    const traces::ListRun& run_at(std::uint32_t i) const { return job.work->list_runs[work().first_run + i]; }
  };
  /// Next triangle of a rasteriser stage: number of its job, and of the triangle within the job.
  struct Cursor {
    std::uint64_t job = 0;
    std::uint32_t triangle = 0;
  };
  enum class End : std::uint8_t { kNot, kWriting, kLeaving };

  // Stages of the rasteriser, from last to first. Functions that return bool return true if the stage did something.
  bool send_line(sim::Time now);
  bool finish_oldest_job(sim::Time now);
  bool write_lists();
  void end_batch_writes();
  bool end_back_stage(sim::Time now);
  void begin_back_stage(sim::Time now);
  bool end_front_stage(sim::Time now);
  void begin_front_stage(sim::Time now);
  bool add_triangle_to_window();
  bool take_job(sim::Time now);

  const Job& job_at(std::uint64_t number) const { return jobs_[number % jobs_.size()]; }
  bool has_jobs() const { return taken_ != ended_; }
  /// Moves the cursor to the first rasteriser job with an unprocessed triangle. Returns false if no job has one.
  bool advance_cursor(Cursor& cursor) const;
  /// Counts the events of the rasteriser's back stage for one triangle: adding it to tile lists (geometry pass), or
  /// finding the samples that it covers (wave). Returns the cycles that this takes.
  std::uint64_t count_binning_cycles(const traces::RasterTriangle& triangle);
  std::uint64_t count_coverage_cycles(const traces::RasterTriangle& triangle, const traces::RasterWork& work);
  void write_vertices();
  std::uint64_t depth_buffer_parts_of(const Job& job) const { return config_.depth_buffer_parts(job.node().items); }
  CycleReason cycle_reason(sim::Time at, bool wrote, bool looked) const;
  sim::Time next_wake(sim::Time now, bool moved) const;

  const RasterUnitConfig config_;
  const RasterMemory memory_;
  const sim::Clock clock_;
  Links links_;
  Stats stats_;
  RasterFetch fetch_;
  WriteCombiner writes_;
  std::vector<Job> jobs_;
  std::uint64_t taken_ = 0, ended_ = 0;    ///< number of rasteriser jobs accepted and finished so far
  Cursor entering_, setting_;              ///< next triangle to enter the window, and next to be set up
  std::uint32_t run_ = 0, run_entry_ = 0;  ///< number of the run (ListRun) of the next list entry to enter the window,
                                           ///< and the entry's index in that run
  bool has_front_ = false, has_back_ = false;
  sim::Time front_until_ = 0, back_until_ = 0;
  std::uint32_t queued_ = 0;    ///< triangles queued from front stage (transform, set-up) to back stage (list, cover)
  std::uint32_t finished_ = 0;  ///< triangles of the oldest job that have completed the back stage
  End end_ = End::kNot;         ///< final phase of the oldest job, if it is in one
  sim::Time end_until_ = 0;
  std::uint64_t closed_ = 0;  ///< the oldest batch ends when sent_lines() has reached this value of closed_lines()
  std::uint32_t out_run_ = 0,
                out_entry_ = 0;  ///< number of the run (ListRun) of the oldest batch's next list entry to write, and
                                 ///< the entry's index in that run
  sim::Activity<CycleReason> activity_;
};

}  // namespace hw
