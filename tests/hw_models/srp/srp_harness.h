#pragma once
#include <array>
#include <cstdint>
#include <deque>
#include <string>
#include <vector>

#include "hw_models/srp/srp.h"
#include "sim/engine.h"

namespace hw::test {

/// A shader core with tiles as fast as it takes them. Its T&I unit, memory and DMA each answer after a fixed time.
/// Kernels are given by initiation interval and depth.
class SrpHarness {
 public:
  /// Runs launches one by one, so that each takes its own time.
  static SrpConfig without_merging() {
    SrpConfig config;
    config.merge = false;
    return config;
  }
  struct Setup {
    SrpConfig config = without_merging();
    TileBufferConfig buffer{.size = {1 << 20}};
    std::uint32_t tni_latency = 10;      ///< cycles from the arrival of a ray to the sending of its hit
    std::uint32_t memory_latency = 100;  ///< cycles from the arrival of a request to the sending of its line
    std::uint32_t dma_latency = 5;
    std::uint32_t ray_interval = 1;  ///< cycles between rays on the direct interface
    std::uint32_t tile_samples = 16;
    std::uint32_t wave_samples = 0;
    bool ideal = false;
    Observer* observer = nullptr;
  };
  struct Kernel {
    std::uint32_t ii = 1, depth = 10;
    BankConflicts conflicts{};
  };
  /// Addresses of picture, samples, rates and spilled slots.
  static constexpr std::array<Addr, kAreas> kBases{Addr{1} << 24, Addr{1} << 25, Addr{1} << 26, Addr{1} << 28};
  /// Cycles of a switch to a resident kernel, and to one of interval `ii` that is loaded. By default each row is 16
  /// words of 8 bytes, and 64 bytes are loaded per cycle.
  static constexpr std::uint64_t kResident = 8;
  static constexpr std::uint64_t cold(std::uint64_t ii) { return kResident + 2 * ii; }

  /// Cycles from a miss to its line, with the link to memory; and from a load to the use of its data.
  static constexpr std::uint64_t kLine = 1 + 100, kLoad = 4 + 60;

  struct RaySent {
    std::uint64_t cycle = 0;
    std::uint32_t tile = 0, ray = 0;  ///< slot of the tile in flight, and ray of the tile
  };

  SrpHarness(const Setup& setup, const std::vector<Kernel>& kernels);

  /// `missing`: borders that are missing when the tile is dispatched, a bit for each of its imports.
  SrpHarness& add(traces::TileWork work, std::uint32_t missing = 0);
  /// Sends the i-th tile an update in this cycle: these borders are still missing.
  SrpHarness& tell(std::uint64_t cycle, std::size_t tile, std::uint32_t missing);
  template <sim::Skip kSkip = sim::Skip::kOn>
  SrpHarness& run() {
    end_ = clock_.edge_after(sim::run<kSkip>(*this), 1);
    machine_.finish(end_);
    return *this;
  }

  // Interface for the engine.
  sim::Machine& machine() { return machine_; }
  bool done() const { return tiles_done_.size() == works_.size(); }

  const Srp& srp() const { return *srp_; }
  /// Cycles for which kernel `k` occupied the array, with switch and stalls.
  std::uint64_t cycles(std::size_t k) const { return srp_->kernel_use()[k].cycles; }
  std::uint64_t spent(Srp::CycleReason why) const { return clock_.cycles(srp_->activity().spent(why)); }
  std::uint64_t elapsed() const { return clock_.cycles(end_); }
  const std::vector<RaySent>& rays() const { return rays_; }
  const std::vector<DmaJob>& transfers() const { return transfers_; }
  const std::vector<std::uint32_t>& tiles_done() const { return tiles_done_; }
  /// Borders that tiles have written, in order.
  const std::vector<traces::Border>& borders() const { return borders_; }
  /// Returns when the i-th tile to end left the shader core, in cycles after the first tile was visible to it.
  std::uint64_t done_at(std::size_t i) const { return done_at_[i] - 2; }

 private:
  /// The environment of the shader core.
  struct World {
    explicit World(SrpHarness& b) : harness(b) {}
    sim::Time tick(sim::Time now);
    SrpHarness& harness;
    std::size_t tiles_sent = 0;
  };
  struct News {
    std::uint64_t cycle = 0;
    std::size_t tile = 0;
    std::uint32_t missing = 0;
  };

  const sim::Clock clock_{1'000'000};
  traces::Layout layout_;
  std::vector<KernelSchedule> kernels_;
  std::vector<BankConflicts> conflicts_;
  sim::Machine machine_;
  const sim::UnitId world_id_, srp_id_;
  sim::Link<TileJob>& tiles_in_;
  sim::Link<TileDone>& tiles_out_;
  sim::Link<RayJob>& rays_out_;
  sim::Link<RayDone>& hits_in_;
  sim::Link<MemRequest>& memory_out_;
  sim::Link<MemResponse>& memory_in_;
  sim::Link<DmaJob>& dma_out_;
  sim::Link<DmaDone>& dma_in_;
  Srp* srp_ = nullptr;
  std::deque<traces::TileWork> works_;
  std::vector<std::uint32_t> missing_;  ///< missing borders, by tile
  std::vector<News> news_;
  std::vector<RaySent> rays_;
  std::vector<DmaJob> transfers_;
  std::vector<std::uint32_t> tiles_done_;
  std::vector<traces::Border> borders_;
  std::vector<std::uint64_t> done_at_;
  sim::Time end_ = 0;
};

/// Builds a tile's work graph node by node. Every call returns the new node.
class TileBuilder {
 public:
  using Node = std::uint32_t;
  using Edge = traces::Edge;

  explicit TileBuilder(std::uint32_t tile = 0) { work_.tile = tile; }
  Node launch(traces::KernelId kernel, std::uint32_t items, std::vector<Edge> inputs = {});
  /// A launch whose items read memory; `accesses[i]` are those of item i.
  Node launch(traces::KernelId kernel, const std::vector<std::vector<traces::Access>>& accesses,
              std::vector<Edge> inputs = {});
  /// Adds `items` idle items to a launch.
  void idle(Node launch, std::uint32_t items) { work_.nodes[launch].idle = items; }
  /// A ray for each item of `launch`, or for each item in `sources`.
  Node rays(Node launch, std::uint32_t count, std::vector<std::uint32_t> sources = {});
  Node transfer(traces::Region region, bool to_memory, std::uint32_t bytes, std::vector<Edge> inputs = {},
                std::uint64_t offset = 0);
  Node picture(std::uint32_t bytes, Node after) {
    return transfer(traces::Region::kPicture, true, bytes, {all(after)});
  }
  /// A transfer that reads a border of another tile.
  Node import_border(traces::Border border, std::uint32_t bytes);
  /// A transfer that completes border `number`.
  Node export_border(std::uint32_t number, std::uint32_t bytes, std::vector<Edge> inputs);
  traces::TileWork build();

  static Edge all(Node node) { return {node, Edge::Kind::kAll}; }
  static Edge each(Node node) { return {node, Edge::Kind::kEach}; }
  /// An edge of kind kEach from a node whose items map to those of `sources`.
  TileBuilder& map(Node node, const std::vector<std::uint32_t>& sources);

 private:
  Node add(traces::WorkNode::Kind kind, std::uint32_t items, std::vector<Edge> inputs);

  traces::TileWork work_;
};

/// Cycles of a switch to a kernel of interval 1 that is loaded.
inline constexpr std::uint64_t kSwitch = SrpHarness::cold(1);

/// Two kernels of a harness.
inline constexpr traces::KernelId kA = 0, kB = 1;

/// Rays made by a launch of kernel A and shaded item by item by kernel B. `reads_first`: after data from memory have
/// arrived.
traces::TileWork trace_and_shade(std::uint32_t items, std::uint32_t tile = 0, bool reads_first = false);

}  // namespace hw::test
