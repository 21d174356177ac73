#pragma once
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "sim/report/unit_report.h"

namespace test {

/// Reports of a machine of one core whose units say what they are told to, each over 100 cycles of 1 GHz.
struct MadeUpMachine {
  using CycleReason = std::vector<std::pair<std::string, std::uint64_t>>;
  using Counters = std::vector<std::pair<std::string, std::uint64_t>>;
  CycleReason trv = {{"starved", 100}};
  CycleReason ist = {{"starved", 100}};
  CycleReason srp = {{"starved", 100}};
  CycleReason dram = {{"idle", 100}};
  Counters of_trv{}, of_srp{}, of_l2{};

  std::vector<sim::UnitReport> units() const {
    return {unit("core0.tni.trv0", trv, of_trv), unit("core0.tni.ist", ist, {}), unit("core0.srp", srp, of_srp),
            unit("l2.bank0", {{"idle", 100}}, of_l2), unit("dram.channel0", dram, {})};
  }

 private:
  static sim::UnitReport unit(std::string path, const CycleReason& why, const Counters& counters) {
    sim::UnitReport report;
    report.path = std::move(path);
    report.elapsed = 100;
    report.why = why;
    report.clock_mhz = 1000;
    for (const auto& [name, value] : counters) report.counters.push_back({name, "", value, ""});
    return report;
  }
};

}  // namespace test
