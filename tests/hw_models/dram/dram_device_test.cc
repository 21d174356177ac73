#include "hw_models/dram/dram_device.h"

#include <bit>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "hw_models/dram/dram_config.h"
#include "tests/hw_models/dram/dram_harness.h"

namespace hw {
namespace {

using test::earliest_start;
using test::kT;
using Cycle = DramDevice::Cycle;
using enum DramCommand;

DramConfig with_groups() {
  DramConfig c;
  c.organisation.bank_groups = 4;
  c.timing.ccd_s = c.timing.burst = 2;
  c.timing.ccd_l = 4;
  c.timing.wtr_s = 5;
  c.timing.wtr_l = 10;
  c.timing.ca_activate = c.timing.ca_column = c.timing.ca_precharge = 1;
  return c;
}

TEST(DramDevice, AWriteAfterAReadWaitsForTheReadsDataToLeaveTheBus) {
  DramDevice d{DramConfig{}};
  d.activate_row(0, 0, 0);
  d.read_line(0, 100);
  EXPECT_EQ(earliest_start(d, kColumn, 0, true, 101), 100 + kT.ccd_l + kT.rl + kT.dqsck + kT.burst + kT.rtw - kT.wl);
}

TEST(DramDevice, AReadAfterAWriteWaitsForTheWritesDataAndWtr) {
  DramDevice d{DramConfig{}};
  d.activate_row(0, 0, 0);
  d.write_line(0, 100);
  EXPECT_EQ(earliest_start(d, kColumn, 0, false, 101), 100 + kT.ccd_l + kT.wl + kT.dqss + kT.burst + kT.wtr_s);
}

TEST(DramDevice, AWriteToAnotherRankWaitsForTheRankSwitchOfTheBus) {
  DramConfig c;
  c.organisation.ranks = 2;
  const std::uint32_t other = c.organisation.banks;
  DramDevice d{c};
  d.activate_row(0, 0, 0);
  d.activate_row(other, 0, 40);
  d.write_line(0, 100);
  EXPECT_EQ(earliest_start(d, kColumn, other, true, 101, 1), 100 + kT.ccd_l + kT.burst + kT.rtrs);
  EXPECT_EQ(earliest_start(d, kColumn, 0, true, 101), 100 + 2 * kT.ccd_l) << "the same rank's follows at once";
}

TEST(DramDevice, APrechargeWaitsForRowReadAndWriteTimes) {
  DramDevice d{DramConfig{}};
  d.activate_row(0, 0, 0);
  EXPECT_EQ(earliest_start(d, kPrecharge, 0, false, 10), kT.ras);
  d.read_line(0, 100);
  EXPECT_EQ(earliest_start(d, kPrecharge, 0, false, 101), 100 + kT.ccd_l + kT.rtp);
  d.write_line(0, 200);
  EXPECT_EQ(earliest_start(d, kPrecharge, 0, false, 201), 200 + kT.ccd_l + kT.wl + kT.dqss + kT.burst + kT.wr);
}

TEST(DramDevice, AnActivateWaitsForPrechargeRowCycleAndItsNeighbours) {
  DramDevice d{DramConfig{}};
  d.activate_row(0, 0, 0);
  EXPECT_EQ(earliest_start(d, kActivate, 1, false, 5), kT.rrd);
  d.precharge_bank(0, kT.ras);
  EXPECT_EQ(earliest_start(d, kActivate, 0, false, kT.ras), std::max(kT.rc, kT.ras + kT.rp));
  d.activate_row(0, 1, 200);
  d.precharge_bank(0, 400);
  EXPECT_EQ(earliest_start(d, kActivate, 0, false, 401), 400 + kT.rp);
}

TEST(DramDevice, TheFifthActivateWaitsForTheFirstToLeaveTheWindow) {
  DramConfig c;
  c.timing.faw = 90;
  DramDevice d{c};
  for (std::uint32_t i = 0; i < 4; ++i) d.activate_row(i, 0, Cycle{i} * kT.rrd);
  EXPECT_EQ(earliest_start(d, kActivate, 4, false, 50), 90U);
  d.activate_row(4, 0, 90);
  EXPECT_EQ(earliest_start(d, kActivate, 5, false, 91), 90 + kT.rrd);
}

TEST(DramDevice, AnActivateFitsBetweenTheTwoReadCommandsOfALine) {
  DramDevice d{DramConfig{}};
  d.activate_row(0, 0, 0);
  d.read_line(0, 100);  // command bus: 100 to 103 and 108 to 111
  EXPECT_EQ(earliest_start(d, kActivate, 1, false, 100), 104U);
  EXPECT_EQ(earliest_start(d, kActivate, 1, false, 105), 112U);
  EXPECT_EQ(earliest_start(d, kPrecharge, 1, false, 105), 105U) << "half as long, fits before 108";
  EXPECT_EQ(earliest_start(d, kPrecharge, 1, false, 107), 112U);
}

TEST(DramDevice, AnotherBankGroupsBurstsFillTheGapsOfALine) {
  DramDevice d{with_groups()};
  for (std::uint32_t bank = 0; bank < 3; ++bank) d.activate_row(bank, 0, Cycle{bank} * 16);
  d.read_line(0, 100);  // bursts at 100 and 104
  EXPECT_EQ(earliest_start(d, kColumn, 1, false, 101), 102U);
  EXPECT_EQ(earliest_start(d, kColumn, 0, false, 101), 108U) << "the same group";
  d.read_line(1, 102);  // bursts at 102 and 106
  EXPECT_EQ(earliest_start(d, kColumn, 2, false, 103), 108U) << "no gap left";
}

TEST(DramDevice, AfterAWriteTheSameBankGroupWaitsLonger) {
  const DramConfig c = with_groups();
  DramDevice d{c};
  d.activate_row(0, 0, 0);
  d.activate_row(1, 0, 16);
  d.write_line(0, 100);
  const Cycle data = 100 + c.timing.ccd_l + c.timing.wl + c.timing.dqss;
  EXPECT_EQ(earliest_start(d, kColumn, 1, false, 101), data + c.timing.burst + c.timing.wtr_s);
  EXPECT_EQ(earliest_start(d, kColumn, 0, false, 101), data + c.timing.ccd_l + c.timing.wtr_l);
}

TEST(CommandCalendar, ALineOccupiesTheDataBusFromItsFirstBurstToItsLast) {
  CommandCalendar calendar(kT, 2, 2);
  EXPECT_TRUE(calendar.is_data_bus_free(100));
  calendar.book_command(kColumn, 100);
  EXPECT_FALSE(calendar.is_data_bus_free(100));
  EXPECT_FALSE(calendar.is_data_bus_free(100 + 2 * kT.ccd_l - 1));
  EXPECT_TRUE(calendar.is_data_bus_free(100 + 2 * kT.ccd_l));
}

TEST(DramDevice, ARefreshClosesTheBankAndKeepsItBusy) {
  DramDevice d{DramConfig{}};
  d.activate_row(0, 0, 0);
  d.refresh_banks(1U << 0, 20);
  EXPECT_FALSE(d.is_open(0));
  EXPECT_EQ(earliest_start(d, kActivate, 0, false, 21), std::max(kT.rc, kT.ras + kT.rp) + kT.rfc_pb);
  d.refresh_banks(1U << 1, 500);
  EXPECT_EQ(earliest_start(d, kActivate, 1, false, 501), 500 + kT.rfc_pb);
}

TEST(DramDevice, StandbyIsActiveFromTheFirstActivateToTheLastPrecharge) {
  DramDevice d{DramConfig{}};
  d.activate_row(0, 0, 100);
  d.activate_row(1, 0, 150);
  d.precharge_bank(0, 300);
  EXPECT_EQ(d.cycles_with_open_row(350), 250U);
  d.precharge_bank(1, 400);
  EXPECT_EQ(d.cycles_with_open_row(1000), 300U);
  d.activate_row(0, 0, 2000);
  d.refresh_banks(1U << 0, 2010);  // closes at 2000 + tRAS
  EXPECT_EQ(d.cycles_with_open_row(2020), 320U);
  EXPECT_EQ(d.cycles_with_open_row(3000), 300U + kT.ras);
}

TEST(DramConfig, ALineHasAsManyBurstsAsTheirCommandsFit64Cycles) {
  const auto complaints = [](std::uint32_t ccd_l) {
    DramConfig c;
    c.timing.ccd_l = ccd_l;
    c.timing.wck_sync = 0;
    int count = 0;
    c.check([&](const char* /*key*/, const std::string& what) {
      count += what.find("too many bursts") != std::string::npos;
    });
    return count;
  };
  EXPECT_EQ(complaints(32), 0) << "two bursts: 32 + 32";
  EXPECT_EQ(complaints(33), 1);
}

TEST(DramMap, EveryLineOfAChannelHasItsOwnPlace) {
  for (const DramMapping mapping :
       {DramMapping::kRowBankColumnChannel, DramMapping::kRowColumnBankChannel, DramMapping::kRowBankChannelColumn}) {
    for (const bool bank_xor : {false, true}) {
      DramConfig c;
      c.controller.mapping = mapping;
      c.controller.bank_xor = bank_xor;
      c.organisation.rows = 64;
      const DramMap map(c);
      std::set<std::tuple<std::uint32_t, std::uint32_t, std::uint32_t>> rows;
      std::vector<std::uint32_t> lines(c.channels);
      const Addr size = c.organisation.page.bytes * c.organisation.banks * c.organisation.rows * c.channels;
      for (Addr line = 0; line < size; line += 64) {
        const DramAddress p = map.address_of(line);
        const std::uint32_t channel = c.channel_interleave().index_of(line);
        lines[channel] += 1;
        rows.emplace(channel, p.bank, p.row);
        ASSERT_LT(p.bank, c.organisation.banks);
      }
      EXPECT_EQ(rows.size(), 4U * 8 * 64);
      EXPECT_EQ(std::set<std::uint32_t>(lines.begin(), lines.end()).size(), 1U) << "channels share alike";
    }
  }
}

TEST(DramMap, AStreamFollowsTheMapping) {
  DramConfig c;
  c.controller.bank_xor = false;
  DramMap map(c);
  const Addr stripe = 4 * 2048;  // a row of every channel
  EXPECT_EQ(map.address_of(stripe - 64).bank, 0U);
  EXPECT_EQ(map.address_of(stripe).bank, 1U);
  EXPECT_EQ(map.address_of(8 * stripe).row, 1U);
  c.controller.mapping = DramMapping::kRowColumnBankChannel;
  map = DramMap(c);
  EXPECT_EQ(map.address_of(0).bank, 0U);
  EXPECT_EQ(map.address_of(256).bank, 1U);
}

}  // namespace
}  // namespace hw
