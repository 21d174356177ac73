#include <optional>

#include "hw_models/dram/dram_config.h"
#include "sim/report/table.h"
#include "tools/studies/microbench/benchmark.h"
#include "tools/studies/microbench/memory_forms.h"
#include "tools/studies/microbench/memory_side.h"

namespace tools {
namespace {

constexpr std::uint32_t kPhases = 20;  // starts, a cycle further each time, so that clocks meet in every way

/// The first line behind line 0 of its channel and bank, of the same row or not.
std::optional<hw::Addr> find_line(const hw::DramConfig& dram, bool same_row) {
  const hw::DramMap map(dram);
  const hw::DramAddress first = map.address(0);
  const hw::Addr end =
      4 * dram.channels * dram.organisation.page.bytes * dram.organisation.all_banks() * dram.organisation.all_banks();
  for (hw::Addr line = dram.line.bytes; line < end; line += dram.line.bytes) {
    const hw::DramAddress address = map.address(line);
    if (dram.interleave().owner(line) == 0 && address.bank == first.bank && (address.row == first.row) == same_row)
      return line;
  }
  return std::nullopt;
}

/// Reads far enough apart that each finds the memory at rest.
class Chase {
 public:
  explicit Chase(const hw::GpuConfig& config)
      : config_(config),
        forms_(config),
        clock_(config.clocks.tni.clock()),
        pause_(8192 * (config.dram.timing.ck.time + config.clocks.l2.clock().period() + clock_.period())) {
    config_.cores = 1;
    config_.dram.timing.refi_pb = config_.dram.timing.refi_ab = 0;
    config_.dram.controller.power_down = false;
    config_.dram.controller.page_policy = hw::PagePolicy::kOpen;
  }

  Findings measure() const {
    Findings found{"a read, as a traversal unit sees it", {}};
    const auto add = [&](const char* name, auto&& make) {
      Figure f{name, "ns"};
      for (std::uint32_t phase = 0; phase < kPhases; ++phase) make(f, 1 + phase);
      found.figures.push_back(f);
    };
    const auto row_open = find_line(config_.dram, true), other_row = find_line(config_.dram, false);
    add("L1 hit", [&](Figure& f, std::uint32_t phase) { play(f, phase, {0, 0}, false, std::nullopt); });
    add("L2 hit", [&](Figure& f, std::uint32_t phase) { play(f, phase, {0}, true, Level::kL2); });
    if (row_open) {
      add("DRAM, row open", [&](Figure& f, std::uint32_t phase) {
        play(f, phase, {0, *row_open}, false, Level::kRowOpen);
      });
    }
    add("DRAM, bank closed", [&](Figure& f, std::uint32_t phase) { play(f, phase, {0}, false, Level::kBankClosed); });
    if (other_row) {
      add("DRAM, other row open", [&](Figure& f, std::uint32_t phase) {
        play(f, phase, {0, *other_row}, false, Level::kOtherRow);
      });
    }
    return found;
  }

 private:
  /// Reads the lines one after the other, maybe the last one by a neighbour before, and adds what the last read takes
  /// from the probe of the L1 to its data. No level: the L1.
  void play(Figure& figure, std::uint32_t phase, const std::vector<hw::Addr>& lines, bool neighbour_first,
            std::optional<Level> level) const {
    MemorySide side(config_);
    Reader& reader = side.reader(0, 0);
    sim::Time at = phase * clock_.period();
    if (neighbour_first) side.reader(0, config_.tni.trvs).read(lines.back(), at);
    for (const hw::Addr line : lines) reader.read(line, at += pause_);
    side.run();
    const Reader::Read& last = reader.reads().back();
    const sim::Time hit = config_.tni.trv.l1.hit_cycles * clock_.period();
    const sim::Time expected = (level ? forms_.back(last.asked, *level) - last.asked : 0) + hit;
    figure.measured += static_cast<double>(last.there - last.asked + hit) / sim::kFemtosecondsPerNs / kPhases;
    figure.expected += static_cast<double>(expected) / sim::kFemtosecondsPerNs / kPhases;
  }

  hw::GpuConfig config_;
  const MemoryForms forms_;
  const sim::Clock clock_;
  const sim::Time pause_;
};

}  // namespace

Benchmark chase_benchmark() {
  return {"chase",
          "Latency of a lone read that hits L1, L2 or DRAM, as a traversal unit sees it",
          "A figure is the mean over starts that meet the clocks in different ways. Rows stay open, and there\n"
          "are no refreshes and no power-down.\n"
          "\n"
          "Example: raywatt microbench chase --set clocks.l2='800 MHz' --set interconnect.latency=8",
          {json_option()},
          [](const BenchmarkJob& job) { return Chase(*real_machine(job.machine).gpu).measure(); }};
}

}  // namespace tools
