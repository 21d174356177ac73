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

/// Closed formulas for the latencies and bandwidths of a DRAM channel, in cycles of the command clock. A line is a
/// sequence of bursts in one bank. A latency ends with the last data of the line.
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

  // Latency of a single read when its row is open, its bank is closed, another row is open, or the device is in
  // power-down.
  double row_hit_latency() const { return t_.wck_sync + t_.rl + t_.dqsck + column_span() + t_.burst; }
  double closed_bank_latency() const { return t_.rcd + row_hit_latency(); }
  double row_conflict_latency() const { return t_.rp + closed_bank_latency(); }
  double latency_after_power_down() const { return t_.xp + closed_bank_latency(); }

  // Time from the last data of one row hit to the last data of the next row hit.
  double write_after_read() const { return column_span() + t_.burst + t_.rtw + t_.dqss; }
  double read_after_write() const {
    return std::max(t_.burst + t_.wtr_s, t_.ccd_l + t_.wtr_l) + cas_cycles_after_write() + t_.rl + t_.dqsck +
           column_span();
  }
  double read_after_write_of_other_group() const {
    return t_.burst + t_.wtr_s + cas_cycles_after_write() + t_.rl + t_.dqsck + column_span();
  }
  double read_after_read_of_other_rank() const { return column_span() + t_.burst + t_.rtrs + t_.wck_sync; }

  /// Returns the cycles per line of a stream that is limited only by the data bus. Bursts of other bank groups fill the
  /// gaps between bursts of one group.
  double cycles_per_streamed_line() const { return bursts_ * std::max(t_.burst, groups_ > 1 ? t_.ccd_s : t_.ccd_l); }
  /// Returns the cycles per line of a stream of requests that reads `lines_per_row` lines from each row, bank after
  /// bank. The result is the largest of the limits set by activates, banks, command bus and data bus.
  double cycles_per_line_of_row_stream(std::uint32_t lines_per_row) const {
    const double activate = std::max<double>(t_.rrd, t_.faw / 4.0) / ranks_;  // each rank has its own tFAW window
    const std::uint32_t hits = (lines_per_row - 1) * bursts_ * t_.ccd_l + column_span();
    const double row = std::max(t_.rc, std::max(t_.ras, t_.rcd + hits + t_.rtp) + t_.rp);
    const double commands = t_.ca_activate + lines_per_row * commands_ * t_.ca_column + t_.ca_precharge;
    return std::max({activate, row / banks_, commands, lines_per_row * cycles_per_streamed_line()}) / lines_per_row;
  }
  /// Returns the cycles per line of a stream of row hits in one bank, including refreshes, which close the row.
  double cycles_per_line_with_refreshes() const {
    const double line = bursts_ * t_.ccd_l;
    const double lost = column_span() + t_.rtp + refresh_ + t_.rcd + t_.wck_sync - line;
    return line * bank_refresh_interval_ / (bank_refresh_interval_ - lost);
  }

 private:
  /// Returns the cycles of the CAS before a read that follows a write as early as tWTR allows; 0 if the data clock WCK
  /// still runs then.
  std::uint32_t cas_cycles_after_write() const { return t_.wtr_s >= t_.wck_post ? t_.wck_sync : 0; }
  /// Returns the number of cycles from the first to the last column command of a line.
  std::uint32_t column_span() const { return (bursts_ - 1) * t_.ccd_l; }

  const DramTiming t_;
  const std::uint32_t bursts_, commands_, ranks_, banks_, groups_;
  const double bank_refresh_interval_;
  const double refresh_;
};

/// A request to a DRAM channel for the line that contains `address`. Addresses count from the start of the channel.
struct DramRequest {
  Addr address = 0;
  bool write = false;
  sim::Time earliest = 0;  ///< earliest time at which the request may reach the channel
};

/// Result of running a list of requests on a DRAM channel. Time 0 is the earliest time at which a request can reach the
/// channel.
struct DramRun {
  std::vector<sim::Time> arrived;  ///< time at which each request arrived at the DRAM channel
  std::vector<sim::Time> done;     ///< time at which the data transfer of each request ended
  sim::Time end = 0;               ///< time at which the last data transfer ended
  DramChannel::Stats stats;
  std::vector<std::pair<std::string, std::uint64_t>> why;  ///< cycles for each DramCycleReason; the sum is `end`

  sim::Time request_latency(std::size_t request) const { return done[request] - arrived[request]; }
};

/// Sends the requests to a single DRAM channel in the given order, with at most `max_outstanding` in flight. The
/// configured fabric latency is ignored.
DramRun run_dram_requests(DramConfig config, std::span<const DramRequest> requests, std::uint32_t max_outstanding);

/// A measured value of a DRAM channel and its prediction by a closed formula.
struct DramMeasurement {
  /// How closely a measured value and its prediction by a closed formula must agree.
  enum class Agreement : std::uint8_t {
    kExactly,
    kClosely,  ///< the measured value is within 2 % of the prediction
    kNearly,   ///< the measured value is 0.9 to 1.0 times the prediction
    kAtMost,   ///< the measured value is at most 1.02 times the prediction, which ignores bus conflicts and bank waits
  };
  std::string name;
  std::string unit;  ///< unit of both values: "ns", "GB/s", "pJ/bit" or "mW"
  double measured = 0;
  double expected = 0;
  Agreement agreement = Agreement::kExactly;

  bool is_within_tolerance() const;
};

/// Measures latencies and bandwidths of a DRAM speed grade, then the energies of dram_energy_measurements(). Refresh
/// and power-down are off and rows stay open, except in the measurements of these features. Each measurement has its
/// own address mapping.
std::vector<DramMeasurement> dram_measurements(const DramConfig& grade);

/// Measures the nominal energy of a DRAM channel as configured, with all ranks and refreshes. Reports pJ/bit of
/// sequential and of random reads, and the power of an idle channel, also per bit of peak bandwidth.
std::vector<DramMeasurement> dram_energy_measurements(const DramConfig& grade);

}  // namespace hw
