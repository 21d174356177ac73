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
      // scope, from, to, cycles, reason
      {kBank, kActivate, kRead, t.rcd, Reason::kActivate},
      {kBank, kActivate, kWrite, t.rcd, Reason::kActivate},
      {kBank, kActivate, kPrecharge, t.ras, Reason::kRowConflict},
      {kBank, kActivate, kActivate, t.rc, Reason::kRowConflict},
      {kRank, kActivate, kActivate, t.rrd, Reason::kActivate},
      {kRank, kActivate, kActivate, t.faw, Reason::kActivate, 4},

      {kBank, kPrecharge, kActivate, t.rp, Reason::kRowConflict},

      {kBank, kRead, kPrecharge, train + t.rtp, Reason::kRowConflict},
      {kBankGroup, kRead, kRead, train + t.ccd_l, Reason::kColumn},
      {kBankGroup, kRead, kWrite, train + t.ccd_l, Reason::kColumn},
      {kRank, kRead, kWrite, read_end + t.rtw - t.wl, Reason::kTurnaround},
      {kOtherRanks, kRead, kRead, train + t.burst + t.rtrs, Reason::kRankSwitch},
      {kOtherRanks, kRead, kWrite, read_end + std::max(t.rtw, t.rtrs) - t.wl, other_rank_write},

      {kBank, kWrite, kPrecharge, write_end + t.wr, Reason::kRowConflict},
      {kBankGroup, kWrite, kRead, train + write_latency + t.ccd_l + t.wtr_l, Reason::kTurnaround},
      {kBankGroup, kWrite, kWrite, train + t.ccd_l, Reason::kColumn},
      {kRank, kWrite, kRead, write_end + t.wtr_s, Reason::kTurnaround},
      {kOtherRanks, kWrite, kRead, write_end + t.rtrs - read_latency, Reason::kRankSwitch},
      {kOtherRanks, kWrite, kWrite, train + t.burst + t.rtrs, Reason::kRankSwitch},

      {kBank, kRefresh, kActivate, t.rfc_pb, Reason::kRefresh},
      {kBank, kRefreshRank, kActivate, t.rfc_ab, Reason::kRefresh},
  };
}

}  // namespace

DramTimingTable::DramTimingTable(const DramConfig& config) {
  for (const DramConstraint& constraint : constraints(config)) {
    after_[static_cast<std::size_t>(constraint.from)].push_back(constraint);
  }
}

}  // namespace hw
