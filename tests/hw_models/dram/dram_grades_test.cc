#include <fstream>
#include <string>

#include <gtest/gtest.h>

#include "hw_models/dram/dram_energy.h"
#include "sim/config/config.h"
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

}  // namespace
}  // namespace hw::test
