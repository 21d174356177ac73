#include "hw_models/dram/dram_channel.h"
#include "hw_models/memory/l2_bank.h"
#include "hw_models/srp/srp.h"
#include "hw_models/tni/ist.h"
#include "hw_models/tni/trv.h"
#include "tools/analysis/units.h"
#include "tools/studies/compare/compare.h"

namespace tools {
namespace {

/// A quotient of counters of all units of a kind.
struct Ratio {
  const char* name;
  std::string part;
  std::string whole;
  std::string more{};  ///< the whole is this and `whole`
  bool rest = false;   ///< what is left of one
};

std::vector<Ratio> ratios_of_counters() {
  using Trv = hw::Trv::Stats;
  using Ist = hw::Ist::Stats;
  using Srp = hw::Srp::Stats;
  using L2 = hw::L2Bank::Stats;
  using Dram = hw::DramChannel::Stats;
  const auto trv = [](auto counter) { return counter_path<hw::Trv>(counter); };
  const auto ist = [](auto counter) { return counter_path<hw::Ist>(counter); };
  const auto srp = [](auto counter) { return counter_path<hw::Srp>(counter); };
  const auto l2 = [](auto counter) { return counter_path<hw::L2Bank>(counter); };
  const auto dram = [](auto counter) { return counter_path<hw::DramChannel>(counter); };
  return {{"node L1 hit rate", trv(&Trv::l1_hits), trv(&Trv::l1_accesses)},
          {"node L1 cycles a miss", trv(&Trv::l1_miss_cycles), trv(&Trv::l1_fills)},
          {"triangle L1 hit rate", ist(&Ist::l1_hits), ist(&Ist::l1_accesses)},
          {"triangle L1 cycles a miss", ist(&Ist::l1_miss_cycles), ist(&Ist::l1_fills)},
          {"data cache hit rate", srp(&Srp::cache_hits), srp(&Srp::cache_accesses)},
          {"data cache cycles a miss", srp(&Srp::cache_miss_cycles), srp(&Srp::cache_fills)},
          {"L2 hit rate", l2(&L2::hits), l2(&L2::reads)},
          {"L2 cycles a read", l2(&L2::latency), l2(&L2::reads)},
          {"DRAM row hit rate", dram(&Dram::row_hits), dram(&Dram::reads), dram(&Dram::writes)},
          {"DRAM clocks a read", dram(&Dram::read_latency), dram(&Dram::reads)},
          {"IST early exit rate", ist(&Ist::edge_tests), ist(&Ist::tests), {}, true},
          {"node visits a ray", trv(&Trv::visits), trv(&Trv::rays_in)}};
}

}  // namespace

std::vector<Pair> ratios(const ReportFile& a, const ReportFile& b) {
  std::vector<Pair> out;
  for (const Ratio& ratio : ratios_of_counters()) {
    const auto of = [&](const ReportFile& report) {
      double whole = report.number(ratio.whole);
      if (!ratio.more.empty()) whole += report.number(ratio.more);
      const double share = whole == 0 ? 0 : report.number(ratio.part) / whole;
      return ratio.rest && whole != 0 ? 1 - share : share;
    };
    const Pair pair{ratio.name, of(a), of(b)};
    if (pair.a != pair.b) out.push_back(pair);
  }
  return out;
}

}  // namespace tools
