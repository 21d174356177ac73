#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "hw_models/build/build_fetch.h"
#include "hw_models/build/tree_builder_config.h"
#include "hw_models/memory/messages.h"
#include "hw_models/memory/observer.h"
#include "hw_models/memory/unit_names.h"
#include "hw_models/memory/write_combiner.h"
#include "hw_models/srp/messages.h"
#include "sim/link.h"
#include "sim/named.h"
#include "sim/unit_report.h"
#include "traces/stream.h"

namespace hw {

/// Addresses of the builder's arrays in memory: vertex positions, vertex numbers of triangles, matrices of instances,
/// and two arrays of sorted records. No two arrays share a cache line.
struct BuildMemory {
  static constexpr std::uint32_t kPositionBytes = 12;  ///< vertex position: three floats
  static constexpr std::uint32_t kIndexBytes = 12;     ///< vertex numbers of a triangle: three integers
  static constexpr std::uint32_t kInstanceBytes = 64;  ///< matrix and mesh of an instance

  Addr positions = 0, indices = 0, instances = 0;
  std::array<Addr, 2> records{};
  Addr tree = 0;  ///< first byte of the tree that is written
  Addr end = 0;

  BuildMemory() = default;
  /// `scene_tree`: address of the tree that rays read.
  BuildMemory(Addr base, Addr scene_tree, const traces::BuildArraySizes& sizes, std::uint32_t record_bytes)
      : positions(base) {
    indices = round_up_to_lines(positions + Addr{sizes.vertices} * kPositionBytes);
    instances = round_up_to_lines(indices + Addr{sizes.triangles} * kIndexBytes);
    records[0] = round_up_to_lines(instances + Addr{sizes.instances} * kInstanceBytes);
    const Addr items = Addr{sizes.triangles} + sizes.instances;
    records[1] = round_up_to_lines(records[0] + items * record_bytes);
    const Addr shadow = round_up_to_lines(records[1] + items * record_bytes);
    tree = sizes.shadow_bytes != 0 ? shadow : scene_tree;
    end = round_up_to_lines(shadow + sizes.shadow_bytes);
  }
};

/// Counters of the tree builder. Bytes are those that the algorithm needs; lines and parts of lines are what it moves.
struct TreeBuilderStats {
  std::uint64_t trees_built = 0, trees_refitted = 0, triangles = 0, instances = 0;
  std::uint64_t boxes = 0, records_sorted = 0, records_merged = 0, leaves_written = 0, comparisons = 0;
  std::uint64_t sort_words = 0, head_words = 0, merge_words = 0;
  std::uint64_t input_bytes = 0, record_bytes_written = 0, record_bytes_read = 0, node_bytes_read = 0;
  std::uint64_t tree_bytes_written = 0;
  std::uint64_t buffer_hits = 0, buffer_misses = 0, buffer_fills = 0, writes = 0;
  std::uint64_t caches_invalidated = 0, lines_invalidated = 0;

  static void describe(auto& s, auto&& counter) {
    counter(NAMED(s.trees_built), "trees built");
    counter(NAMED(s.trees_refitted), "trees refitted");
    counter(NAMED(s.triangles), "triangles of these trees");
    counter(NAMED(s.instances), "instances of these trees");
    counter(NAMED(s.boxes), "boxes of triangles and instances computed", "build.box");
    counter(NAMED(s.records_sorted), "records sorted on chip");
    counter(NAMED(s.sort_words), "words of 8 bytes that pass a level of the on-chip sort", "build.sort");
    counter(NAMED(s.records_merged), "records merged from runs");
    counter(NAMED(s.head_words), "words of 8 bytes read from heads of runs", "build.head_read");
    counter(NAMED(s.merge_words), "words of 8 bytes that pass a level of the tournament between heads", "build.merge");
    counter(NAMED(s.leaves_written), "triangles and instances added to the hierarchy, or refitted", "build.hierarchy");
    counter(NAMED(s.comparisons), "comparisons of clusters by PLOC", "build.compare");
    counter(NAMED(s.input_bytes), "bytes of vertices, vertex numbers and instances used");
    counter(NAMED(s.record_bytes_written), "bytes of sorted records written");
    counter(NAMED(s.record_bytes_read), "bytes of sorted records read");
    counter(NAMED(s.node_bytes_read), "bytes of nodes read by refits");
    counter(NAMED(s.tree_bytes_written), "bytes of nodes and leaves written");
    counter(NAMED(s.buffer_hits), "look-ups that hit in the input buffer", "cache.l1_read");
    counter(NAMED(s.buffer_misses), "look-ups that missed", "cache.l1_probe");
    counter(NAMED(s.buffer_fills), "lines filled into the input buffer", "cache.l1_fill");
    counter(NAMED(s.writes), "lines or parts of lines written");
    counter(NAMED(s.caches_invalidated), "invalidations of all first-level caches, one per tree");
    counter(NAMED(s.lines_invalidated), "lines of first-level caches that these invalidations removed");
  }
};

/// The tree builder, a streaming unit that builds or refits one tree at a time. It is a client of core 0's port.
///
///   build:  triangles --> [ box, Morton code ] --> [ sort on chip ] --> runs --> memory
///           runs --> [ merge ] --> ... --> [ merge, hierarchy ] <-- triangles;  --> nodes, leaves --> memory
///   refit:  triangles, nodes --> [ boxes ] --> nodes, leaves --> memory
///
/// 1. The sort pass reads all triangles in input order, `run` of them at a time. A tree of one run keeps its records on
/// chip.
/// 2. More than `ways` runs are merged by intermediate passes, which read and write all records.
/// 3. The last pass merges the records, reads the triangles again in leaf order, and writes nodes and leaves in order.
/// For a tree of PLOC, it also compares clusters in a window of the sorted stream.
/// 4. A pass starts when all lines of the previous pass have been written.
/// 5. After each tree, all first-level caches are invalidated, because they may hold lines of the old tree.
/// 6. A record passes one level of the on-chip sort per doubling of its run, and all levels of the tournament that
/// merges `ways` runs.
///
/// The host built the tree beforehand; the unit moves its bytes. Not modelled: the order in which a merge empties its
/// runs (they advance in turn), the time to drain the on-chip sort at the end of a run, stacks of the hierarchy.
class TreeBuilder {
 public:
  static constexpr const char* kName = "tree_builder";
  static constexpr Block kBlock = Block::kBuild;
  static constexpr std::uint32_t kJobs = 1024;  ///< capacity of the queue of trees that wait for the builder
  enum class CycleReason : std::uint8_t {
    kIdle,
    kSorting,
    kMerging,
    kEmitting,
    kRefitting,
    kFetching,
    kInvalidating,
    kMemory,
    kPortFull,
    kCount
  };
  static constexpr auto kReasons = sim::reasons<CycleReason>({
      {CycleReason::kIdle, sim::idle_reason("idle", "no tree to build")},
      {CycleReason::kSorting, sim::working_reason("sorting", "a triangle is encoded and sorted into a run")},
      {CycleReason::kMerging, sim::working_reason("merging", "a record is merged into a longer run")},
      {CycleReason::kEmitting, sim::working_reason("emitting", "a triangle is added to the hierarchy")},
      {CycleReason::kRefitting, sim::working_reason("refitting", "the boxes of a triangle and its nodes are computed")},
      {CycleReason::kFetching, sim::working_reason("fetching", "lines are looked up, and no triangle is ready")},
      {CycleReason::kInvalidating, sim::working_reason("invalidating", "first-level caches are invalidated")},
      {CycleReason::kMemory, sim::waiting_reason("memory", "the lines that triangles need are in flight")},
      {CycleReason::kPortFull, sim::waiting_reason("port_full", "writes wait for the port to memory")},
  });
  using Stats = TreeBuilderStats;
  struct Links {
    sim::Link<TileJob>& jobs_in;
    sim::Link<TileDone>& done_out;
    sim::Link<MemRequest>& memory_out;
    sim::Link<MemResponse>& memory_in;
    Observer* observer = nullptr;
  };

  TreeBuilder(const TreeBuilderConfig& config, const BuildMemory& memory, Links links, std::uint16_t client,
              sim::Clock clock, bool ideal_buffer = false);
  TreeBuilder(const TreeBuilder&) = delete;
  TreeBuilder& operator=(const TreeBuilder&) = delete;

  sim::Time tick(sim::Time now);
  const sim::Clock& clock() const { return clock_; }
  const Stats& stats() const { return stats_; }
  std::uint64_t retired_items() const {
    return stats_.boxes + stats_.records_merged + stats_.leaves_written + stats_.writes + stats_.buffer_fills;
  }
  const sim::Activity<CycleReason>& activity() const { return activity_; }
  void finish(sim::Time end) { activity_.finish(end); }
  std::string state() const;
  /// Counts lines that were removed from first-level caches on behalf of the builder.
  void count_invalidated_lines(std::uint64_t lines) { stats_.lines_invalidated += lines; }

  /// Returns the number of intermediate merge passes for a tree over `items` triangles or instances.
  static std::uint32_t intermediate_merges(const TreeBuilderConfig& config, std::uint32_t items);

 private:
  enum class State : std::uint8_t { kIdle, kPass, kInvalidating, kLeaving };
  /// An array that a pass writes in order.
  struct Output {
    Output(std::uint32_t queue, std::uint16_t client) : lines(queue, client) {}
    void begin(Addr first, std::uint64_t size) { base = first, bytes = size, cursor = target = 0; }
    WriteCombiner lines;
    Addr base = 0;
    std::uint64_t bytes = 0;               ///< bytes that the pass writes
    std::uint64_t cursor = 0, target = 0;  ///< bytes passed to `lines`, and bytes that finished items have produced
  };
  /// Number and first record of a run.
  struct RunRecord {
    std::uint64_t index = 0;  ///< index of the record in its array
    bool is_first = false;    ///< the record is the first of its run
  };

  // Steps of a tick. Functions that return bool return true if the step did something.
  bool take_job(sim::Time now);
  bool end_item(sim::Time now);
  bool queue_outputs();
  bool end_pass(sim::Time now);
  bool begin_item(sim::Time now);
  bool add_item();
  bool send_line(sim::Time now);

  const traces::WorkNode& node() const { return job_.work->nodes.front(); }
  const traces::BuildWork& work() const { return job_.work->build[node().first]; }
  bool has_triangles() const { return work().input == traces::BuildWork::Input::kTriangles; }
  void begin_pass(BuildPass pass, sim::Time now);
  void notify_pass_end(sim::Time now, BuildPass pass) const;
  std::uint32_t comparison_cycles() const;
  /// Returns the record that the merge reads as item `item`.
  RunRecord record_of(std::uint32_t item) const;
  void add_record_lines(std::uint32_t item, BuildLines& lines) const;
  void add_input_lines(std::uint32_t input, BuildLines& lines) const;
  BuildLines lines_of(std::uint32_t item) const;
  void count_item();
  void count_sorted_record();
  void count_merged_record();
  bool outputs_lag() const;
  bool outputs_are_sent() const;
  CycleReason cycle_reason(sim::Time at, bool looked, bool sent) const;
  sim::Time next_wake(sim::Time now, bool moved) const;

  const TreeBuilderConfig config_;
  const BuildMemory memory_;
  const sim::Clock clock_;
  Links links_;
  Stats stats_;
  BuildFetch fetch_;
  std::vector<Output> outputs_;  ///< sorted records or nodes, leaves, labels

  State state_ = State::kIdle;
  TileJob job_;
  BuildPass pass_ = BuildPass::kSort;
  sim::Time begun_at_ = 0;  ///< begin of the current pass or invalidation
  std::uint32_t items_ = 0;
  std::uint32_t runs_ = 0;    ///< runs that the current pass reads, or that the sort pass writes
  std::uint32_t source_ = 0;  ///< array of records that the current pass reads
  bool records_in_memory_ = false;
  std::uint32_t interval_ = 1;   ///< cycles per item of the current pass
  std::uint32_t entered_ = 0;    ///< items of the pass that have entered the window
  std::uint32_t processed_ = 0;  ///< items of the pass that are finished
  bool busy_ = false;
  sim::Time busy_until_ = 0;  ///< end of the current item or of the invalidation
  sim::Activity<CycleReason> activity_;
};

}  // namespace hw
