#pragma once
#include <array>
#include <cstdint>
#include <deque>
#include <string>
#include <vector>

#include "hw_models/srp/srp.h"
#include "sim/engine.h"

namespace hw::test {

/// Test harness for a shader core that gets tiles as fast as it accepts them. T&I unit, memory and DMA answer after
/// fixed times. Kernels are given by initiation interval and depth.
class SrpHarness {
 public:
  /// Returns a configuration that does not merge launches, so that each launch takes its own time.
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
  /// Base addresses of picture, samples, rates and spilled slots.
  static constexpr std::array<Addr, kAreas> kBases{Addr{1} << 24, Addr{1} << 25, Addr{1} << 26,
                                                   Addr{1} << 27, Addr{1} << 29, Addr{1} << 28};
  /// Cycles of a switch to a kernel that is resident, and to a kernel of initiation interval `ii` that must be loaded.
  /// The latter kernel's configuration has `ii` rows, by default of 16 words of 8 bytes; 64 bytes are loaded per cycle.
  static constexpr std::uint64_t kResident = 8;
  static constexpr std::uint64_t cold(std::uint64_t ii) { return kResident + 2 * ii; }

  /// kLine: cycles from a cache miss to the arrival of its line. kLoad: cycles from a load to the use of its data.
  static constexpr std::uint64_t kLine = 1 + 100, kLoad = 4 + 60;

  struct RaySent {
    std::uint64_t cycle = 0;
    std::uint32_t tile = 0, ray = 0;  ///< slot of the tile in flight, and number of the ray in the tile
  };

  SrpHarness(const Setup& setup, const std::vector<Kernel>& kernels);

  /// Adds a tile to dispatch. `missing`: bit mask of its imported borders that are not yet available at its dispatch.
  SrpHarness& add(traces::TileWork work, std::uint32_t missing = 0);
  /// Makes an update of missing borders arrive in cycle `cycle`. `missing`: borders that tile number `tile` still
  /// misses.
  SrpHarness& tell(std::uint64_t cycle, std::size_t tile, std::uint32_t missing);
  template <sim::Skip kSkip = sim::Skip::kOn>
  SrpHarness& run() {
    end_ = clock_.edge_after(sim::run<kSkip>(*this), 1);
    machine_.finish(end_);
    return *this;
  }

  // Called by the engine.
  sim::Machine& machine() { return machine_; }
  bool done() const { return tiles_done_.size() == works_.size(); }

  const Srp& srp() const { return *srp_; }
  /// Returns the cycles for which kernel `k` occupied the shader core's array, including switches and stalls.
  std::uint64_t cycles(std::size_t k) const { return srp_->kernel_use()[k].cycles; }
  std::uint64_t spent(Srp::CycleReason why) const { return clock_.cycles(srp_->activity().spent(why)); }
  std::uint64_t elapsed() const { return clock_.cycles(end_); }
  const std::vector<RaySent>& rays() const { return rays_; }
  const std::vector<DmaJob>& transfers() const { return transfers_; }
  const std::vector<std::uint32_t>& tiles_done() const { return tiles_done_; }
  /// Returns the borders that tiles have written, earliest first.
  const std::vector<traces::Border>& borders() const { return borders_; }
  /// Returns the cycle in which the i-th tile to end left the shader core, counted from the arrival of the first tile.
  std::uint64_t done_at(std::size_t i) const { return done_at_[i] - 2; }

 private:
  /// Units around the shader core: dispatcher, T&I unit, memory and DMA.
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
  std::vector<std::uint32_t> missing_;  ///< mask of missing borders of each tile at its dispatch
  std::vector<News> news_;
  std::vector<RaySent> rays_;
  std::vector<DmaJob> transfers_;
  std::vector<std::uint32_t> tiles_done_;
  std::vector<traces::Border> borders_;
  std::vector<std::uint64_t> done_at_;
  sim::Time end_ = 0;
};

/// Builds the work graph of a tile node by node. Functions return the number of the new node.
class TileBuilder {
 public:
  using Node = std::uint32_t;
  using Edge = traces::Edge;

  explicit TileBuilder(std::uint32_t tile = 0) { work_.tile = tile; }
  Node launch(traces::KernelId kernel, std::uint32_t items, std::vector<Edge> inputs = {});
  /// Adds a kernel launch whose items read memory. `accesses[i]`: reads of item i.
  Node launch(traces::KernelId kernel, const std::vector<std::vector<traces::Access>>& accesses,
              std::vector<Edge> inputs = {});
  /// Adds `items` idle items to a launch.
  void idle(Node launch, std::uint32_t items) { work_.nodes[launch].idle = items; }
  /// Adds rays: one for each item of `launch`, or one for each item in `sources`.
  Node rays(Node launch, std::uint32_t count, std::vector<std::uint32_t> sources = {});
  Node transfer(traces::Region region, bool to_memory, std::uint32_t bytes, std::vector<Edge> inputs = {},
                std::uint64_t offset = 0);
  Node picture(std::uint32_t bytes, Node after) {
    return transfer(traces::Region::kPicture, true, bytes, {all(after)});
  }
  /// Adds a DMA transfer that reads a border of another tile.
  Node import_border(traces::Border border, std::uint32_t bytes);
  /// Adds a DMA transfer that writes border `number` of this tile.
  Node export_border(std::uint32_t number, std::uint32_t bytes, std::vector<Edge> inputs);
  traces::TileWork build();

  static Edge all(Node node) { return {node, Edge::Kind::kAll}; }
  static Edge each(Node node) { return {node, Edge::Kind::kEach}; }
  /// Maps the items of a node with a kEach edge: item i depends on item `sources[i]` of the node before the edge.
  TileBuilder& map(Node node, const std::vector<std::uint32_t>& sources);

 private:
  Node add(traces::WorkNode::Kind kind, std::uint32_t items, std::vector<Edge> inputs);

  traces::TileWork work_;
};

/// Cycles of a switch to a kernel of initiation interval 1 that must be loaded.
inline constexpr std::uint64_t kSwitch = SrpHarness::cold(1);

/// Numbers of two kernels of an SrpHarness.
inline constexpr traces::KernelId kA = 0, kB = 1;

/// Returns a tile in which kernel A makes rays and kernel B shades each hit. `reads_first`: A first reads from memory.
traces::TileWork trace_and_shade(std::uint32_t items, std::uint32_t tile = 0, bool reads_first = false);

/// Expects that two runs spend equal cycles for each cycle reason, and that these sum to their time.
void expect_equal_cycles(const SrpHarness& fast, const SrpHarness& oracle);

}  // namespace hw::test
