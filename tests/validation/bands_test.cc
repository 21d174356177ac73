#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/real_scenes.h"
#include "tests/validation/figures.h"
#include "tools/run/frame/run_job.h"

// Compares metrics with plausible bands for a machine of this class. DEVIATIONS.md explains values outside their band.
// Tests assert their measured range, so that closing a gap is noticed.

namespace tools {
namespace {

struct Figures {
  double pj_per_visit = 0;  ///< T&I units with their caches
  double dram_share = 0;    ///< share of all energy
  double watts = 0;
  double mrays_per_s = 0;
  std::uint64_t spilled = 0;  ///< spilled ray slots
};

std::uint64_t sum(const FrameResult& s, const std::string& counter) {
  std::uint64_t total = 0;
  for (const sim::UnitReport& unit : s.units) {
    for (const sim::CounterReport& c : unit.counters) total += c.name == counter ? c.value : 0;
  }
  return total;
}

Figures measure(const std::string& scene, std::vector<std::string> sets = {}) {
  JobOptions options;
  options.scene = scene;
  options.resolution = "512x256";
  options.sets = std::move(sets);
  const FrameResult s = simulate_frame(load_inputs(options), kernels::parse_program("full:1"), 0);
  const double all = s.energy.total_pj.nominal;
  const double seconds = static_cast<double>(s.elapsed) * 1e-15;
  return {s.energy.blocks.at("tni").total().nominal / static_cast<double>(sum(s, "visits")),
          s.energy.blocks.at("dram").total().nominal / all, all * 1e-12 / seconds,
          static_cast<double>(s.rays()) / seconds / 1e6, sum(s, "spilled_slots")};
}

/// Rules for all scenes: power and ray rate inside their bands, energy per node visit above its band (D1).
void expect_believable(const Figures& f) {
  expect_between("W", f.watts, 0.5, 3);
  expect_between("Mrays/s", f.mrays_per_s, 100, 320);
  expect_between("pJ per visit", f.pj_per_visit, 120, 190);
}

void expect_a_scene_larger_than_the_l2(const Figures& f) {
  expect_believable(f);
  expect_between("share of DRAM", f.dram_share, 0.15, 0.50);
}

TEST(Bands, BuiltInScenesAreSixToTenTimesTheL2) {
  expect_a_scene_larger_than_the_l2(measure("cornell"));
  expect_a_scene_larger_than_the_l2(measure("teapot"));
  expect_a_scene_larger_than_the_l2(measure("teapot", {"render.mip_maps=off"}));
}

TEST(Bands, ASceneThatFitsTheL2HardlyUsesMemoryUnlessRaySlotsSpill) {
  const Figures spilling = measure("cornell", {"l2.size=2 MiB"});
  expect_believable(spilling);
  EXPECT_GT(spilling.spilled, 0U);
  expect_between("share of DRAM", spilling.dram_share, 0.10, 0.25);  // above its band: D2

  const Figures held = measure("cornell", {"l2.size=2 MiB", "tile_buffer.size=1 MiB"});
  EXPECT_EQ(held.spilled, 0U);
  expect_between("share of DRAM", held.dram_share, 0.10, 0.12);  // just above its band: D2
}

/// Returns the path of a real scene file; empty if it is not available.
std::string real_scene(const char* name) {
  const std::filesystem::path file = test::scenes_folder() / name;
  return std::filesystem::exists(file) ? file.string() : "";
}

TEST(Bands, ChessIsInsideThoughItWaitsForItsTextures) {
  const std::string chess = real_scene("chess-42k.glb");
  if (chess.empty()) GTEST_SKIP() << "no real scenes here: set RAYWATT_SCENES to a folder that has chess-42k.glb";
  expect_a_scene_larger_than_the_l2(measure(chess));
}

TEST(Bands, ConferenceShowsLittleOfItsTreeToOneCamera) {
  const std::string conference = real_scene("conference-331k.glb");
  if (conference.empty()) {
    GTEST_SKIP() << "no real scenes here: set RAYWATT_SCENES to a folder that has conference-331k.glb";
  }
  const Figures f = measure(conference);
  expect_believable(f);
  expect_between("share of DRAM", f.dram_share, 0.08, 0.15);  // below its band: D3
}

}  // namespace
}  // namespace tools
