#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "hw_models/memory/observer.h"
#include "sim/io/json.h"
#include "tools/run/frame/run_job.h"
#include "tools/tiles/tile_table.h"

namespace tools {

/// A slice of the timeline: one activity of a core or of the tree builder, with its begin and end.
struct RecordedSlice {
  enum class Kind : std::uint8_t { kTile, kLoop, kRays, kTransfer, kBuild };
  Kind kind = Kind::kTile;
  std::uint8_t what = 0;   ///< kRays: kind of ray; kTransfer: area of memory; kBuild: hw::BuildPass
  bool to_memory = false;  ///< kTransfer: true for a write to memory
  std::uint16_t core = 0;
  std::uint16_t slot = 0;          ///< kTile: tile slot of the core
  std::uint16_t kernel = 0;        ///< kLoop: number of the kernel
  std::uint32_t entry = kNoEntry;  ///< index in the tile list
  std::uint32_t amount = 0;        ///< kLoop: items; kRays: rays; kTransfer: bytes; kBuild: triangles or instances
  std::uint32_t launches = 0;      ///< kLoop: number of chunks of kernel launches in the loop
  std::uint32_t runs = 0;          ///< kBuild: number of runs of sorted records
  std::uint32_t rays_at_begin = 0, rays_at_end = 0;  ///< kRays: number of rays in the core's T&I unit
  sim::Time begin = 0, end = 0;
  sim::Time configured = 0, start = 0;  ///< kLoop: end of the configuration switch; begin of the loop
  std::uint64_t cycles = 0;             ///< kLoop: cycles of the shader core
  sim::Time stalled = 0;                ///< kLoop: time in which the shader core was stalled
  static constexpr std::uint32_t kNoEntry = 0xffffffffU;
};

/// Activity of L2 and memory in one bin of time.
struct MemoryBin {
  std::uint64_t l2_hits = 0, l2_misses = 0;
  /// Lines that the memory has read and written, counted at the end of each transfer.
  std::uint64_t lines_read = 0, lines_written = 0;
};

/// Records a machine's activity in a frame for a timeline.
class TimelineRecorder final : public hw::Observer {
 public:
  static constexpr sim::Time kBin = 1'000'000'000;  ///< length of a time bin: a microsecond

  explicit TimelineRecorder(std::uint32_t cores) : slots_(cores), batches_(cores) {}
  void on_event(const hw::Event& event) override;

  /// Returns the recorded slices in the order in which they ended.
  const std::vector<RecordedSlice>& slices() const { return slices_; }
  const std::vector<MemoryBin>& memory_bins() const { return memory_; }

 private:
  void start_tile(const hw::TileStarted& event);
  void end_tile(const hw::TileEnded& event);
  void add_loop(const hw::LoopEnded& loop);
  void end_batch(const hw::BatchEnded& event);
  void add_transfer(const hw::TransferEnded& transfer);
  void add_build_pass(const hw::BuildPassEnded& pass);

  struct Slot {
    hw::TileTag owner = hw::kNoTile;
    std::uint32_t entry = RecordedSlice::kNoEntry;
    sim::Time begin = 0;
  };
  struct Batch {
    std::uint32_t slot = 0, node = 0;
    std::uint32_t rays = 0;  ///< rays in the T&I unit when the batch began
    sim::Time begin = 0;
  };
  MemoryBin& bin_at(sim::Time at) {
    const auto index = static_cast<std::size_t>(at / kBin);
    if (index >= memory_.size()) [[unlikely]]
      memory_.resize(index + 1);
    return memory_[index];
  }
  std::uint32_t entry_of(std::uint32_t core, hw::TileTag tile) const;

  std::uint32_t newest_ = 0;                 ///< highest index in the tile list of the tiles that cores have started
  std::vector<std::vector<Slot>> slots_;     ///< tile slots, by core
  std::vector<std::vector<Batch>> batches_;  ///< batches of rays in flight, by core
  std::vector<RecordedSlice> slices_;
  std::vector<MemoryBin> memory_;
};

/// Tiles that a timeline shows, as given to `--timeline`.
struct TimelineSelection {
  enum class Kind : std::uint8_t { kAll, kSlowest, kTile, kPixel };
  Kind kind = Kind::kAll;
  std::uint32_t count = 0;     ///< kSlowest: number of tiles
  std::uint32_t x = 0, y = 0;  ///< kTile: column and row of the tile; kPixel: column and row of the pixel
  bool needs_tile_positions() const { return kind == Kind::kTile || kind == Kind::kPixel; }
};

/// Parses "all", "slowest:8", "tile:3,2" or "pixel:200,100"; throws InputError for other texts.
TimelineSelection parse_timeline(const std::string& text);

/// Returns the selected rows of `tiles`, in order of priority; a tile of several passes has several rows. The slowest
/// tiles have the most cycles from dispatch to end; of equal ones the earlier is first. Throws InputError if there is
/// no such tile.
std::vector<std::size_t> selected_tiles(const TimelineSelection& selection, const TileFrame& tiles);

inline constexpr const char* kTimelineFile = "timeline.pftrace";
inline constexpr std::uint64_t kMostTimelineBytes = std::uint64_t{32} << 20;

/// A timeline of a frame as a Perfetto trace file.
struct Timeline {
  std::string bytes;
  std::uint64_t slices = 0;   ///< slices in the trace
  std::uint64_t dropped = 0;  ///< selected slices left out because of the size limit
};

/// Exports all activity of cores during the selected tiles (dependencies may be in other tiles).
///
/// 1. Each core is a process with tracks for its shader core, for overlapping batches of rays, for its DMA and for each
///    tile slot. One more process, `shared`, has the counters of L2, memory and power, and a track for the tree
///    builder, which is shown whatever tiles are selected.
/// 2. A flow connects the slices of each tile.
/// 3. If the file would exceed `most_bytes`, slices are left out, those of the last selected tiles first. If all tiles
///    are selected, the latest slices are left out.
Timeline make_timeline(const TimelineRecorder& recorder, const TimelineSelection& selection, const FrameResult& s,
                       const TileFrame& tiles, const RunConfig& config, std::uint64_t most_bytes = kMostTimelineBytes);

/// The option `--timeline` of a job: records the job's first frame.
class TimelineJob {
 public:
  /// `text`: argument of the option --timeline; empty: no timeline. Throws InputError for an invalid text.
  explicit TimelineJob(std::string text);

  const std::optional<TimelineSelection>& tile_selection() const { return selection_; }
  /// Throws InputError if the selected tile or pixel is outside the picture of the current frame of `inputs`.
  void check_selection(const Inputs& inputs, const kernels::ProgramSpec& program) const;
  /// Returns the observer of the next frame's machine; null from the second frame on.
  hw::Observer* begin_frame(const RunConfig& config);
  /// Makes the timeline of the first frame; ignores later frames. If the frame was interrupted before a selected tile,
  /// there is no timeline, and write_file() adds a warning to the report.
  void end_frame(const FrameResult& s, const TileFrame& tiles, const RunConfig& config);
  /// Writes the timeline file, and adds the numbers of shown and dropped slices to the report.
  void write_file(const std::filesystem::path& folder, sim::Json& report) const;

 private:
  const std::string asked_;
  std::optional<TimelineSelection> selection_;
  std::optional<TimelineRecorder> recorder_;
  std::optional<Timeline> made_;
  std::string problem_;  ///< why there is no timeline
};

}  // namespace tools
