#pragma once
#include <algorithm>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "hw_models/dram/dram_channel.h"
#include "hw_models/dram/dram_config.h"

namespace hw {

/// Times that the rules of a grade imply for a channel, in cycles of the command clock. A line is a train of bursts of
/// one bank; times end with the last of its data.
class DramClosedForms {
 public:
  explicit DramClosedForms(const DramConfig& c)
      : t_(c.timing),
        bursts_(c.bursts_per_line()),
        commands_(c.commands_per_line()),
        ranks_(c.organisation.ranks),
        banks_(c.organisation.all_banks()),
        groups_(c.organisation.bank_groups),
        bank_refresh_interval_(static_cast<double>(c.bank_refresh_interval())),
        refresh_((c.controller.refresh == RefreshKind::kAllBank ? t_.rp_ab + t_.rfc_ab : t_.rp + t_.rfc_pb)) {}

  // A lone read, by the state of its bank.
  double row_hit() const { return t_.wck_sync + t_.rl + t_.dqsck + train() + t_.burst; }
  double closed_bank() const { return t_.rcd + row_hit(); }
  double row_conflict() const { return t_.rp + closed_bank(); }
  double after_power_down() const { return t_.xp + closed_bank(); }

  // Two row hits one after the other: last data to last data.
  double write_after_read() const { return train() + t_.burst + t_.rtw + t_.dqss; }
  double read_after_write() const {
    return std::max(t_.burst + t_.wtr_s, t_.ccd_l + t_.wtr_l) + cas_after_write() + t_.rl + t_.dqsck + train();
  }
  double read_after_write_of_other_group() const {
    return t_.burst + t_.wtr_s + cas_after_write() + t_.rl + t_.dqsck + train();
  }
  double read_after_read_of_other_rank() const { return train() + t_.burst + t_.rtrs + t_.wck_sync; }

  // Line after line, for ever.
  /// Bursts fill the bus, those of one bank group by leaving gaps that another group fills.
  double streamed_line() const { return bursts_ * std::max(t_.burst, groups_ > 1 ? t_.ccd_s : t_.ccd_l); }
  /// `lines` of a row, then as many of the next bank: the tightest of activates, buses and banks.
  double line_of_own_row(std::uint32_t lines) const {
    const double activate = std::max<double>(t_.rrd, t_.faw / 4.0) / ranks_;  // each rank has windows of its own
    const std::uint32_t hits = (lines - 1) * bursts_ * t_.ccd_l + train();
    const double row = std::max(t_.rc, std::max(t_.ras, t_.rcd + hits + t_.rtp) + t_.rp);
    const double commands = t_.ca_activate + lines * commands_ * t_.ca_column + t_.ca_precharge;
    return std::max({activate, row / banks_, commands, lines * streamed_line()}) / lines;
  }
  /// Time per line of a stream of row hits in one bank, with the refreshes that close its row.
  double line_between_refreshes() const {
    const double line = bursts_ * t_.ccd_l;
    const double lost = train() + t_.rtp + refresh_ + t_.rcd + t_.wck_sync - line;
    return line * bank_refresh_interval_ / (bank_refresh_interval_ - lost);
  }

 private:
  /// Cycles of the CAS before a read that waited for tWTR; 0 if WCK is still running then.
  std::uint32_t cas_after_write() const { return t_.wtr_s >= t_.wck_post ? t_.wck_sync : 0; }
  std::uint32_t train() const { return (bursts_ - 1) * t_.ccd_l; }  ///< first to last column command of a line

  const DramTiming t_;
  const std::uint32_t bursts_, commands_, ranks_, banks_, groups_;
  const double bank_refresh_interval_;
  const double refresh_;
};

/// A request of a stream: for the line that holds `address`, in the channel's own address space.
struct DramRequest {
  Addr address = 0;
  bool write = false;
  sim::Time earliest = 0;  ///< the channel does not see it before
};

/// Outcome of a stream of requests. Times count from the moment at which a request without `earliest` reaches the
/// channel.
struct DramPlay {
  std::vector<sim::Time> arrived;  ///< by request: when the channel saw it
  std::vector<sim::Time> done;     ///< by request: when the last of its data had passed the bus
  sim::Time end = 0;               ///< when the last data had passed the bus
  DramChannel::Stats stats;
  std::vector<std::pair<std::string, std::uint64_t>> why;  ///< cycles by DramCycleReason, `end` in all

  sim::Time latency(std::size_t request) const { return done[request] - arrived[request]; }
};

/// Plays the requests through one channel alone, in their order, with at most `outstanding` of them arrived and not
/// done. The channel's addresses begin at 0 and hold nothing of other channels; `fabric` is left out.
DramPlay play(DramConfig config, std::span<const DramRequest> requests, std::uint32_t outstanding);

/// A figure of a channel, measured on requests made for it, beside its closed form.
struct DramMeasurement {
  /// How the two compare.
  enum class Holds : std::uint8_t {
    kExactly,
    kClosely,  ///< within 2 %
    kNearly,   ///< between nine tenths of the form and all of it
    kAtMost,   ///< the form is a bound that leaves out command slots and waiting banks (2 % for ends)
  };
  std::string name;
  std::string unit;  ///< "ns", "GB/s", "pJ/bit" or "mW"
  double measured = 0;
  double expected = 0;
  Holds holds = Holds::kExactly;

  bool good() const;
};

/// Returns the times and bandwidths of a speed grade: its organisation and timing, under a controller that leaves rows
/// open, neither refreshes nor powers down and maps addresses as each figure needs it; then dram_energy_measurements().
std::vector<DramMeasurement> dram_measurements(const DramConfig& grade);

/// Returns the nominal energy of a channel as configured, all its ranks and refreshes included: per bit of a stream and
/// of random reads, and idle, as power and per bit that the idle bus could have moved.
std::vector<DramMeasurement> dram_energy_measurements(const DramConfig& grade);

}  // namespace hw
