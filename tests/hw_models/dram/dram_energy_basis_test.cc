#include <array>
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "hw_models/dram/dram_measurements.h"
#include "sim/config/config.h"
#include "sim/report/energy.h"

// Checks that the energies of all grades derive from one die, with the rails, pages and pins of the grade
// (docs/memory-grades.md).

namespace hw::test {
namespace {

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

TEST(EnergyOfGrades, IsNoHigherInANewerGradeStreamingAtRandomOrIdle) {
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

}  // namespace
}  // namespace hw::test
