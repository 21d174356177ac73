#include "tests/hw_models/machines/conservation.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

namespace hw::test {

namespace {

constexpr std::uint64_t kLine = 64;
constexpr std::uint64_t kMostLinesOfAVisit = 4;  ///< two records of single boxes, each across two lines; a wide node

void expect_rays_conserved(const Outcome& run, const std::string& core) {
  const std::uint64_t rays = run.sum(core, "srp", "rays");
  EXPECT_EQ(run.sum(core, "srp", "hits"), rays);
  EXPECT_EQ(run.sum(core, "tni.dispatcher", "rays_in"), rays);
  EXPECT_EQ(run.sum(core, "tni.dispatcher", "hits_out"), rays);
  EXPECT_EQ(run.sum(core, "trv", "rays_in"), rays);
  EXPECT_EQ(run.sum(core, "trv", "rays_out"), rays);
  // A shadow ray that hits does not empty its stack.
  const std::uint64_t removed = run.sum(core, "trv", "pops") - run.sum(core, "trv", "entry_updates");
  EXPECT_GE(run.sum(core, "trv", "pushes"), removed + run.sum(core, "trv", "dropped"));
  EXPECT_EQ(run.sum(core, "trv", "leaves"), run.sum(core, "ist", "leaves_in"));
  EXPECT_EQ(run.sum(core, "ist", "leaves_in"), run.sum(core, "ist", "leaves_out"));
  EXPECT_EQ(run.sum(core, "tile_buffer", "slots_taken"), rays);
}

/// Checks traffic of rays and hits, which all go through memory without the direct interface.
void expect_records_conserved(const Outcome& run, const std::string& core, const DirectInterfaceConfig& config) {
  const std::uint64_t rays = run.sum(core, "srp", "rays");
  EXPECT_EQ(run.sum(core, "memory_interface", "rays"), rays);
  EXPECT_EQ(run.sum(core, "memory_interface", "hits"), rays);
  EXPECT_GE(run.sum(core, "memory_interface", "ray_writes") * kLine, rays * config.ray_bytes);
  EXPECT_GE(run.sum(core, "memory_interface", "hit_writes") * kLine, rays * config.hit_bytes);
}

void expect_lines_conserved(const Outcome& run, const std::string& core, const GpuConfig& config) {
  const bool direct = config.direct_interface.enabled;
  const auto records = [&](const char* what) { return direct ? 0 : run.sum(core, "memory_interface", what); };
  const std::uint64_t record_reads = records("ray_reads") + records("hit_reads");
  const std::uint64_t record_writes = records("ray_writes") + records("hit_writes");
  for (const char* unit : {"trv", "ist"}) {
    EXPECT_EQ(run.sum(core, unit, "l1_hits") + run.sum(core, unit, "l1_misses"), run.sum(core, unit, "l1_accesses"));
    EXPECT_EQ(run.sum(core, unit, "rau_writes"), run.sum(core, unit, "rau_reads"));
  }
  const std::uint64_t visits = run.sum(core, "trv", "visits"), first_passes = run.sum(core, "trv", "first_passes");
  const bool wide = run.sum(core, "trv", "node_lines") != 0;
  EXPECT_EQ(first_passes, config.tni.trv.box_testers == 1 && !wide ? visits : 0);
  const std::uint64_t gathered = config.tni.trv.gather == Gather::kOff ? 0 : run.sum(core, "trv", "gathered");
  const std::uint64_t lines_read = run.sum(core, "trv", "l1_hits") + run.sum(core, "trv", "rau_reads") + gathered;
  const std::uint64_t transforms = run.sum(core, "trv", "transforms");
  EXPECT_GE(lines_read, visits + first_passes + transforms);
  const std::uint64_t links = run.sum(core, "trv", "parent_links");
  EXPECT_LE(lines_read, kMostLinesOfAVisit * (visits + first_passes) + transforms + links);
  EXPECT_EQ(run.sum(core, "srp", "cache_hits") + run.sum(core, "srp", "cache_misses"),
            run.sum(core, "srp", "cache_accesses"));
  const std::uint64_t fills =
      run.sum(core, "trv", "l1_fills") + run.sum(core, "ist", "l1_fills") + run.sum(core, "srp", "cache_fills");
  // The tree builder uses the port of core 0.
  const bool has_builder = core == "core0." && run.has_unit("tree_builder");
  const std::uint64_t built_reads = has_builder ? run.sum("tree_builder", "buffer_fills") : 0;
  const std::uint64_t built_writes = has_builder ? run.sum("tree_builder", "writes") : 0;
  EXPECT_EQ(run.sum(core, "cache_port", "requests"), fills + record_reads + record_writes + built_reads + built_writes);
  EXPECT_EQ(run.sum(core, "cache_port", "lines_down"), fills + record_reads + built_reads);
  EXPECT_EQ(run.sum(core, "cache_port", "lines_up"), record_writes + built_writes);
  EXPECT_EQ(run.sum(core, "dma_port", "lines_up"), run.sum(core, "dma", "lines_written"));
  EXPECT_EQ(run.sum(core, "dma_port", "lines_down"), run.sum(core, "dma", "lines_read"));
  EXPECT_EQ(run.sum(core, "dma_port", "requests"),
            run.sum(core, "dma", "lines_written") + run.sum(core, "dma", "lines_read"));
}

void expect_memory_conserved(const Outcome& run, const GpuConfig& config) {
  EXPECT_EQ(run.sum("bank", "reads"), run.sum("cache_port", "lines_down"));
  EXPECT_EQ(run.sum("bank", "writes"), run.sum("cache_port", "lines_up"));
  EXPECT_EQ(run.sum("bank", "hits") + run.sum("bank", "misses"), run.sum("bank", "reads"));
  EXPECT_EQ(run.sum("bank", "stored") + run.sum("bank", "not_stored"), run.sum("bank", "writes"));
  EXPECT_LE(run.sum("bank", "memory_cycles"), run.sum("bank", "latency"));
  if (!config.ideal.l2) {
    EXPECT_EQ(run.sum("bank", "bytes_overwritten") + run.sum("bank", "bytes_to_memory"),
              run.sum("bank", "bytes_written"));
  }
  EXPECT_EQ(run.sum("bank", "fills") + run.sum("bank", "merges"), run.sum("bank", "misses"));
  const std::uint64_t reads = run.sum("channel", "reads"), writes = run.sum("channel", "writes");
  EXPECT_EQ(reads, run.sum("bank", "fills") + run.sum("dma", "lines_read"));
  EXPECT_EQ(writes, run.sum("dma", "lines_written") + run.sum("bank", "passed_on") + run.sum("bank", "written_back"));
  EXPECT_EQ(run.sum("channel", "bytes"), kLine * (reads + writes));
  EXPECT_EQ(run.sum("channel", "row_hits") + run.sum("channel", "row_misses") + run.sum("channel", "row_conflicts"),
            reads + writes);
  for (const sim::UnitReport& unit : run.units) {
    if (!unit.path.starts_with("dram.")) continue;
    for (const sim::CounterReport& c : unit.counters) {
      const bool standby = c.name == "active_standby" || c.name == "precharge_standby" || c.name == "power_down";
      if (!standby) continue;
      EXPECT_LE(c.value, config.dram.organisation.ranks * unit.elapsed) << unit.path << ": " << c.name;
    }
  }
}

/// Checks traffic of spilled ray slots. Each is written and read in whole lines twice: for ray and hit.
void expect_tiles_conserved(const Outcome& run, const Frame& frame, const GpuConfig& config) {
  EXPECT_EQ(run.sum("tile_dispatcher", "dispatched"), frame.program().tiles());
  EXPECT_EQ(run.sum("tile_dispatcher", "finished"), frame.program().tiles());
  EXPECT_EQ(run.sum("srp", "tiles"), frame.program().tiles());
  const std::uint64_t spilled = run.sum("dma", "spill_lines_read");
  const std::uint64_t bytes = 2 * run.sum("tile_buffer", "spilled_slots") * config.tile_buffer.slot_bytes;
  EXPECT_EQ(run.sum("dma", "spill_lines_written"), spilled);
  EXPECT_EQ(run.sum("dma", "picture_lines_written"), frame.picture_lines());
  EXPECT_EQ(run.sum("dma", "lines_written"), frame.picture_lines() + spilled);
  EXPECT_EQ(run.sum("dma", "lines_read"), spilled);
  EXPECT_GE(spilled * kLine, bytes);
  EXPECT_LE(spilled, bytes == 0 ? 0 : bytes / kLine + run.sum("srp", "chunks"));
}

/// Checks that each triangle or instance of a tree is read, sorted, merged and written once per pass.
void expect_trees_conserved(const Outcome& run, const TreeBuilderConfig& config) {
  const auto count = [&](const char* counter) { return run.sum("tree_builder", counter); };
  const std::uint64_t items = count("triangles") + count("instances"), sorted = count("records_sorted");
  EXPECT_EQ(count("leaves_written"), items);
  EXPECT_EQ(count("boxes"), items + sorted) << "the sort pass and the last pass";
  EXPECT_EQ(count("record_bytes_written"), count("record_bytes_read"));
  EXPECT_EQ(count("record_bytes_read"), count("records_merged") * config.record_bytes);
  EXPECT_EQ(count("merge_words"), count("head_words") * config.merge_levels());
  EXPECT_EQ(count("caches_invalidated"), count("trees_built") + count("trees_refitted"));
}

sim::Clock clock_of(const sim::UnitReport& unit, const GpuConfig& config) {
  const auto part_of = [&](const char* part) { return unit.path.find(part) != std::string::npos; };
  if (unit.block == "dram") return sim::Clock(config.dram.timing.ck.time);
  if (part_of(".tni.") || unit.path == "tree_builder") return config.clocks.tni.clock();
  const bool srp = part_of(".srp") || part_of(".tile_buffer") || (part_of(".dma") && !part_of(".dma_port"));
  return srp ? config.clocks.srp.clock() : config.clocks.l2.clock();
}

void expect_time_accounted(const Outcome& run, const GpuConfig& config) {
  for (const sim::UnitReport& unit : run.units) {
    const sim::Clock clock = clock_of(unit, config);
    EXPECT_EQ(unit.elapsed, clock.cycles(clock.edge_at_or_after(run.elapsed))) << unit.path;
    std::uint64_t sum = 0;
    for (const auto& [reason, cycles] : unit.cycles_by_reason) {
      EXPECT_LE(cycles, unit.elapsed) << unit.path << " " << reason;
      sum += cycles;
    }
    EXPECT_EQ(sum, unit.elapsed) << unit.path;
  }
}

}  // namespace

void expect_machine_conserved(const Outcome& run, const GpuConfig& config) {
  for (std::uint32_t c = 0; c < config.cores; ++c) {
    const std::string core = fmt::format("core{}.", c);
    SCOPED_TRACE(core);
    expect_rays_conserved(run, core);
    expect_lines_conserved(run, core, config);
    if (!config.direct_interface.enabled) expect_records_conserved(run, core, config.direct_interface);
  }
  expect_memory_conserved(run, config);
  if (run.has_unit("tree_builder")) expect_trees_conserved(run, config.tree_builder);
  expect_time_accounted(run, config);

  std::uint64_t launches = 0, items = 0;
  for (const KernelUse& kernel : run.kernels) {
    launches += kernel.launches;
    items += kernel.items;
    EXPECT_LE(kernel.starved, kernel.cycles);
  }
  EXPECT_EQ(launches, run.sum("srp", "chunks"));
  EXPECT_GE(run.sum("srp", "launches"), launches + run.sum("srp", "merged")) << "a merged loop has two at least";
  if (!config.srp.merge) {
    EXPECT_EQ(run.sum("srp", "launches"), launches);
  }
  EXPECT_EQ(items, run.sum("srp", "items"));
}

void expect_conserved(const Outcome& run, const Frame& frame, const GpuConfig& config) {
  expect_machine_conserved(run, config);
  EXPECT_EQ(run.sum("srp", "rays"), run.rays());
  const std::uint64_t extra = run.sum("trv", "extra_visits") + run.sum("trv", "extra_tests");
  EXPECT_EQ(run.sum("trv", "visits") - run.sum("trv", "restarted_visits") + run.sum("ist", "tests") - extra,
            run.function.traversal_steps);
  const traces::Layout& layout = frame.workload().image.layout;
  const std::uint64_t gathered = config.tni.trv.gather == Gather::kOff ? 0 : run.sum("trv", "gathered");
  if (layout.single_boxes.empty() && kLine % layout.node_bytes == 0) {
    EXPECT_EQ(run.sum("trv", "visits") + run.sum("trv", "first_passes") + run.sum("trv", "transforms") +
                  run.sum("trv", "parent_links"),
              run.sum("trv", "l1_hits") + run.sum("trv", "rau_reads") + gathered);
  }
  expect_tiles_conserved(run, frame, config);
}

}  // namespace hw::test
