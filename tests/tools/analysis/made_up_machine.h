#pragma once
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "hw_models/dram/dram_channel.h"
#include "hw_models/frame/dma.h"
#include "hw_models/memory/core_port.h"
#include "hw_models/memory/l2_bank.h"
#include "hw_models/srp/srp.h"
#include "hw_models/tni/ist.h"
#include "hw_models/tni/trv.h"
#include "sim/unit_report.h"

namespace test {

/// Unit reports of a machine of one core, over 100 cycles at 1 GHz, with values given by a test.
struct SyntheticMachine {
  using Reasons = std::map<std::string, std::uint64_t>;
  using Counters = std::map<std::string, std::uint64_t>;
  Reasons trv = {{"starved", 100}};
  Reasons ist = {{"starved", 100}};
  Reasons srp = {{"starved", 100}};
  Reasons l2 = {{"idle", 100}};
  Reasons dram = {{"idle", 100}};
  Reasons dma = {{"idle", 100}};
  Counters of_trv{}, of_srp{}, of_l2{}, of_dram{}, of_dma{}, of_port{}, of_dma_port{};

  std::vector<sim::UnitReport> units() const {
    return {unit<hw::Trv>("core0.tni.trv0", trv, of_trv),
            unit<hw::Ist>("core0.tni.ist", ist, {}),
            unit<hw::Srp>("core0.srp", srp, of_srp),
            unit<hw::L2Bank>("l2.bank0", l2, of_l2),
            unit<hw::DramChannel>("dram.channel0", dram, of_dram),
            unit<hw::Dma>("core0.dma", dma, of_dma),
            unit<hw::CorePort>("core0.cache_port", {{"idle", 100}}, of_port),
            unit<hw::CorePort>("core0.dma_port", {{"idle", 100}}, of_dma_port)};
  }

 private:
  /// Returns the report of one unit. Cycle reasons and counters that are not given are 0.
  template <class Unit>
  static sim::UnitReport unit(std::string path, Reasons why, Counters counters) {
    sim::UnitReport report;
    report.path = std::move(path);
    report.elapsed = 100;
    report.clock_mhz = 1000;
    report.type = typeid(Unit);
    report.reasons = Unit::kReasons;
    for (const sim::Reason& reason : report.reasons)
      report.cycles_by_reason.emplace_back(reason.name, why[std::string(reason.name)]);
    const typename Unit::Stats stats{};
    Unit::Stats::describe(stats, [&](std::uint64_t, const char* name, auto&&...) {
      report.counters.push_back({name, "", counters[name], ""});
    });
    return report;
  }
};

}  // namespace test
