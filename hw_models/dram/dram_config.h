#pragma once
#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <string>
#include <string_view>

#include "hw_models/memory/messages.h"
#include "sim/config/field.h"
#include "sim/named.h"

namespace hw {

/// Order of the row, bank, column and channel bits in a DRAM address, from the highest bits to the lowest. Consecutive
/// lines differ in the last field.
enum class DramMapping : std::uint8_t {
  kRowBankColumnChannel,  ///< consecutive lines fill a row in every channel, then move to the next bank
  kRowColumnBankChannel,  ///< consecutive lines cycle through the channels, then through the banks, alternating between
                          ///< bank groups
  kRowBankChannelColumn,  ///< consecutive lines fill a row of one channel, then move to the next channel
};
constexpr std::array<std::string_view, 3> names_of(DramMapping) {
  return {"row_bank_column_channel", "row_column_bank_channel", "row_bank_channel_column"};
}

/// Order in which a memory controller refreshes the banks of a rank.
enum class RefreshOrder : std::uint8_t {
  kRoundRobin,  ///< bank after bank, the only order of LPDDR3; accesses that cycle through the banks in step may often
                ///< meet the bank in refresh
  kIdleFirst,   ///< among the banks not yet refreshed in this round, those without queued requests first
};
constexpr std::array<std::string_view, 2> names_of(RefreshOrder) { return {"round_robin", "idle_first"}; }

/// Power state of the DRAM devices between frames.
enum class DramIdle : std::uint8_t {
  kPowerDown,    ///< power-down without refreshes: the lowest power; data are lost
  kSelfRefresh,  ///< self refresh of the part of the array whose data are kept
};
constexpr std::array<std::string_view, 2> names_of(DramIdle) { return {"power_down", "self_refresh"}; }

/// How many banks one DRAM refresh command occupies.
enum class RefreshKind : std::uint8_t {
  kPerBank,  ///< one bank, or a pair of banks that are refreshed together; the other banks stay usable
  kAllBank,  ///< all banks of a rank; such refreshes are less frequent
};
constexpr std::array<std::string_view, 2> names_of(RefreshKind) { return {"per_bank", "all_bank"}; }

/// Page policy: whether a DRAM row stays open when no queued request needs it.
enum class PagePolicy : std::uint8_t {
  kOpen,      ///< the row stays open until a request needs another row of the bank
  kClosed,    ///< the last queued hit of a row closes it (auto-precharge)
  kAdaptive,  ///< a predictor, trained by the bank's earlier requests, decides whether the row stays open
};
constexpr std::array<std::string_view, 3> names_of(PagePolicy) { return {"open", "closed", "adaptive"}; }

/// Scheduling policy of a memory controller: which of the queued reads, or of the queued writes, is served next.
enum class DramSchedulingPolicy : std::uint8_t {
  kFrFcfs,  ///< first ready, first come, first served: the oldest request among those whose bank is ready
  kFcfs,    ///< first come, first served: always the oldest request, even if others could start earlier
};
constexpr std::array<std::string_view, 2> names_of(DramSchedulingPolicy) { return {"fr_fcfs", "fcfs"}; }

/// Organisation of a DRAM channel: ranks, bank groups, banks, rows.
struct DramOrganisation {
  std::uint32_t ranks = 1;
  std::uint32_t banks = 8;
  std::uint32_t bank_groups = 1;
  std::uint32_t refresh_banks = 1;
  std::uint32_t rows = 65536;
  std::uint32_t width = 16;
  sim::ByteSize page{2048};
  sim::ByteSize burst{32};
  bool bl32 = false;

  static void describe(auto& c, auto&& field) {
    using sim::Affects;
    field(NAMED(c.ranks), "ranks", "devices that share the channel's buses; rank bits are above the bank bits",
          sim::power_of_two(1, 2), Affects::kTiming);
    field(NAMED(c.banks), "banks", "banks of a rank, all groups together", sim::power_of_two(1, 32), Affects::kTiming);
    field(NAMED(c.bank_groups), "groups", "bank groups", sim::power_of_two(1, 8), Affects::kTiming);
    field(NAMED(c.refresh_banks), "banks", "banks that one per-bank refresh command refreshes together",
          sim::power_of_two(1, 2), Affects::kTiming);
    field(NAMED(c.rows), "rows", "rows of a bank", sim::power_of_two(1, 1 << 20), Affects::kTiming);
    field(NAMED(c.width), "lines",
          "data lines of the channel, for the area of the pads; bandwidth follows from burst and timing",
          sim::between(8, 64), Affects::kEnergy);
    field(NAMED(c.page), "bytes", "data of one row", sim::power_of_two(64, 1 << 16), Affects::kTiming);
    field(NAMED(c.burst), "bytes", "data of one read or write command", sim::power_of_two(8, 256), Affects::kTiming);
    field(NAMED(c.bl32), "", "a command moves two bursts, tCCD_L apart (BL32 of LPDDR5)", sim::any(), Affects::kTiming);
  }
  std::uint32_t all_banks() const { return ranks * banks; }
};

/// DRAM timing parameters in cycles of the command clock (nCK), and the period of that clock.
struct DramTiming {
  sim::Duration ck{625'000};
  std::uint32_t rl = 28, wl = 14, burst = 8, dqsck = 3;
  std::uint32_t rcd = 29, rp = 29, rp_ab = 34, ras = 68, rc = 97, rrd = 16, faw = 64;
  std::uint32_t ccd_s = 8, ccd_l = 8, rtp = 12, wr = 29, wtr_s = 16, wtr_l = 16, dqss = 1, rtw = 1;
  std::uint32_t rtrs = 1, xp = 12;
  std::uint32_t rfc_pb = 224, refi_pb = 780, rfc_ab = 448, refi_ab = 6246;
  std::uint32_t pbr2act = 16;
  bool pbr_in_faw = true;
  std::uint32_t ca_activate = 4, ca_column = 4, ca_precharge = 2;
  std::uint32_t aad = 0, wck_sync = 0, wck_post = 0;

  static void describe(auto& c, auto&& field) {
    using sim::Affects;
    const auto cycles = [&](auto& value, const char* name, const char* meaning, double min, double max) {
      field(value, name, "nCK", meaning, sim::between(min, max), Affects::kTiming);
    };
    field(NAMED(c.ck), "ns", "period of the command clock", sim::between(100'000, 100'000'000), Affects::kTiming);
    cycles(NAMED(c.rl), "read command to first data", 1, 128);
    cycles(NAMED(c.wl), "write command to first data", 1, 128);
    cycles(NAMED(c.burst), "data bus time of one burst", 1, 32);
    cycles(NAMED(c.dqsck), "further delay of read data", 0, 16);
    cycles(NAMED(c.rcd), "activate to read or write", 1, 256);
    cycles(NAMED(c.rp), "precharge (one bank) to activate", 1, 256);
    cycles(NAMED(c.rp_ab), "precharge of all banks to refresh or power-down", 1, 256);
    cycles(NAMED(c.ras), "activate to precharge", 1, 512);
    cycles(NAMED(c.rc), "activate to activate, same bank", 1, 1024);
    cycles(NAMED(c.rrd), "activate to activate, other bank", 1, 256);
    cycles(NAMED(c.faw), "window that holds at most four activates", 1, 512);
    cycles(NAMED(c.ccd_s), "column to column command, other bank group (any bank if there are no groups)", 1, 32);
    cycles(NAMED(c.ccd_l), "column to column command, same bank group", 1, 32);
    cycles(NAMED(c.rtp), "read to precharge", 1, 256);
    cycles(NAMED(c.wr), "end of write data to precharge", 1, 256);
    cycles(NAMED(c.wtr_s), "end of write data to read, other bank group", 0, 256);
    cycles(NAMED(c.wtr_l), "end of write data to read, same bank group", 0, 256);
    cycles(NAMED(c.dqss), "further delay of write data", 0, 16);
    cycles(NAMED(c.rtw), "idle data bus between read and write data", 0, 64);
    cycles(NAMED(c.rtrs), "idle data bus between bursts of two ranks", 0, 64);
    cycles(NAMED(c.xp), "end of power-down to the first command", 1, 256);
    cycles(NAMED(c.rfc_pb), "duration of a per-bank refresh", 1, 4096);
    cycles(NAMED(c.refi_pb), "interval between per-bank refreshes of a rank; 0: no refresh", 0, 100'000);
    cycles(NAMED(c.rfc_ab), "duration of a refresh of all banks", 1, 8192);
    cycles(NAMED(c.refi_ab), "interval between refreshes of all banks of a rank; 0: no refresh", 0, 1'000'000);
    cycles(NAMED(c.pbr2act), "per-bank refresh to activate, other bank", 0, 256);
    field(NAMED(c.pbr_in_faw), "", "a per-bank refresh counts as an activate in the tFAW window", sim::any(),
          Affects::kTiming);
    cycles(NAMED(c.ca_activate), "command bus time of an activate", 1, 8);
    cycles(NAMED(c.ca_column), "command bus time of a read or write", 1, 8);
    cycles(NAMED(c.ca_precharge), "command bus time of a precharge", 1, 8);
    cycles(NAMED(c.aad), "longest time from ACT-1 to ACT-2, each half of ca_activate; 0: ACT-2 follows at once", 0, 16);
    cycles(NAMED(c.wck_sync),
           "duration of the CAS that starts the data clock (WCK) before a read or write; 0: WCK always runs", 0, 8);
    cycles(NAMED(c.wck_post), "end of data to the end of the data clock", 0, 64);
  }
};

/// Configuration of the memory controller of a DRAM channel.
struct DramController {
  DramMapping mapping = DramMapping::kRowBankColumnChannel;
  bool bank_xor = true;
  DramSchedulingPolicy scheduler = DramSchedulingPolicy::kFrFcfs;
  PagePolicy page_policy = PagePolicy::kOpen;
  RefreshKind refresh = RefreshKind::kPerBank;
  RefreshOrder refresh_order = RefreshOrder::kIdleFirst;
  bool power_down = false;
  std::uint32_t power_down_after = 160;
  std::uint32_t read_queue = 32;
  std::uint32_t write_queue = 32;
  std::uint32_t write_high = 24;
  std::uint32_t write_low = 8;
  std::uint32_t age_limit = 1600;

  static void describe(auto& c, auto&& field) {
    using sim::Affects;
    field(NAMED(c.mapping), "", "order of the address bits", sim::any(), Affects::kTiming);
    field(NAMED(c.bank_xor), "", "bank bits are XORed with low row bits, against conflicts of strided addresses",
          sim::any(), Affects::kTiming);
    field(NAMED(c.scheduler), "", "scheduling policy: first ready first come, or strictly the oldest request",
          sim::any(), Affects::kTiming);
    field(NAMED(c.page_policy), "", "whether a row stays open when no queued request needs it", sim::any(),
          Affects::kTiming);
    field(NAMED(c.refresh), "", "refreshes of single banks, or of all banks at once", sim::any(), Affects::kTiming);
    field(NAMED(c.refresh_order), "", "which bank is refreshed next, with refresh: per_bank", sim::any(),
          Affects::kTiming);
    field(NAMED(c.power_down), "", "an idle channel closes its rows and powers its devices down", sim::any(),
          Affects::kTiming);
    field(NAMED(c.power_down_after), "nCK", "idle time before power-down", sim::between(1, 1'000'000),
          Affects::kTiming);
    field(NAMED(c.read_queue), "requests", "reads waiting in a channel", sim::between(1, 64), Affects::kTiming);
    field(NAMED(c.write_queue), "requests", "writes waiting in a channel", sim::between(1, 64), Affects::kTiming);
    field(NAMED(c.write_high), "requests", "waiting writes at which the channel starts to serve writes before reads",
          sim::between(1, 64), Affects::kTiming);
    field(NAMED(c.write_low), "requests", "waiting writes at which it serves reads first again", sim::between(0, 63),
          Affects::kTiming);
    field(NAMED(c.age_limit), "nCK", "age from which a queue's oldest request is no longer overtaken in its bank",
          sim::between(1, 1'000'000), Affects::kTiming);
  }
  void check(auto&& complain) const {
    if (write_low >= write_high) complain("write_low", "must be less than write_high");
    if (write_high > write_queue) complain("write_high", "must not be more than write_queue holds");
  }
};

/// Energy parameters of a DRAM channel: its device, its I/O and the controller's PHY.
struct DramEnergy {
  sim::Band activate{308.4, 616.9, 1234};
  sim::Band read_core{422.7, 551.3, 918.8}, read_io{256, 412.2, 563.2};
  sim::Band write_core{260.5, 302.9, 605.8}, write_io{256, 419.8, 614.4};
  sim::Band phy{307.2, 512, 768};
  sim::Band refresh{2743, 3162, 3810}, refresh_all{21943, 25295, 30476};
  sim::Band active_standby{12.24, 18.62, 31.47}, precharge_standby{7.847, 11.68, 20.49};
  sim::Band power_down_standby{1.536, 2.285, 4.01}, self_refresh_array{1.405, 1.62, 1.952};

  static void describe(auto& c, auto&& field) {
    const auto energy = [&](auto& value, const char* name, const char* unit, const char* meaning) {
      field(value, name, unit, meaning, sim::at_least(0), sim::Affects::kEnergy);
    };
    energy(NAMED(c.activate), "pJ", "an activate and its precharge");
    energy(NAMED(c.read_core), "pJ", "a read burst inside the device, above standby");
    energy(NAMED(c.read_io), "pJ", "a read burst on the pins");
    energy(NAMED(c.write_core), "pJ", "a write burst inside the device, above standby");
    energy(NAMED(c.write_io), "pJ", "a write burst on the pins, driver and receiver");
    energy(NAMED(c.phy), "pJ", "controller and PHY on the GPU's die, per burst");
    energy(NAMED(c.refresh), "pJ", "a refresh bank by bank, above standby");
    energy(NAMED(c.refresh_all), "pJ", "a refresh of all banks, above standby");
    energy(NAMED(c.active_standby), "mW", "power of a rank with an open row, clock included");
    energy(NAMED(c.precharge_standby), "mW", "power of a rank with all rows closed, clock included");
    energy(NAMED(c.power_down_standby), "mW", "power of a rank in power-down");
    energy(NAMED(c.self_refresh_array), "mW",
           "power of refreshing a rank's whole array in self refresh, above power-down");
  }
};

/// Configuration of the GPU's DRAM: a number of equal LPDDR channels.
struct DramConfig {
  std::string grade = "LPDDR4-3200";
  std::uint32_t channels = 4;
  sim::ByteSize line{kLineBytes};
  sim::Duration fabric{50'000'000};
  DramIdle idle = DramIdle::kPowerDown;
  double refreshed_part = 1;
  DramOrganisation organisation;
  DramTiming timing;
  DramController controller;
  DramEnergy energy;

  static void describe(auto& c, auto&& field) {
    using sim::Affects;
    field(NAMED(c.grade), "", "name of the speed grade, for reports; `extends` selects another grade's values",
          sim::any(), Affects::kReport);
    field(NAMED(c.channels), "channels", "independent channels, interleaved by line", sim::power_of_two(1, 16),
          Affects::kTiming);
    field(NAMED(c.line), "bytes", "data of one request", sim::power_of_two(16, 256), Affects::kTiming);
    field(NAMED(c.fabric), "ns", "fixed latency of a read between the GPU and the controller", sim::between(0, 1e9),
          Affects::kTiming);
    field(NAMED(c.idle), "", "state of the devices between frames (raywatt dvfs, sustain)", sim::any(),
          Affects::kEnergy);
    field(NAMED(c.refreshed_part), "", "part of the array that self refresh keeps (partial-array self refresh)",
          sim::between(0, 1), Affects::kEnergy);
    field.group(NAMED(c.organisation), "one channel");
    field.group(NAMED(c.timing), "speed grade, in cycles of the command clock");
    field.group(NAMED(c.controller), "order of requests");
    field.group(NAMED(c.energy), "energy of a channel: device, pins and PHY");
  }
  void check(auto&& complain) const {
    if (line.bytes % organisation.burst.bytes != 0 || line.bytes > organisation.page.bytes)
      complain("line", "must be whole bursts (" + std::to_string(organisation.burst.bytes) + " bytes) of one row (" +
                           std::to_string(organisation.page.bytes) + " bytes)");
    else if ((bursts_per_line() - 1) * timing.ccd_l + 32 + timing.wck_sync > 64)
      complain("line", "has too many bursts: their commands must fit 64 nCK");
    const auto at_most = [](const char* key, std::uint32_t limit) {
      return "must not be more than " + std::string(key) + " (" + std::to_string(limit) + ")";
    };
    if (organisation.bank_groups > organisation.banks)
      complain("organisation.bank_groups", at_most("banks", organisation.banks));
    if (organisation.refresh_banks > organisation.banks)
      complain("organisation.refresh_banks", at_most("banks", organisation.banks));
    if (organisation.all_banks() > 32)
      complain("organisation.banks",
               "are " + std::to_string(organisation.all_banks()) + "; allowed: at most 32, all ranks together");
    if (organisation.bl32 && bursts_per_line() % 2 != 0)
      complain("organisation.bl32", "goes with an even number of bursts, not " + std::to_string(bursts_per_line()));
    if (timing.aad != 0 && (timing.ca_activate % 2 != 0 || timing.aad < timing.ca_activate / 2)) {
      complain("timing.aad", "must not be less than half of ca_activate (" + std::to_string(timing.ca_activate) +
                                 "), which must be even");
    }
    if (timing.wl > timing.rl) complain("timing.wl", at_most("rl", timing.rl));
    if (timing.burst > timing.ccd_s || timing.ccd_s > timing.ccd_l)
      complain("timing.ccd_s", "allowed: burst <= ccd_s <= ccd_l");
    const std::uint32_t distance =
        timing.ccd_l * (organisation.bl32 ? 2 : 1);  // cycles from one column command of a line to the next
    if (commands_per_line() > 1 && timing.ca_column > distance)
      complain("timing.ca_column", at_most("the distance of a line's commands", distance));
    check_refresh(complain);
  }

  std::uint32_t bursts_per_line() const { return static_cast<std::uint32_t>(line.bytes / organisation.burst.bytes); }
  std::uint32_t commands_per_line() const { return bursts_per_line() / (organisation.bl32 ? 2 : 1); }
  /// Returns the time between two refreshes of a rank, in cycles of the command clock; 0 if refresh is off.
  std::uint32_t refresh_interval() const {
    return controller.refresh == RefreshKind::kAllBank ? timing.refi_ab : timing.refi_pb;
  }
  /// Returns the time between two refreshes of the same bank, in cycles of the command clock; 0 if refresh is off.
  std::uint64_t bank_refresh_interval() const {
    if (controller.refresh == RefreshKind::kAllBank) return timing.refi_ab;
    return std::uint64_t{timing.refi_pb} * (organisation.banks / organisation.refresh_banks);
  }
  /// Returns the mapping from line addresses to DRAM channels.
  Interleave channel_interleave() const {
    const bool by_page = controller.mapping == DramMapping::kRowBankChannelColumn;
    return {by_page ? organisation.page.bytes : line.bytes, channels};
  }

 private:
  /// Rejects a refresh rate so high that a bank cannot open a row and serve a request between two refreshes.
  void check_refresh(auto&& complain) const {
    const bool all = controller.refresh == RefreshKind::kAllBank;
    const std::uint64_t busy =
        (all ? timing.rfc_ab : timing.rfc_pb) + std::uint64_t{timing.xp} + timing.rp_ab + std::uint64_t{2} * timing.rc;
    if (bank_refresh_interval() == 0 || busy < bank_refresh_interval()) return;
    complain("timing", std::string("leaves a bank no time between its refreshes: ") + (all ? "rfc_ab" : "rfc_pb") +
                           " + xp + rp_ab + 2 rc is " + std::to_string(busy) + ", must be less than " +
                           (all ? "refi_ab" : "refi_pb x banks / refresh_banks") + ", " +
                           std::to_string(bank_refresh_interval()));
  }
};

/// Bank and row of a line within its DRAM channel. The column does not affect timing.
struct DramAddress {
  std::uint32_t bank = 0;  ///< bank number within the channel; all banks of rank 0 precede those of rank 1
  std::uint32_t row = 0;
};

/// Maps a line's address to a bank and row in its DRAM channel. DramConfig::channel_interleave() selects the channel.
class DramMap {
 public:
  explicit DramMap(const DramConfig& c)
      : bank_first_(c.controller.mapping == DramMapping::kRowColumnBankChannel),
        skip_(log2_of(c.line.bytes) + log2_of(c.channels)),
        column_bits_(log2_of(c.organisation.page.bytes) - log2_of(c.line.bytes)),
        bank_bits_(log2_of(c.organisation.all_banks())),
        xor_mask_(c.controller.bank_xor ? c.organisation.banks - 1 : 0),
        row_mask_(c.organisation.rows - 1) {}

  DramAddress address_of(Addr line) const {
    // In every mapping, bank and row bits are above channel and column bits. So one shift removes the channel and
    // column bits.
    const Addr in_channel = line >> skip_;
    const std::uint32_t bank_mask = (1U << bank_bits_) - 1;
    DramAddress a;
    a.bank = static_cast<std::uint32_t>(in_channel >> (bank_first_ ? 0 : column_bits_)) & bank_mask;
    a.row = static_cast<std::uint32_t>(in_channel >> (column_bits_ + bank_bits_)) & row_mask_;
    a.bank ^= a.row & xor_mask_;
    return a;
  }

 private:
  static constexpr std::uint32_t log2_of(std::uint64_t power_of_two) {
    return static_cast<std::uint32_t>(std::countr_zero(power_of_two));
  }

  bool bank_first_;
  std::uint32_t skip_;
  std::uint32_t column_bits_;
  std::uint32_t bank_bits_;  ///< number of bank bits of an address; the highest ones select the rank
  std::uint32_t xor_mask_;
  std::uint32_t row_mask_;
};

/// Small change of a DRAM channel's timing, with which a run is repeated under slightly different conditions
/// (docs/noise.md). The default is no change.
struct DramPerturbation {
  std::int32_t fabric = 0;    ///< command clock cycles added to the fabric latency of reads, which cannot fall below 0
  std::uint32_t refresh = 0;  ///< command clock cycles by which all refreshes are earlier, modulo the refresh interval

  std::uint64_t perturbed_fabric_cycles(std::uint64_t fabric_cycles) const {
    return static_cast<std::uint64_t>(std::max(std::int64_t{0}, static_cast<std::int64_t>(fabric_cycles) + fabric));
  }
  std::uint64_t first_refresh_cycle(std::uint64_t refresh_interval) const {
    return refresh_interval - refresh % refresh_interval;
  }
};

}  // namespace hw
