#include <algorithm>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/tools/program.h"

// Tests of a run's results: files, fields of report.json, sums, and repeatability.

namespace test {
namespace {

using Json = nlohmann::json;

/// Runs with `more`, expects success, and returns the report.
Json report_of(const std::filesystem::path& out, const Words& more = {}) {
  const ProcessResult ending = raywatt(small_run(out, more));
  EXPECT_EQ(ending.exit, 0) << ending.err;
  EXPECT_EQ(ending.err, "");
  return read_json(out / "report.json");
}

void expect_members(const Json& object, const Words& names, const std::string& where) {
  for (const std::string& name : names) EXPECT_TRUE(object.contains(name)) << where << '.' << name;
}

const Words kBand = {"low", "nominal", "high"};
const Words kBlocks = {"tni", "srp", "l2", "tile_buffer", "dma", "interconnect", "dram"};

/// Calls `f` with path and report of every unit.
template <class F>
void each_unit(const Json& tree, const std::string& path, F&& f) {
  if (tree.contains("elapsed")) f(path, tree);
  for (const auto& [name, branch] : tree.items()) {
    if (branch.is_object() && name != "why" && name != "counters") each_unit(branch, path + "." + name, f);
  }
}

TEST(Run, LeavesTheFilesOfTheContractAndNothingElse) {
  const TempFolder folder;
  const std::filesystem::path out = folder.path() / "new" / "out";
  report_of(out);
  EXPECT_EQ(names_in(out), (Words{"config.yaml", "image.exr", "image.png", "intervals.bin.zst", "pixels.exr",
                                  "report.json", "report.txt", "tiles.json"}));
  EXPECT_EQ(names_in(folder.path() / "new"), Words{"out"}) << "nothing beside it";
  for (const std::string& name : names_in(out)) EXPECT_GT(std::filesystem::file_size(out / name), 0U) << name;
}

TEST(Run, LeavesTheSamePicturesOnAllThreadsOfTheHost) {
  const TempFolder folder;
  const Words more = {"--frames", "0:1", "--program", "multirate:under", "--reference", "full:1", "--debug-images"};
  const std::filesystem::path one = folder.path() / "one", two = folder.path() / "two", all = folder.path() / "all";
  report_of(one, more);
  Words words = small_run(two, more);
  *(std::ranges::find(words, "--threads") + 1) = "2";
  EXPECT_EQ(raywatt(words).exit, 0);
  words = small_run(all, more);
  const auto threads = std::ranges::find(words, "--threads");
  words.erase(threads, threads + 2);  // the default
  EXPECT_EQ(raywatt(words).exit, 0);

  std::size_t pictures = 0;
  for (const auto& other : {two, all}) {
    EXPECT_EQ(names_in(other), names_in(one));
    for (const std::string& name : names_in(one)) {
      if (!name.ends_with(".png") && !name.ends_with(".exr")) continue;
      EXPECT_EQ(read_bytes(other / name), read_bytes(one / name)) << name;
      pictures += 1;
    }
  }
  EXPECT_GT(pictures, 20U);
}

TEST(Run, ReportHasEveryFieldOfTheContract) {
  const TempFolder folder;
  const Json r = report_of(folder.path() / "out");
  expect_members(r,
                 {"schema", "partial", "program", "resolution", "config", "scene", "provenance", "totals", "frames",
                  "units", "host"},
                 "report");
  EXPECT_EQ(r["schema"], "raywatt-report/1");
  EXPECT_EQ(r["partial"], false);
  EXPECT_EQ(r["program"], "full:1");
  EXPECT_EQ(r["resolution"], Json({64, 32}));
  expect_members(r["scene"], {"name", "triangles", "instances", "lights"}, "scene");
  expect_members(r["provenance"],
                 {"version", "git", "dirty", "compiler", "flags", "embree", "model_id", "config_hash", "scene_sha256",
                  "bvh_hash", "argv"},
                 "provenance");
  EXPECT_EQ(r["provenance"]["argv"][1], "run");
  expect_members(r["host"],
                 {"date", "name", "wall_s", "load_s", "functional_s", "timing_s", "rays_per_s", "steps_per_s",
                  "peak_rss_mb", "threads"},
                 "host");
  const Json& t = r["totals"];
  expect_members(t,
                 {"cycles", "time_ms", "rays", "traced_ratio", "traversal_steps", "dram_bytes", "energy_mj",
                  "energy_by_block_mj", "energy_by_kind_mj", "power_w", "perf", "utilisation", "limiter", "kernels"},
                 "totals");
  expect_members(t["rays"], {"primary", "shadow", "reflection", "refraction", "total"}, "rays");
  expect_members(t["perf"], {"fps", "mrays_per_s", "nj_per_ray", "frames_per_joule_gpu", "frames_per_joule_tni"},
                 "perf");
  expect_members(t["utilisation"], {"tni", "srp", "dram"}, "utilisation");
  expect_members(t["energy_mj"], kBand, "energy_mj");
  expect_members(t["power_w"], kBand, "power_w");
  for (const std::string& block : kBlocks) expect_members(t["energy_by_block_mj"][block], kBand, block);
  for (const char* kind : {"dynamic", "clock", "leakage"}) expect_members(t["energy_by_kind_mj"][kind], kBand, kind);
  for (const auto& [name, kernel] : t["kernels"].items()) {
    expect_members(kernel, {"launches", "items", "ii", "depth", "cycles", "share", "starved"}, name);
  }
  EXPECT_TRUE(t["kernels"].contains("generate_rays"));
}

TEST(Run, DramBytesByClientSumToAllOfThem) {
  const TempFolder folder;
  const Json totals = report_of(folder.path() / "out")["totals"];
  std::uint64_t sum = 0;
  for (const auto& [client, bytes] : totals["dram_bytes_by_client"].items()) sum += bytes.get<std::uint64_t>();
  EXPECT_EQ(sum, totals["dram_bytes"]);
}

TEST(Run, EnergyByBlockAndByKindSumToTheTotal) {
  const TempFolder folder;
  const Json totals = report_of(folder.path() / "out")["totals"];
  for (const std::string& bound : kBand) {
    const double total = totals["energy_mj"][bound];
    double blocks = 0, kinds = 0;
    for (const auto& [name, energy] : totals["energy_by_block_mj"].items()) blocks += energy[bound].get<double>();
    for (const auto& [name, energy] : totals["energy_by_kind_mj"].items()) kinds += energy[bound].get<double>();
    EXPECT_GT(total, 0);
    EXPECT_NEAR(blocks / total, 1, 1e-9) << bound;
    EXPECT_NEAR(kinds / total, 1, 1e-9) << bound;
  }
  EXPECT_EQ(totals["energy_by_block_mj"].size(), kBlocks.size());
}

TEST(Run, EveryUnitsTimeIsChargedToReasonsThatSumToIt) {
  const TempFolder folder;
  int units = 0;
  each_unit(report_of(folder.path() / "out")["units"], "units", [&](const std::string& path, const Json& unit) {
    std::uint64_t charged = 0;
    for (const auto& [reason, cycles] : unit["why"].items()) charged += cycles.get<std::uint64_t>();
    EXPECT_EQ(charged, unit["elapsed"]) << path;
    EXPECT_GT(unit["elapsed"], 0) << path;
    ++units;
  });
  EXPECT_GT(units, 30) << "four cores, each with a shader core, four TRVs, an IST and more";
}

TEST(Run, DerivedMetricsFollowFromTheCounters) {
  const TempFolder folder;
  const Json totals = report_of(folder.path() / "out")["totals"];
  const double ms = totals["time_ms"], mj = totals["energy_mj"]["nominal"];
  const Json& rays = totals["rays"];
  EXPECT_EQ(rays["primary"], 64 * 32);
  std::uint64_t sum = 0;
  for (const char* kind : {"primary", "shadow", "reflection", "refraction"}) sum += rays[kind].get<std::uint64_t>();
  EXPECT_EQ(rays["total"], sum);
  EXPECT_DOUBLE_EQ(ms, totals["cycles"].get<double>() / 500e3) << "500 MHz";
  EXPECT_DOUBLE_EQ(totals["perf"]["fps"], 1000 / ms);
  EXPECT_DOUBLE_EQ(totals["perf"]["frames_per_joule_gpu"], 1000 / mj);
  EXPECT_DOUBLE_EQ(totals["perf"]["frames_per_joule_tni"],
                   1000 / totals["energy_by_block_mj"]["tni"]["nominal"].get<double>());
  EXPECT_NEAR(totals["power_w"]["nominal"], mj / ms, 1e-9);
  EXPECT_NEAR(totals["perf"]["mrays_per_s"], static_cast<double>(sum) / ms / 1000, 1e-9);
  EXPECT_NEAR(totals["perf"]["nj_per_ray"], mj * 1e6 / static_cast<double>(sum), 1e-9);
  double share = 0;
  for (const auto& [name, kernel] : totals["kernels"].items()) share += kernel["share"].get<double>();
  EXPECT_NEAR(share, 1, 1e-9);
  for (const auto& [block, used] : totals["utilisation"].items()) {
    EXPECT_GT(used, 0) << block;
    EXPECT_LE(used, 1) << block;
  }
}

TEST(Run, TheOneFrameIsTheTotal) {
  const TempFolder folder;
  Json report = report_of(folder.path() / "out");
  ASSERT_EQ(report["frames"].size(), 1U);
  EXPECT_EQ(report["frames"][0]["frame"], 0);
  report["frames"][0].erase("frame");
  Json& totals = report["totals"];
  for (const char* of_the_machine :
       {"area_mm2", "area_band_mm2", "area_by_block_mm2", "area_by_part_mm2", "extrapolated"}) {
    EXPECT_EQ(totals.erase(of_the_machine), 1U);
  }
  for (const char* by_area : {"frames_per_joule_per_mm2", "mrays_per_s_per_mm2"}) {
    EXPECT_EQ(totals["perf"].erase(by_area), 1U);
  }
  EXPECT_EQ(report["frames"][0], totals);
}

TEST(Run, ItsConfigurationLoadsAgainAndGivesTheSameRun) {
  const TempFolder folder;
  const Json first = report_of(folder.path() / "first", {"--set", "cores=2"});
  const std::filesystem::path out = folder.path() / "second";
  const ProcessResult ending = raywatt({"run", (folder.path() / "first" / "config.yaml").string(), "-o", out.string()});
  ASSERT_EQ(ending.exit, 0) << ending.err;
  EXPECT_EQ(repeatable(read_json(out / "report.json")), repeatable(first));
  EXPECT_EQ(read_bytes(out / "config.yaml"), read_bytes(folder.path() / "first" / "config.yaml"));
}

TEST(Run, WithoutRaysHasNoMetricsPerRay) {
  const TempFolder folder;
  const std::filesystem::path out = folder.path() / "out";
  const Json report = report_of(out, {"--set", "render.primary=raster", "--set", "render.effects=none"});
  EXPECT_EQ(report["totals"]["rays"]["total"], 0);
  EXPECT_TRUE(report["totals"]["perf"]["nj_per_ray"].is_null());
  const std::string text = read_bytes(out / "report.txt");
  for (const char* wrong : {"nan", "inf ", "per ray"}) EXPECT_EQ(text.find(wrong), std::string::npos) << text;
}

TEST(Run, OfAMachineInALivelockEndsWith3AndTheStateOfEachUnit) {
  const TempFolder folder;
  const ProcessResult ending = raywatt(small_run(folder.path() / "out", {"--set", "watchdog=2"}));
  EXPECT_EQ(ending.exit, 3);
  EXPECT_SAYS(ending.err, "raywatt: the machine is in a livelock");
  for (const char* unit : {"tile_dispatcher: ", "core0.srp: ", "core0.tni.trv0: ", "l2.bank0: ", "dram.channel0: "}) {
    EXPECT_SAYS(ending.err, unit);
  }
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "out"));
}

TEST(Run, DoesNotDependOnTheThreadsOfTheHost) {
  const TempFolder folder;
  const auto out = [&](const char* threads) {
    const std::filesystem::path path = folder.path() / threads;
    const ProcessResult ending = raywatt({"run", "--resolution", "64x32", "--threads", threads, "-o", path.string()});
    EXPECT_EQ(ending.exit, 0) << ending.err;
    return path;
  };
  const std::filesystem::path one = out("1"), two = out("2"), three = out("3");
  for (const auto& other : {two, three}) {
    EXPECT_EQ(repeatable(read_json(other / "report.json")), repeatable(read_json(one / "report.json")));
    for (const char* name : {"image.png", "image.exr", "report.txt", "config.yaml"}) {
      EXPECT_EQ(read_bytes(other / name), read_bytes(one / name)) << name;
    }
  }
  EXPECT_EQ(read_json(two / "report.json")["host"]["threads"], 2);
}

}  // namespace
}  // namespace test
