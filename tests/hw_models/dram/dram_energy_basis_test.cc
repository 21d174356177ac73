#include <array>
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "hw_models/dram/dram_measurements.h"
#include "sim/config/config.h"
#include "sim/report/energy.h"

// The energy of every grade is that of the same die with the grade's rails, pages and pins (docs/design/energy.md,
// "Memory grades on one basis").

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

/// Share of a data sheet's maximum.
struct Derating {
  double low, nominal, high;
};
constexpr Derating kActivate{0.25, 0.5, 1}, kRead{0.46, 0.6, 1}, kWrite{0.43, 0.5, 1}, kRefresh{0.72, 0.83, 1},
    kStandby{0.383, 0.57, 1}, kOpenRow{0.4, 0.632, 1};

sim::Band operator*(const Derating& d, double maximum) {
  return {d.low * maximum, d.nominal * maximum, d.high * maximum};
}

/// Interface of a grade, outside the DRAM die.
struct Pins {
  const char* file;
  double vdd2;             ///< V
  double vddq_standby_mw;  ///< of a rank's pins
  double vddq_down_mw;
};
constexpr std::array<Pins, 5> kPins{{{"lpddr3-1600", 1.2, 6 * 1.2, 0.2 * 1.2},
                                     {"lpddr4-3200", 1.1, 0.375 * 1.1, 0.375 * 1.1},
                                     {"lpddr4-4266", 1.1, 0.375 * 1.1, 0.375 * 1.1},
                                     {"lpddr4x-4266", 1.1, 0.375 * 0.6, 0.375 * 0.6},
                                     {"lpddr5-6400", 1.05, 0.6 * 0.5, 0.6 * 0.5}}};

DramConfig config_behind(const char* file) {
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
  const DramConfig c = config_behind(pins.file);
  // VDD1 is 1.8 V in every grade; VDD2's share scales with the square of its voltage.
  const auto at_rails = [&](auto&& of_rail) {
    return of_rail(kVdd1) * kVdd1.volts + of_rail(kVdd2) * kVdd2.volts * std::pow(pins.vdd2 / kVdd2.volts, 2);
  };
  const double share = rank_gb(c) / kDieGb, pages = static_cast<double>(c.organisation.page.bytes) / 2048;
  const DramEnergy& e = c.energy;
  expect_rounded("activate", e.activate, kActivate * (pages * at_rails([](const Rail& r) {
                                                        return r.idd0 * kTrc - r.idd3n * kTras -
                                                               r.idd2n * (kTrc - kTras);
                                                      })));
  expect_rounded("read_core", e.read_core,
                 kRead * at_rails([](const Rail& r) { return (r.idd4r - r.idd3n) * kBurst; }));
  expect_rounded("write_core", e.write_core,
                 kWrite * at_rails([](const Rail& r) { return (r.idd4w - r.idd3n) * kBurst; }));
  const double refresh = share * at_rails([](const Rail& r) { return (r.idd5 - r.idd2n) * kTrfc; });
  expect_rounded("refresh_all", e.refresh_all, kRefresh * refresh);
  expect_rounded("refresh", e.refresh, kRefresh * (refresh / 8));
  const double closed = share * at_rails([](const Rail& r) { return r.idd2n; }) + pins.vddq_standby_mw;
  const double open = at_rails([](const Rail& r) { return r.idd3n - r.idd2n; });
  expect_rounded("precharge_standby", e.precharge_standby, kStandby * closed);
  expect_rounded("active_standby", e.active_standby, kStandby * closed + kOpenRow * open);
  expect_rounded("power_down_standby", e.power_down_standby,
                 kStandby * (share * at_rails([](const Rail& r) { return r.idd2p; }) + pins.vddq_down_mw));
}

TEST_P(EnergyBasis, IsThatOf4GiBWith64DataLines) {
  const DramConfig c = config_behind(GetParam().file);
  EXPECT_EQ(c.channels * c.organisation.width, 64U);
  EXPECT_EQ(c.channels * c.organisation.ranks * rank_gb(c), 32);
}

/// Values of the whole memory, so that grades with wide channels are comparable.
struct Cost {
  double streamed, random, idle_per_bit;  ///< pJ/bit
  double idle_mw;
};
Cost cost_of(const Pins& pins) {
  const DramConfig c = config_behind(pins.file);
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

}  // namespace
}  // namespace hw::test
