#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <string>

#include <gtest/gtest.h>

#include "hw_models/dram/dram_device.h"
#include "hw_models/dram/dram_energy.h"
#include "hw_models/dram/dram_measurements.h"
#include "sim/config/config.h"
#include "sim/report/energy.h"
#include "tests/hw_models/dram/dram_harness.h"

namespace hw::test {
namespace {

struct Grade {
  const char* file;
  double channel_gbps;  ///< peak bandwidth of a channel
};

class DramGrades : public testing::TestWithParam<Grade> {
 protected:
  static std::string path() { return std::string("configs/dram/") + GetParam().file + ".yaml"; }
  static DramConfig load() { return sim::load_config<DramConfig>(path()); }
};

INSTANTIATE_TEST_SUITE_P(All, DramGrades,
                         testing::Values(Grade{"lpddr3-1600", 6.4}, Grade{"lpddr4-3200", 6.4},
                                         Grade{"lpddr4-4266", 8.53}, Grade{"lpddr4x-4266", 8.53},
                                         Grade{"lpddr5-6400", 12.8}, Grade{"lpddr5x-8533", 17.07},
                                         Grade{"lpddr6-10667", 14.22}),
                         [](const auto& grade) {
                           std::string name = grade.param.file;
                           std::erase(name, '-');
                           return name;
                         });

double gbps(DramHarness& b, std::uint64_t lines) {
  b.run();
  return static_cast<double>(64 * lines) / static_cast<double>(b.end) * 1e6;
}

TEST_P(DramGrades, ASequentialStreamReachesNineTenthsOfThePeak) {
  for (const bool write : {false, true}) {
    DramConfig c = load();
    c.channels = 1;
    DramHarness b(c);
    for (Addr i = 0; i < 40000; ++i) b.requester().send(64 * i, 0, write);
    const double reached = gbps(b, 40000);
    EXPECT_GT(reached, 0.9 * GetParam().channel_gbps) << (write ? "writes" : "reads");
    EXPECT_LT(reached, 1.001 * GetParam().channel_gbps);
    RecordProperty(write ? "writes" : "reads", std::to_string(reached));
  }
}

TEST_P(DramGrades, RandomReadsAreBoundByActivatesOrTheBus) {
  DramConfig c = load();
  c.channels = 1;
  DramHarness b(c);
  for (std::uint64_t i = 0; i < 20000; ++i) b.requester().send(sim::hash(i) % (1 << 24) * 64);
  const double reached = gbps(b, 20000);
  const double window = 64.0 * 4 * c.organisation.ranks /
                        (static_cast<double>(c.timing.faw) * static_cast<double>(c.timing.ck.time)) * 1e6;
  EXPECT_LT(reached, 1.001 * std::min(window, GetParam().channel_gbps));
  RecordProperty("reads", std::to_string(reached));
  EXPECT_GT(reached, 0.4 * GetParam().channel_gbps);
}

TEST_P(DramGrades, EveryNumberHasASource) {
  std::ifstream file(path());
  ASSERT_TRUE(file.is_open());
  for (std::string line; std::getline(file, line);) {
    const std::string text = line.substr(0, line.find('#'));
    if (text.find(": ") != std::string::npos && !text.starts_with("extends")) {
      EXPECT_NE(line.find("# source: "), std::string::npos) << line;
    }
  }
}

TEST_P(DramGrades, AStreamingReadCostsTheKnownEnergyOfItsGeneration) {
  const auto events = dram_energy_events(load());
  ASSERT_EQ(events.size(), 8U);
  const double pj_per_bit = events.at("dram.read_burst").pj.nominal / 256;
  EXPECT_GT(pj_per_bit, 3.4);
  EXPECT_LT(pj_per_bit, 8.0);
}

TEST(DramEnergy, EveryCountedEventHasAnEnergyAndThereAreNoOthers) {
  const auto events = dram_energy_events(DramConfig{});
  std::size_t named = 0;
  const DramChannel::Stats stats;
  DramChannel::Stats::describe(stats, [&](auto&, const char*, const char*, const char* event = "", auto&&...) {
    if (*event == 0) return;
    named += 1;
    EXPECT_TRUE(events.contains(event)) << event;
  });
  EXPECT_EQ(named, events.size());
  EXPECT_TRUE(events.at("dram.active_standby").standby);
  EXPECT_FALSE(events.at("dram.activate").standby);
  EXPECT_NEAR(events.at("dram.precharge_standby").pj.nominal, 11.68 * 0.625, 1e-9) << "mW x ns";
  EXPECT_NEAR(events.at("dram.read_burst").pj.nominal, 551.3 + 412.2 + 512, 1e-9) << "core, pins and PHY";
}

TEST(DramConfig, TheDefaultIsTheFileOfItsGrade) {
  EXPECT_EQ(sim::dump_config(DramConfig{}),
            sim::dump_config(sim::load_config<DramConfig>("configs/dram/lpddr4-3200.yaml")));
}

TEST(DramConfig, ImpossibleValuesAreRefused) {
  const auto complaint = [](auto&& change) {
    DramConfig c;
    change(c);
    std::string all;
    c.check([&](const std::string& key, const std::string&) { all += key + " "; });
    c.controller.check([&](const std::string& key, const std::string&) { all += key + " "; });
    return all;
  };
  EXPECT_EQ(complaint([](DramConfig&) {}), "");
  EXPECT_EQ(complaint([](DramConfig& c) { c.line = {16}; }), "line ");
  EXPECT_EQ(complaint([](DramConfig& c) { c.organisation.bank_groups = 16; }), "organisation.bank_groups ");
  EXPECT_EQ(complaint([](DramConfig& c) { c.organisation.banks = 32, c.organisation.ranks = 2; }),
            "organisation.banks ");
  EXPECT_EQ(complaint([](DramConfig& c) { c.organisation.banks = 1, c.organisation.refresh_banks = 2; }),
            "organisation.refresh_banks ");
  EXPECT_EQ(complaint([](DramConfig& c) { c.timing.burst = 16; }), "timing.ccd_s ");
  EXPECT_EQ(complaint([](DramConfig& c) { c.timing.rfc_pb = 4096, c.timing.refi_pb = 512; }), "timing ");
  EXPECT_EQ(complaint([](DramConfig& c) { c.timing.rfc_ab = 6246; }), "") << "they refresh bank by bank";
  EXPECT_EQ(complaint([](DramConfig& c) {
              c.timing.rfc_ab = 6246;
              c.controller.refresh = RefreshKind::kAllBank;
            }),
            "timing ");
  EXPECT_EQ(complaint([](DramConfig& c) { c.controller.write_low = 24; }), "write_low ");
  EXPECT_EQ(complaint([](DramConfig& c) { c.controller.write_queue = 4; }), "write_high ");
}

// Checks that the energies of all grades derive from one die, with the rails, pages and pins of the grade
// (docs/memory-grades.md).

/// Currents of one rail of the Y52P die in mA.
struct Rail {
  double volts;
  double idd0, idd2p, idd2n, idd3n, idd4r, idd4w, idd5;
};
constexpr Rail kVdd1{1.8, 3.8, 1.5, 1.5, 2.8, 18, 16.5, 12};
constexpr Rail kVdd2{1.05, 53, 3.9, 32.5, 40, 390, 265, 205};
constexpr double kTrc = 61.25, kTras = 42.5, kTrfc = 280, kBurst = 256 / (16 * 7.5);  // ns
constexpr double kDieGb = 16;

/// Assumed typical current as a share of the maximum in a data sheet.
struct Derating {
  double low, nominal, high;
};
constexpr Derating kActivate{0.25, 0.5, 1}, kRead{0.46, 0.6, 1}, kWrite{0.43, 0.5, 1}, kRefresh{0.72, 0.83, 1},
    kStandby{0.383, 0.57, 1}, kOpenRow{0.4, 0.632, 1};

sim::Band operator*(const Derating& d, const sim::Band& maximum) {
  return {d.low * maximum.low, d.nominal * maximum.nominal, d.high * maximum.high};
}

/// Properties of a grade's interface that are not of the DRAM die.
struct Pins {
  const char* file;
  sim::Band vdd2;          ///< VDD2 in V, for low, nominal and high energy
  double vddq_standby_mw;  ///< of all pins of a rank
  double vddq_down_mw;
  double moved = 1;  ///< bits that a burst moves for each bit of data
};
constexpr sim::Band plain(double volts) { return {volts, volts, volts}; }
constexpr sim::Band kLpddr6Vdd2{0.875, 0.9354, 1.0};  // low and high: its two rails; nominal: their mean
constexpr std::array<Pins, 7> kPins{{{"lpddr3-1600", plain(1.2), 6 * 1.2, 0.2 * 1.2},
                                     {"lpddr4-3200", plain(1.1), 0.375 * 1.1, 0.375 * 1.1},
                                     {"lpddr4-4266", plain(1.1), 0.375 * 1.1, 0.375 * 1.1},
                                     {"lpddr4x-4266", plain(1.1), 0.375 * 0.6, 0.375 * 0.6},
                                     {"lpddr5-6400", plain(1.05), 0.6 * 0.5, 0.6 * 0.5},
                                     {"lpddr5x-8533", plain(1.05), 0.6 * 0.5, 0.6 * 0.5},
                                     {"lpddr6-10667", kLpddr6Vdd2, 0.6 * 0.5, 0.6 * 0.5, 36.0 / 32}}};

DramConfig load_grade(const char* file) {
  return sim::load_config<DramConfig>(std::string("configs/dram/") + file + ".yaml");
}

double rank_gb(const DramConfig& c) {
  return 8.0 * c.organisation.rows * c.organisation.banks * static_cast<double>(c.organisation.page.bytes) / (1 << 30);
}

void expect_rounded(const char* what, const sim::Band& is, const sim::Band& derived) {
  EXPECT_NEAR(is.low, derived.low, 1e-3 * derived.low) << what;
  EXPECT_NEAR(is.nominal, derived.nominal, 1e-3 * derived.nominal) << what;
  EXPECT_NEAR(is.high, derived.high, 1e-3 * derived.high) << what;
}

class EnergyBasis : public testing::TestWithParam<Pins> {};
INSTANTIATE_TEST_SUITE_P(Grades, EnergyBasis, testing::ValuesIn(kPins), [](const auto& grade) {
  std::string name = grade.param.file;
  std::erase(name, '-');
  return name;
});

TEST_P(EnergyBasis, IsTheSameDieWithTheRailsOfTheGrade) {
  const Pins& pins = GetParam();
  const DramConfig c = load_grade(pins.file);
  // VDD1 is 1.8 V in every grade; VDD2's share scales with the square of its voltage.
  const auto at_rails = [&](auto&& of_rail) {
    const auto at = [&](double volts) {
      return of_rail(kVdd1) * kVdd1.volts + of_rail(kVdd2) * kVdd2.volts * std::pow(volts / kVdd2.volts, 2);
    };
    return sim::Band{at(pins.vdd2.low), at(pins.vdd2.nominal), at(pins.vdd2.high)};
  };
  const double share = rank_gb(c) / kDieGb, pages = static_cast<double>(c.organisation.page.bytes) / 2048;
  const DramEnergy& e = c.energy;
  expect_rounded(
      "activate", e.activate,
      kActivate *
          (at_rails([](const Rail& r) { return r.idd0 * kTrc - r.idd3n * kTras - r.idd2n * (kTrc - kTras); }) * pages));
  expect_rounded("read_core", e.read_core,
                 kRead * (at_rails([](const Rail& r) { return (r.idd4r - r.idd3n) * kBurst; }) * pins.moved));
  expect_rounded("write_core", e.write_core,
                 kWrite * (at_rails([](const Rail& r) { return (r.idd4w - r.idd3n) * kBurst; }) * pins.moved));
  const sim::Band refresh = at_rails([](const Rail& r) { return (r.idd5 - r.idd2n) * kTrfc; }) * share;
  expect_rounded("refresh_all", e.refresh_all, kRefresh * refresh);
  expect_rounded("refresh", e.refresh, kRefresh * (refresh * (1.0 / 8)));
  const double interval_ns = static_cast<double>(c.timing.refi_ab) * static_cast<double>(c.timing.ck.time) * 1e-6;
  expect_rounded("self_refresh_array", e.self_refresh_array, kRefresh * (refresh * (0.25 / interval_ns)));
  const sim::Band closed = at_rails([](const Rail& r) { return r.idd2n; }) * share + plain(pins.vddq_standby_mw);
  const sim::Band open = at_rails([](const Rail& r) { return r.idd3n - r.idd2n; });
  expect_rounded("precharge_standby", e.precharge_standby, kStandby * closed);
  expect_rounded("active_standby", e.active_standby, kStandby * closed + kOpenRow * open);
  expect_rounded("power_down_standby", e.power_down_standby,
                 kStandby * (at_rails([](const Rail& r) { return r.idd2p; }) * share + plain(pins.vddq_down_mw)));
}

TEST_P(EnergyBasis, IsThatOf4GiBWith64DataLinesOr48OfLpddr6) {
  const DramConfig c = load_grade(GetParam().file);
  EXPECT_EQ(c.channels * c.organisation.width, c.organisation.width == 12 ? 48U : 64U);
  EXPECT_EQ(c.channels * c.organisation.ranks * rank_gb(c), 32);
}

/// Energies of the whole memory, to compare grades of different channel widths.
struct Cost {
  double streamed, random, idle_per_bit;  ///< energies in pJ/bit
  double idle_mw;
};
Cost cost_of(const Pins& pins) {
  const DramConfig c = load_grade(pins.file);
  const std::vector<DramMeasurement> m = dram_energy_measurements(c);
  EXPECT_EQ(m.size(), 4U);
  return {m[0].measured, m[1].measured, m[3].measured, m[2].measured * c.channels};
}

TEST(EnergyOfGrades, FallsFromGradeToGradeWhenStreamingAtRandomAndIdle) {
  for (std::size_t i = 0; i + 1 < kPins.size(); ++i) {
    const Cost older = cost_of(kPins[i]), newer = cost_of(kPins[i + 1]);
    const std::string pair = std::string(kPins[i].file) + ", " + kPins[i + 1].file;
    EXPECT_LT(newer.streamed, older.streamed) << pair;
    EXPECT_LT(newer.random, older.random) << pair;
    EXPECT_LE(newer.idle_mw, 1.001 * older.idle_mw) << pair;
    EXPECT_LT(newer.idle_per_bit, older.idle_per_bit) << pair;
  }
}

/// Returns the energy per read bit in core and pins of the device, in pJ.
sim::Band read_pj_per_bit(const char* file) {
  const DramConfig c = load_grade(file);
  return (c.energy.read_core + c.energy.read_io) * (1.0 / (8 * static_cast<double>(c.organisation.burst.bytes)));
}

// DEVIATIONS.md, D6; sources in docs/memory-grades.md.
TEST(EnergyOfGrades, OfTheDeviceIsThatPublishedForLpddr3AndAboveItForLpddr4AndTheStepToLpddr5x) {
  const sim::Band lpddr3 = read_pj_per_bit("lpddr3-1600");
  EXPECT_LT(lpddr3.low, 3.7);
  EXPECT_GT(lpddr3.high, 4);
  const double lpddr4 = read_pj_per_bit("lpddr4-3200").low;
  EXPECT_GT(lpddr4, 2.5) << "published: below 2";
  EXPECT_LT(lpddr4, 2.9);
  const double step = read_pj_per_bit("lpddr5x-8533").nominal / read_pj_per_bit("lpddr5-6400").nominal;
  EXPECT_GT(step, 0.93) << "published: 0.8";
  EXPECT_LT(step, 0.97);
}

// Compares the timing table of LPDDR4-3200 (DramConfig's defaults) with values computed by hand from the grade's
// parameters. A line of 64 bytes is two bursts of 8 cycles (tCCD 8); RL 28, WL 14, tDQSCK 3, tDQSS 1.

/// Returns the largest distance in cycles of the table's rows of this kind, or -1 if there is none.
std::int64_t cycles(DramScope scope, DramOp from, DramOp to, std::uint32_t count = 1) {
  const DramTerms terms{DramConfig{}};
  std::int64_t most = -1;
  for (const DramConstraint& row : kDramConstraints) {
    const bool is_it = row.scope == scope && row.from == from && row.to == to && row.count == count;
    if (is_it) most = std::max(most, row.cycles(terms));
  }
  return most;
}

TEST(DramTimingTable, BindsTheCommandsOfABank) {
  EXPECT_EQ(cycles(DramScope::kBank, DramOp::kActivate, DramOp::kRead), 29) << "tRCD";
  EXPECT_EQ(cycles(DramScope::kBank, DramOp::kActivate, DramOp::kWrite), 29) << "tRCD";
  EXPECT_EQ(cycles(DramScope::kBank, DramOp::kActivate, DramOp::kPrecharge), 68) << "tRAS";
  EXPECT_EQ(cycles(DramScope::kBank, DramOp::kActivate, DramOp::kActivate), 97) << "tRC";
  EXPECT_EQ(cycles(DramScope::kBank, DramOp::kPrecharge, DramOp::kActivate), 29) << "tRPpb";
  EXPECT_EQ(cycles(DramScope::kBank, DramOp::kRead, DramOp::kPrecharge), 8 + 12) << "last read + tRTP";
  EXPECT_EQ(cycles(DramScope::kBank, DramOp::kWrite, DramOp::kPrecharge), 8 + 14 + 1 + 8 + 29)
      << "last data of the write + tWR";
  EXPECT_EQ(cycles(DramScope::kBank, DramOp::kRefresh, DramOp::kActivate), 224) << "tRFCpb";
  EXPECT_EQ(cycles(DramScope::kBank, DramOp::kRefreshRank, DramOp::kActivate), 448) << "tRFCab";
}

TEST(DramTimingTable, BindsReadsAndWritesOfABankGroup) {
  EXPECT_EQ(cycles(DramScope::kBankGroup, DramOp::kRead, DramOp::kRead), 8 + 8) << "last read + tCCD_L";
  EXPECT_EQ(cycles(DramScope::kBankGroup, DramOp::kWrite, DramOp::kWrite), 8 + 8);
  EXPECT_EQ(cycles(DramScope::kBankGroup, DramOp::kWrite, DramOp::kRead), 8 + 14 + 1 + 8 + 16)
      << "last write + WL + tDQSS + tCCD_L + tWTR_L";
}

TEST(DramTimingTable, BindsARank) {
  EXPECT_EQ(cycles(DramScope::kRank, DramOp::kActivate, DramOp::kActivate), 16) << "tRRD";
  EXPECT_EQ(cycles(DramScope::kRank, DramOp::kActivate, DramOp::kActivate, 4), 64)
      << "tFAW, counted from the fourth last";
  EXPECT_EQ(cycles(DramScope::kRank, DramOp::kRead, DramOp::kWrite), 8 + 28 + 3 + 8 + 1 - 14)
      << "read data + tRTW end where write data begin";
  EXPECT_EQ(cycles(DramScope::kRank, DramOp::kWrite, DramOp::kRead), 8 + 14 + 1 + 8 + 16) << "write data + tWTR_S";
}

TEST(DramTimingTable, BindsOtherRanksByTheirTurnOnTheDataBus) {
  EXPECT_EQ(cycles(DramScope::kOtherRanks, DramOp::kRead, DramOp::kRead), 8 + 8 + 1) << "burst + tRTRS";
  EXPECT_EQ(cycles(DramScope::kOtherRanks, DramOp::kWrite, DramOp::kWrite), 8 + 8 + 1);
  EXPECT_EQ(cycles(DramScope::kOtherRanks, DramOp::kWrite, DramOp::kRead), 8 + 14 + 1 + 8 + 1 - 28 - 3)
      << "may be negative";
  EXPECT_EQ(cycles(DramScope::kOtherRanks, DramOp::kActivate, DramOp::kActivate), -1)
      << "ranks open rows independently";
}

}  // namespace

}  // namespace hw::test
