#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "hw_models/memory/l1_cache.h"
#include "hw_models/raster/raster_memory.h"
#include "hw_models/raster/raster_stats.h"
#include "hw_models/raster/raster_unit_config.h"
#include "hw_models/raster/vertex_cache.h"
#include "traces/stream.h"

namespace hw {

/// Fetches what triangles need, in their order, ahead of their use.
///
///   triangle --> [ entry of the list ] --> [ numbers of its vertices ] --> [ vertices ] --> ready, oldest first
///
/// Each stage looks its lines up in the L1, a triangle after the other, and waits for none: a triangle goes on to the
/// next stage once its lines have come. Of a batch there is no list to read, and vertices lately transformed are not
/// fetched again. Not modelled: the time that a hit takes, which the window hides.
class RasterFetch {
 public:
  RasterFetch(const RasterUnitConfig& config, const RasterMemory& memory, std::uint16_t port, bool ideal,
              RasterStats& stats)
      : memory_(memory),
        l1_(config.l1, port, ideal),
        lookups_(config.lookups),
        slots_(config.window),
        vertex_cache_(config.vertex_cache),
        stats_(stats) {}

  bool has_room() const { return entered_ - left_ < slots_.size(); }
  bool empty() const { return entered_ == left_; }
  /// A triangle enters; `entry`: where it stands among the lists, or kBatch; `owner`: the tile that it is for.
  void enter(const traces::RasterTriangle& triangle, std::uint32_t entry, Owner owner);
  static constexpr std::uint32_t kBatch = traces::WorkNode::kNone;

  /// The oldest triangle has all that it needs.
  bool ready() const { return !empty() && done_[kLast] > left_ && slot(left_).pending == 0; }
  /// Vertices of it that must be transformed.
  std::uint32_t missed() const { return slot(left_).missed; }
  std::array<std::uint32_t, 3> missed_vertices() const { return slot(left_).vertices; }
  void leave() { left_ += 1; }

  /// Looks lines up; true if something was done.
  bool look_up();
  void fill(Addr line);
  void send(sim::Time now, sim::Link<MemRequest>& out) { l1_.send(now, out); }
  sim::Time send_at(sim::Time next, const sim::Link<MemRequest>& out) const { return l1_.send_at(next, out); }
  std::string state() const;

 private:
  enum Stage : std::uint8_t { kList, kIndices, kVertices, kStages };
  static constexpr Stage kLast = kVertices;
  static constexpr std::size_t kMostLines = 6;  ///< three vertices, each across the end of a line
  struct Slot {
    const traces::RasterTriangle* triangle = nullptr;
    std::uint32_t entry = kBatch;
    std::uint32_t pending = 0;  ///< lines on their way
    std::array<Addr, kMostLines> lines{};
    std::uint32_t count = 0, next = 0;  ///< lines of the present stage, and the next to be looked up
    bool listed = false;                ///< `lines` are those of the present stage
    std::uint32_t missed = 0;
    std::array<std::uint32_t, 3> vertices{};  ///< those missed
  };

  Slot& slot(std::uint64_t number) { return slots_[number % slots_.size()]; }
  const Slot& slot(std::uint64_t number) const { return slots_[number % slots_.size()]; }
  /// Looks one line up at a stage, or lets a triangle without any pass; false if it cannot. Counts what it looked up.
  bool advance(Stage stage, std::uint32_t& looked);
  void list_lines(Stage stage, Slot& slot);
  void list_vertices(Slot& slot);
  static void add(Slot& slot, Addr first, std::uint32_t bytes);

  const RasterMemory memory_;
  L1Cache l1_;
  const std::uint32_t lookups_;
  std::vector<Slot> slots_;
  std::uint64_t entered_ = 0, left_ = 0;       ///< triangles, counted
  std::array<std::uint64_t, kStages> done_{};  ///< triangles that have been through a stage's look-ups
  VertexCache vertex_cache_;
  RasterStats& stats_;
};

}  // namespace hw
