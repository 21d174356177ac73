#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "hw_models/memory/unit_names.h"
#include "hw_models/raster/raster_fetch.h"
#include "hw_models/raster/raster_memory.h"
#include "hw_models/raster/raster_stats.h"
#include "hw_models/raster/raster_unit_config.h"
#include "hw_models/raster/raster_writes.h"
#include "hw_models/srp/messages.h"
#include "sim/activity.h"
#include "sim/link.h"

namespace hw {

/// A core's tile-based rasteriser. In the geometry pass it puts triangles into lists, later it finds a wave's primary
/// hits by the list of its tile:
///
///   batches --> [ fetch: numbers, vertices ] --> [ transform ] --> [ cull, list ] --> vertices, lists --> memory
///   waves   --> [ fetch: list, numbers, vertices ] --> [ set-up ] --> [ blocks, quads, depth ] --> hits --> tile
///   buffer
///
/// One job is listed or covered at a time, in their order, while lines of those behind it are fetched. A batch's
/// entries leave when all its triangles have been through; a wave's hits leave, so many bytes a cycle, when all have.
/// Depth and the nearest triangle of each sample lie in the unit; what a sample gets in the tile buffer is interpolated
/// once, for the winner. A wave that the depth buffer does not hold goes through it in parts, each of which sets all
/// triangles up again.
///
/// Not modelled: fetching the list again for further parts; a limit on the entries that a batch gathers; transforming
/// by a shader: vertices have a unit of their own, that knows no skins; the wait of reads of lists in another core for
/// the last writes, which the end of the pass covers.
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
      {CycleReason::kIdle, sim::idle("idle", "no wave and no batch")},
      {CycleReason::kCovering, sim::working("covering", "blocks and quads of a triangle are tested")},
      {CycleReason::kListing, sim::working("listing", "a triangle is put into lists, or a batch's lists are written")},
      {CycleReason::kSettingUp, sim::working("setting_up", "a triangle is set up, and none is being covered")},
      {CycleReason::kTransforming, sim::working("transforming", "vertices are transformed, and none is being listed")},
      {CycleReason::kWriting, sim::working("writing", "a wave's hits go to the tile buffer")},
      {CycleReason::kFetching, sim::working("fetching", "lines are looked up, and no triangle is ready")},
      {CycleReason::kMemory, sim::waiting("memory", "lines that triangles need are on their way")},
      {CycleReason::kPortFull, sim::waiting("port_full", "what is written waits for the way to memory")},
  });
  using Stats = RasterStats;
  struct Links {
    sim::Link<RasterJob>& jobs_in;
    sim::Link<RasterDone>& done_out;
    sim::Link<MemRequest>& memory_out;
    sim::Link<MemResponse>& memory_in;
  };

  RasterUnit(const RasterUnitConfig& config, const RasterMemory& memory, Links links, std::uint16_t port,
             sim::Clock clock, bool ideal_l1 = false);
  RasterUnit(const RasterUnit&) = delete;
  RasterUnit& operator=(const RasterUnit&) = delete;

  sim::Time tick(sim::Time now);
  const sim::Clock& clock() const { return clock_; }
  const Stats& stats() const { return stats_; }
  std::uint64_t retired() const {
    return stats_.triangles + stats_.triangles_set_up + stats_.writes + stats_.l1_fills + stats_.batches + stats_.waves;
  }
  const sim::Activity<CycleReason>& activity() const { return activity_; }
  void finish(sim::Time end) { activity_.finish(end); }
  bool idle() const { return !has_jobs() && writes_.empty(); }
  std::string state() const;

 private:
  struct Job {
    RasterJob job;
    const traces::WorkNode& node() const { return job.work->nodes[job.node]; }
    const traces::RasterWork& work() const { return job.work->raster[node().raster]; }
    bool bins() const { return node().kind == traces::WorkNode::Kind::kBin; }
    std::uint32_t triangles() const { return work().triangles; }
    const traces::RasterTriangle& triangle(std::uint32_t i) const {
      return job.work->raster_triangles[work().first_triangle + i];
    }
    const traces::ListRun& run(std::uint32_t i) const { return job.work->list_runs[work().first_run + i]; }
  };
  /// How far a stage is: a job, counted, and a triangle of it.
  struct Cursor {
    std::uint64_t job = 0;
    std::uint32_t triangle = 0;
  };
  enum class End : std::uint8_t { kNot, kWriting, kLeaving };

  // From the last stage to the first; each true if it did something.
  bool send(sim::Time now);
  bool end_job(sim::Time now);
  bool write_lists();
  void close_writes();
  bool end_back(sim::Time now);
  void begin_back(sim::Time now);
  bool end_front(sim::Time now);
  void begin_front(sim::Time now);
  bool enter();
  bool take_job(sim::Time now);

  const Job& job(std::uint64_t number) const { return jobs_[number % jobs_.size()]; }
  bool has_jobs() const { return taken_ != ended_; }
  /// Takes a stage to the next triangle; false if there is none.
  bool find(Cursor& at) const;
  std::uint64_t list_cycles(const traces::RasterTriangle& triangle);
  std::uint64_t cover_cycles(const traces::RasterTriangle& triangle, const traces::RasterWork& work);
  void transform();
  std::uint64_t parts_of(const Job& job) const { return config_.parts(job.node().items); }
  CycleReason why(sim::Time at, bool wrote, bool looked) const;
  sim::Time next_wake(sim::Time now, bool moved) const;

  const RasterUnitConfig config_;
  const RasterMemory memory_;
  const sim::Clock clock_;
  Links links_;
  Stats stats_;
  RasterFetch fetch_;
  RasterWrites writes_;
  std::vector<Job> jobs_;
  std::uint64_t taken_ = 0, ended_ = 0;    ///< jobs, counted
  Cursor entering_, setting_;              ///< the next to enter the window, to be set up
  std::uint32_t run_ = 0, run_entry_ = 0;  ///< next entry of the job that enters: its run, and which there
  bool has_front_ = false, has_back_ = false;
  sim::Time front_until_ = 0, back_until_ = 0;
  std::uint32_t queued_ = 0;    ///< triangles between these
  std::uint32_t finished_ = 0;  ///< triangles of the oldest job that have been through
  End end_ = End::kNot;         ///< how far the oldest job's end is
  sim::Time end_until_ = 0;
  std::uint64_t closed_ = 0;                   ///< lines that must have been sent before a batch ends
  std::uint32_t out_run_ = 0, out_entry_ = 0;  ///< entry of a batch to be written next: its run, and which there
  sim::Activity<CycleReason> activity_;
};

}  // namespace hw
