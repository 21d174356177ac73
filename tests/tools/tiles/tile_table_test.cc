#include "tools/tiles/tile_table.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <gtest/gtest.h>

#include "hw_models/dram/dram_channel.h"
#include "hw_models/memory/core_port.h"
#include "sim/error.h"
#include "tests/hw_models/machines/gpu_harness.h"
#include "tests/hw_models/machines/random_config.h"
#include "tests/temp_folder.h"
#include "tests/tools/tiles/itemised.h"
#include "tools/analysis/units.h"
#include "tools/tiles/tile_energy.h"

namespace tools::test {
namespace {

TileTable some_table() {
  TileFrame frame{7,
                  {{"tile", "", false, {1, 0}}, {"steps", "steps", true, {4, 9007199254740991}, 3, 9007199254740998}}};
  frame.columns.push_back({"energy_mj_low", "mJ", true, {0.1, 1e-17}, 0.30000000000000004, 0.4});
  return {{frame, {8, {{"tile", "", false, {}}}}}};
}

TEST(TileTable, ReadsBackWhatItWrote) {
  const ::test::TempFolder folder;
  const TileTable table = some_table();
  folder.write("tiles.json", tiles_text(table));
  const TileTable back = load_tiles(folder.path());
  EXPECT_EQ(tiles_text(back), tiles_text(table));
  ASSERT_EQ(back.frames.size(), 2U);
  EXPECT_EQ(back.frames[0].frame, 7U);
  EXPECT_EQ(back.frames[0].at("steps"), (std::vector<double>{4, 9007199254740991}));
  EXPECT_EQ(back.frames[0].find("energy_mj_low")->rest, 0.30000000000000004);
  EXPECT_EQ(back.frames[0].find("energy_mj_low")->unit, "mJ");
  EXPECT_FALSE(back.frames[0].find("tile")->is_sum);
  EXPECT_EQ(back.frames[0].find("steps_of_others"), nullptr);
}

std::string complaint(const std::string& text) {
  const ::test::TempFolder folder;
  folder.write("tiles.json", text);
  try {
    load_tiles(folder.path() / "tiles.json");
  } catch (const sim::InputError& error) {
    return error.what();
  }
  return {};
}

TEST(TileTable, RefusesOtherFilesByName) {
  const std::string good = tiles_text(some_table());
  EXPECT_EQ(complaint(good), "");
  for (const std::string& bad :
       {std::string("{"), std::string("[]"), std::string(10000, '['), std::string(R"({"schema": "raywatt-tiles/2"})"),
        std::string(R"({"schema": "raywatt-tiles/1", "units": {}, "frames": [{"frame": 0}]})")}) {
    EXPECT_NE(complaint(bad).find("tiles.json: "), std::string::npos) << bad;
  }
  std::string uneven = good;
  uneven.replace(uneven.find("[1,0]"), 5, "[1]");
  EXPECT_NE(complaint(uneven).find("frame 7: column 'steps' has another length"), std::string::npos);
  std::string huge = good;
  huge.replace(huge.find("\"frame\": 7"), 10, "\"frame\": 1e300");
  EXPECT_NE(complaint(huge).find("tiles.json: the number 'frame'"), std::string::npos) << huge;
}

// Tests that values of tiles sum to those of the frame on any machine, and that collecting them changes no result.

constexpr double kMillijoulesPerPicojoule = 1e-9;

double sum(const TileColumn& column) {
  const double tiles = std::accumulate(column.values.begin(), column.values.end(), 0.0);
  return tiles + column.rest;
}

double sum_of_column(const TileFrame& frame, const char* column) {
  const TileColumn* found = frame.find(column);
  EXPECT_NE(found, nullptr) << column;
  EXPECT_TRUE(found->is_sum) << column;
  EXPECT_EQ(sum(*found), found->total) << column;
  return found->total;
}

double counted(std::uint64_t value) { return static_cast<double>(value); }

void expect_sums(const FrameResult& s, const TileFrame& frame) {
  constexpr const char* kRays[] = {"rays_primary", "rays_shadow", "rays_reflection", "rays_refraction"};
  for (std::size_t kind = 0; kind < std::size(kRays); ++kind) {
    EXPECT_EQ(sum_of_column(frame, kRays[kind]), counted(s.rendered.rays[kind])) << kRays[kind];
  }
  EXPECT_EQ(sum_of_column(frame, "steps"), counted(s.rendered.traversal_steps));
  EXPECT_EQ(sum_of_column(frame, "tests"), counted(Units<hw::Ist>(s.units).sum_of(&hw::Ist::Stats::tests)));
  std::uint64_t kernel_cycles = 0;
  for (const hw::KernelUse& use : s.kernel_use) kernel_cycles += use.cycles;
  EXPECT_EQ(sum_of_column(frame, "srp_cycles"), counted(kernel_cycles));
  double bytes = 0;
  for (const std::string_view asker : names_of(hw::RequesterKind{})) {
    bytes += sum_of_column(frame, ("bytes_" + std::string(asker)).c_str());
  }
  EXPECT_EQ(bytes, counted(hw::kLineBytes * Units<hw::CorePort>(s.units).sum_of(&hw::CorePort::Stats::requests)));
  EXPECT_EQ(sum_of_column(frame, "dram_bytes"),
            counted(Units<hw::DramChannel>(s.units).sum_of(&hw::DramChannel::Stats::bytes)));
  EXPECT_EQ(sum_of_column(frame, "energy_mj_low"), s.energy.total_pj.low * kMillijoulesPerPicojoule);
  EXPECT_EQ(sum_of_column(frame, "energy_mj_nominal"), s.energy.total_pj.nominal * kMillijoulesPerPicojoule);
  EXPECT_EQ(sum_of_column(frame, "energy_mj_high"), s.energy.total_pj.high * kMillijoulesPerPicojoule);
}

/// Expects that energy not attributed to tiles is only that which has no tile, not energy omitted by mistake.
void expect_honest_rest(const FrameResult& s, const Inputs& inputs, const TileFrame& frame) {
  const double rest = tile_energy(s, inputs.config).rest.nominal * kMillijoulesPerPicojoule;
  const TileColumn& column = *frame.find("energy_mj_nominal");
  EXPECT_NEAR(column.rest, rest, 1e-12 * column.total);
  EXPECT_GE(*std::ranges::min_element(column.values), 0);
}

TEST(TilesOfRandomMachines, SumToTheirTotalsAndChangeNothing) {
  Inputs inputs = small_inputs({"render.tile=8"}, "32x16");
  for (std::uint64_t seed = 0; seed < 30; ++seed) {
    *inputs.config.gpu = hw::test::random_config(seed);
    const FrameResult plain = simulate_frame(inputs, {}, 1), s = itemised(inputs);
    const hw::test::Outcome a{plain.units, plain.kernel_use, {}, plain.elapsed, plain.cycles};
    const hw::test::Outcome b{s.units, s.kernel_use, {}, s.elapsed, s.cycles};
    EXPECT_EQ(difference(a, b), "") << "machine " << seed;
    const TileFrame frame = compute_tile_table(s, inputs.config, 0);
    EXPECT_EQ(frame.rows(), 8U);
    expect_sums(s, frame);
    expect_honest_rest(s, inputs, frame);
    if (HasFailure()) FAIL() << "machine " << seed;
  }
}

class TilesOf : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Programs, TilesOf,
                         testing::Values("full:4", "multirate:under", "multirate:super", "undersample", "supersample"),
                         [](const auto& i) {
                           std::string name = i.param;
                           std::ranges::replace(name, ':', '_');
                           return name;
                         });

TEST_P(TilesOf, EachProgramSumToItsTotalsForAnyNumberOfThreads) {
  const Inputs inputs = small_inputs({"render.tile=16", "supersample.propagate=1"});
  const FrameResult s = itemised(inputs, GetParam());
  const TileFrame frame = compute_tile_table(s, inputs.config, 0);
  expect_sums(s, frame);
  expect_honest_rest(s, inputs, frame);
  const TileTable one{{frame}}, three{{compute_tile_table(itemised(inputs, GetParam(), 3), inputs.config, 0)}};
  EXPECT_EQ(tiles_text(one), tiles_text(three));
}

TEST_P(TilesOf, EachProgramCoverThePicture) {
  const Inputs inputs = small_inputs({"render.tile=16", "supersample.propagate=1"});
  const TileFrame frame = compute_tile_table(itemised(inputs, GetParam()), inputs.config, 0);
  const std::size_t passes = 1 + static_cast<std::size_t>(std::ranges::max(frame.at("pass")));
  std::vector<std::size_t> covered(std::size_t{48} * 24);
  for (std::size_t i = 0; i < frame.rows(); ++i) {
    for (double y = frame.at("y")[i]; y < frame.at("y")[i] + frame.at("height")[i]; ++y) {
      for (double x = frame.at("x")[i]; x < frame.at("x")[i] + frame.at("width")[i]; ++x) {
        covered[static_cast<std::size_t>(y * 48 + x)] += 1;
      }
    }
  }
  EXPECT_EQ(covered, std::vector<std::size_t>(covered.size(), passes)) << "each pixel once a pass";
}

TEST(Tiles, AreInFlightWhileTheyAreWorkedOn) {
  const Inputs inputs = small_inputs({"render.tile=8", "cores=2"});
  const FrameResult s = itemised(inputs);
  const TileFrame frame = compute_tile_table(s, inputs.config, 0);
  std::vector<double> cores = frame.at("core");
  std::ranges::sort(cores);
  EXPECT_EQ(cores.front(), 0);
  EXPECT_EQ(cores.back(), 1);
  for (std::size_t i = 0; i < frame.rows(); ++i) {
    EXPECT_LT(frame.at("dispatched")[i], frame.at("finished")[i]);
    EXPECT_LE(frame.at("finished")[i], counted(s.cycles));
    EXPECT_GT(frame.at("srp_cycles")[i], 0);
    EXPECT_GT(frame.at("energy_mj_nominal")[i], frame.at("energy_mj_low")[i]);
    EXPECT_GT(frame.at("bytes_transfers")[i], 0) << "its part of the picture";
  }
}

TEST(Tiles, OfOneTileHaveAllThatAnybodyAskedFor) {
  const Inputs inputs = small_inputs({"render.tile=8", "cores=1"}, "8x8");
  const TileFrame frame = compute_tile_table(itemised(inputs), inputs.config, 0);
  ASSERT_EQ(frame.rows(), 1U);
  for (const char* column : {"srp_cycles", "steps", "tests", "bytes_nodes", "bytes_shading", "dram_bytes"}) {
    EXPECT_EQ(frame.at(column)[0], frame.find(column)->total) << column;
  }
  const TileColumn& energy = *frame.find("energy_mj_nominal");
  EXPECT_GT(energy.values[0], 0.9 * energy.total) << "all but what passes before it comes and when it has gone";
}

std::vector<hw::TileAccount> tiles() {
  return {{.core = 0, .dispatched = 0, .finished = 10},
          {.core = 0, .dispatched = 5, .finished = 15},
          {.core = 1, .dispatched = 5, .finished = 10}};
}

TEST(TileTimeShares, IsSharedByThoseWhoAreThere) {
  const TileTimeShares of_core = tile_time_shares(tiles(), 20, 0);
  EXPECT_DOUBLE_EQ(of_core.tiles[0], 7.5 / 20) << "five alone, half of five";
  EXPECT_DOUBLE_EQ(of_core.tiles[1], 7.5 / 20);
  EXPECT_EQ(of_core.tiles[2], 0) << "it is elsewhere";
  EXPECT_DOUBLE_EQ(of_core.rest, 5.0 / 20);
}

TEST(TileTimeShares, OfAllCoresTogetherIsTheWholeTime) {
  const TileTimeShares all = tile_time_shares(tiles(), 20, {});
  EXPECT_DOUBLE_EQ(all.tiles[0], (5 + 5 / 3.0) / 20);
  EXPECT_DOUBLE_EQ(all.tiles[1], (5 + 5 / 3.0) / 20);
  EXPECT_DOUBLE_EQ(all.tiles[2], 5 / 3.0 / 20);
  EXPECT_DOUBLE_EQ(all.tiles[0] + all.tiles[1] + all.tiles[2] + all.rest, 1);
}

TEST(TileTimeShares, WithoutTilesAreAllRest) { EXPECT_EQ(tile_time_shares({}, 20, {}).rest, 1); }

}  // namespace
}  // namespace tools::test
