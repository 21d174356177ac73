#include "hw_models/dram/dram_timing_table.h"

#include <algorithm>

namespace hw {
namespace {

using enum DramScope;
using enum DramOp;
using Reason = DramCycleReason;

std::vector<DramConstraint> constraints(const DramConfig& c) {
  const DramTiming& t = c.timing;
  // First to last column command of a line; first column command to the end of its last data.
  const std::int64_t train = std::int64_t{c.bursts_per_line() - 1} * t.ccd_l;
  const std::int64_t read_latency = std::int64_t{t.rl} + t.dqsck, write_latency = std::int64_t{t.wl} + t.dqss;
  const std::int64_t read_end = train + read_latency + t.burst, write_end = train + write_latency + t.burst;
  const Reason other_rank_write = t.rtrs > t.rtw ? Reason::kRankSwitch : Reason::kTurnaround;
  return {
      // scope, from, to, cycles, reason (of a rank), count
      {kBank, kActivate, kRead, t.rcd},
      {kBank, kActivate, kWrite, t.rcd},
      {kBank, kActivate, kPrecharge, t.ras},
      {kBank, kActivate, kActivate, t.rc},
      {kRank, kActivate, kActivate, t.rrd, Reason::kActivate},
      {kRank, kActivate, kActivate, t.faw, Reason::kActivate, 4},

      {kBank, kPrecharge, kActivate, t.rp},

      {kBank, kRead, kPrecharge, train + t.rtp},
      {kBankGroup, kRead, kRead, train + t.ccd_l},
      {kBankGroup, kRead, kWrite, train + t.ccd_l},
      {kRank, kRead, kWrite, read_end + t.rtw - t.wl, Reason::kTurnaround},
      {kOtherRanks, kRead, kRead, train + t.burst + t.rtrs, Reason::kRankSwitch},
      {kOtherRanks, kRead, kWrite, read_end + std::max(t.rtw, t.rtrs) - t.wl, other_rank_write},

      {kBank, kWrite, kPrecharge, write_end + t.wr},
      {kBankGroup, kWrite, kRead, train + write_latency + t.ccd_l + t.wtr_l},
      {kBankGroup, kWrite, kWrite, train + t.ccd_l},
      {kRank, kWrite, kRead, write_end + t.wtr_s, Reason::kTurnaround},
      {kOtherRanks, kWrite, kRead, write_end + t.rtrs - read_latency, Reason::kRankSwitch},
      {kOtherRanks, kWrite, kWrite, train + t.burst + t.rtrs, Reason::kRankSwitch},

      {kBank, kRefresh, kActivate, t.rfc_pb},
      {kBank, kRefreshRank, kActivate, t.rfc_ab},
  };
}

}  // namespace

DramTimingTable::DramTimingTable(const DramConfig& config) {
  for (const DramConstraint& constraint : constraints(config)) {
    if (constraint.scope == kOtherRanks && config.organisation.ranks == 1) continue;
    rows_[static_cast<std::size_t>(constraint.from)][static_cast<std::size_t>(constraint.scope)].push_back(constraint);
  }
}

}  // namespace hw
