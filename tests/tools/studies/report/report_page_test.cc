#include <filesystem>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "sim/error.h"
#include "sim/io/json.h"
#include "tests/tools/program.h"
#include "tools/studies/report/report.h"
#include "traces/scene/images.h"

// Tests of the data in pages, and of errors of `raywatt report`. tests/page has the tests of what pages show.

namespace test {
namespace {

using Json = nlohmann::json;
namespace fs = std::filesystem;

/// Test inputs, made once: two small runs, a sweep, and page scripts that do nothing.
class Pages : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder = new TempFolder;
    for (const char* name : {"page.js", "libraries.js", "page.css"}) {
      fs::create_directories(folder->path() / "scripts/report_page");
      folder->write(std::string("scripts/report_page/") + name, std::string("/* ") + name + " */");
    }
    const Words small = {"--resolution", "32x16", "--set", "scene.triangles=500"};
    Words base = {"run", "--quiet", "--threads", "1", "-o", "base"},
          ports = {"run", "--quiet", "--threads", "1", "-o", "ports"};
    base.insert(base.end(), small.begin(), small.end());
    ports.insert(ports.end(), small.begin(), small.end());
    ports.insert(ports.end(), {"--set", "tni.trvs=2"});
    ASSERT_EQ(in_folder(base).exit, 0);
    ASSERT_EQ(in_folder(ports).exit, 0);
    folder->write("sweep.yaml",
                  "schema: raywatt-sweep/1\nresolution: 16x16\nsets: [scene.triangles=500]\naxes: {cores: [1, 2], "
                  "tni.trvs: [1, 2]}\n");
    ASSERT_EQ(in_folder({"sweep", "run", "sweep.yaml", "-o", "sweep", "--store", "store", "-j", "1"}).exit, 0);
  }
  static void TearDownTestSuite() {
    delete folder;
    folder = nullptr;
  }
  static ProcessResult in_folder(const Words& words) {
    return raywatt(words,
                   {.folder = folder->path(), .variables = {{"RAYWATT_PATH", (folder->path() / "scripts").string()}}});
  }
  /// Returns the text of a page.
  static std::string page_of(Words what) {
    what.insert(what.begin(), "report");
    what.insert(what.end(), {"-o", "page.html", "--force"});
    const ProcessResult ending = in_folder(what);
    EXPECT_EQ(ending.exit, 0) << ending.err;
    return read_bytes(folder->path() / "page.html");
  }
  static Json data_in(const std::string& html) {
    const std::string begin = R"(<script type="application/json" id="data">)";
    const std::size_t at = html.find(begin) + begin.size();
    return Json::parse(html.substr(at, html.find("</script>", at) - at))["data"];
  }
  static Json data_of(const Words& what) { return data_in(page_of(what)); }
  /// Values of a metric of a sweep, by point.
  static std::vector<double> metric_of(const Json& data, const std::string& field) {
    std::size_t column = 2 + data["axes"].size();
    for (const Json& metric : data["metrics"]) {
      if (metric["field"] == field) break;
      ++column;
    }
    std::vector<double> values;
    for (const Json& point : data["points"]) values.push_back(point[column].get<double>());
    return values;
  }
  static TempFolder* folder;
};
TempFolder* Pages::folder = nullptr;

TEST_F(Pages, OfARunShowTheWholeEnergy) {
  const Json energy = read_json(folder->path() / "base/report.json")["totals"]["energy_mj"];
  const Json flow = data_of({"base"})["flow"];
  std::size_t column = 2;
  for (const char* side : {"low", "nominal", "high"}) {
    double blocks = 0, ends = 0;
    for (const Json& link : flow) (link[0] == "GPU with memory" ? blocks : ends) += link[column].get<double>();
    ++column;
    EXPECT_NEAR(blocks / energy[side].get<double>(), 1, 1e-9) << side;
    EXPECT_NEAR(ends / energy[side].get<double>(), 1, 1e-9) << side;
  }
}

TEST_F(Pages, OfARunNameTheBoundOfEachKernel) {
  const Json kernels = data_of({"base"})["kernels"];
  EXPECT_FALSE(kernels.empty());
  for (const Json& kernel : kernels) EXPECT_TRUE(kernel["bound"].is_string());
}

TEST_F(Pages, OfSeveralFramesHaveDebugPicturesOfTheFirst) {
  ASSERT_EQ(in_folder({"run", "--scene", "chess", "--set", "scene.triangles=500", "--resolution", "16x16", "--quiet",
                       "--program", "multirate:under", "--frames", "1:2", "--debug-images", "-o", "frames"})
                .exit,
            0);
  EXPECT_SAYS(data_of({"frames"})["picture"]["debug"].dump(), "\"name\":\"similar\"");
}

TEST_F(Pages, OfTwoRunsMapTheDifferencesOfBothTables) {
  const Json block = data_of({"base", "ports"})["pictures"][0];
  const auto cycles = [](const char* run) {
    const Json columns = read_json(folder->path() / run / "tiles.json")["frames"][0]["columns"];
    return columns["finished"][0].get<double>() - columns["dispatched"][0].get<double>();
  };
  const Json& grid = block["grids"][0];
  EXPECT_EQ(grid["id"], "cycles");
  EXPECT_EQ(grid["values"][0], cycles("ports") - cycles("base"));
  EXPECT_EQ(grid["of"][0][0], cycles("base"));
  EXPECT_EQ(grid["of"][1][0], cycles("ports"));
  EXPECT_EQ(grid["low"].get<double>(), -grid["high"].get<double>());
  EXPECT_SAYS(block["note"].get<std::string>(), "Equal in every tile: rays of a tile, steps of a tile");
}

TEST_F(Pages, OfTwoRunsExplainWhyTilesAreNotCompared) {
  const fs::path other = folder->path() / "other";
  fs::create_directories(other);
  for (const char* file : {"report.json", "image.png"})
    fs::copy_file(folder->path() / "ports" / file, other / file, fs::copy_options::overwrite_existing);
  EXPECT_SAYS(data_of({"base", "other"})["pictures"][0]["note"].get<std::string>(), "other has no tiles.json");
  Json tiles = read_json(folder->path() / "ports/tiles.json");
  for (const char* side : {"width", "height"}) tiles["frames"][0]["columns"][side][0] = 16;
  folder->write("other/tiles.json", tiles.dump());
  EXPECT_SAYS(data_of({"base", "other"})["pictures"][0]["note"].get<std::string>(),
              "base has tiles of 32 pixels, other of 16");
  folder->write("other/tiles.json", "{\"schema\": 3}");
  EXPECT_SAYS(data_of({"base", "other"})["pictures"][0]["note"].get<std::string>(), "is no tiles.json");
}

TEST_F(Pages, OfAnAnimationHaveThePictureOfEveryFrame) {
  ASSERT_EQ(in_folder({"run", "--scene", "chess", "--set", "scene.triangles=500", "--resolution", "16x16", "--quiet",
                       "--frames", "1:3", "--reference", "full:4", "-o", "film"})
                .exit,
            0);
  const std::string page = page_of({"film"});
  const Json data = data_in(page), &frames = data["film"]["frames"];
  ASSERT_EQ(frames.size(), 3U);
  for (int f = 0; f < 3; ++f) {
    EXPECT_EQ(frames[f]["frame"], f + 1);
    EXPECT_SAYS(frames[f]["picture"].get<std::string>(), "picture:") << "stored after the script";
    EXPECT_SAYS(page, tools::pages::data_url("image/png",
                                             read_bytes(folder->path() / fmt::format("film/frame-000{}.png", f + 1))));
  }
  EXPECT_EQ(data["film"]["note"], "");
  EXPECT_EQ(data["report"]["frames"][1]["temporal_psnr_db"],
            read_json(folder->path() / "film/report.json")["frames"][1]["temporal_psnr_db"]);
  fs::remove(folder->path() / "film/frame-0002.png");
  EXPECT_EQ(data_of({"film"})["film"]["note"], "2 of 3 frames have a picture.");
  EXPECT_TRUE(data_of({"base"})["film"].is_null());
}

TEST_F(Pages, OfAReferenceShowItsPictureAndItsTiles) {
  ASSERT_EQ(
      in_folder({"run", "--resolution", "32x16", "--program", "multirate:under", "--reference", "full:1", "-o", "with"})
          .exit,
      0);
  const Json pair = data_of({"with/reference.json", "with"})["pictures"][0];
  EXPECT_NE(pair["a"], pair["b"]);
  EXPECT_SAYS(pair["grids"].dump(), "\"id\":\"cycles\"");
  const std::string alone = page_of({"with/reference.json"});
  EXPECT_SAYS(alone, tools::pages::data_url("image/png", read_bytes(folder->path() / "with/reference.png")));
  EXPECT_EQ(data_in(alone)["picture"]["grids"][0]["id"], "cycles");
}

TEST_F(Pages, OfDamagedFilesAreWrittenWithWarnings) {
  const fs::path run = folder->path() / "damaged";
  fs::copy(folder->path() / "base", run);
  folder->write("damaged/tiles.json", "{");
  folder->write("damaged/intervals.bin.zst", "no intervals");
  const ProcessResult one = in_folder({"report", "damaged", "-o", "damaged.html"});
  EXPECT_EQ(one.exit, 0) << one.err;
  EXPECT_SAYS(one.err, "raywatt: warning: damaged/tiles.json");
  EXPECT_SAYS(one.err, "raywatt: warning: damaged/intervals.bin.zst");
  folder->write("damaged/image.png", "no picture");
  const ProcessResult blank = in_folder({"report", "damaged", "-o", "blank.html"});
  EXPECT_EQ(blank.exit, 0) << blank.err;
  EXPECT_SAYS(blank.err, "raywatt: warning: damaged/image.png");
  const ProcessResult two = in_folder({"report", "base", "damaged", "-o", "damaged-diff.html"});
  EXPECT_EQ(two.exit, 0) << two.err;
  EXPECT_NE(two.err.find("the page compares no tiles"), std::string::npos) << two.err;
}

TEST_F(Pages, OfASweepHaveAPointPerRowWithItsCommand) {
  const Json points = data_of({"sweep"})["points"];
  ASSERT_EQ(points.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(points[i][2], i < 2 ? "1" : "2");
  EXPECT_SAYS(points[3].back().get<std::string>(), "--set tni.trvs=2");
}

TEST_F(Pages, OfASweepWithReplicatesShowMeans) {
  folder->write("noisy.yaml",
                "schema: raywatt-sweep/1\nresolution: 16x16\nreplicates: 3\nsets: [scene.triangles=500]\n"
                "axes: {cores: [1, 2]}\n");
  ASSERT_EQ(in_folder({"sweep", "run", "noisy.yaml", "-o", "noisy", "--store", "store", "-j", "1"}).exit, 0);
  const auto csv_column = [&](const char* path) {
    std::istringstream lines(in_folder({"sweep", "table", "noisy", "--csv", "--columns", path}).out);
    std::vector<double> values;
    std::string line;
    for (std::getline(lines, line); std::getline(lines, line);) values.push_back(std::stod(line));
    return values;
  };
  const std::vector<double> plain = csv_column("totals.cycles"),
                            means = csv_column("totals.replicates.figures.cycles.mean");
  const Json data = data_of({"noisy"});
  const std::vector<double> shown = metric_of(data, "totals.cycles");
  ASSERT_EQ(shown.size(), 2U);
  for (std::size_t i = 0; i < shown.size(); ++i) EXPECT_DOUBLE_EQ(shown[i], means[i]);
  EXPECT_NE(plain, means) << "else the test says nothing";
  EXPECT_SAYS(data["ties"].get<std::string>(), "with it (noise measured by 3 replicates per point)");
}

TEST_F(Pages, OfASearchHaveABestPointOnTheFront) {
  folder->write("ties.yaml",
                "schema: raywatt-optimise/1\nresolution: 16x16\nsets: [scene.triangles=500]\nbudget: 4\n"
                "axes: {cores: [4, 2, 1]}\nobjectives: [max: perf.fps, max: frames_per_joule_gpu]\n");
  ASSERT_EQ(in_folder({"optimise", "ties.yaml", "-o", "ties", "--store", "store", "-j", "1"}).exit, 0);
  const Json data = data_of({"ties"});
  const std::vector<double> fps = metric_of(data, "totals.perf.fps");
  ASSERT_EQ(std::set<double>(fps.begin(), fps.end()).size(), 1U) << "one tile, one core";
  EXPECT_EQ(data["points"][data["best"]["totals.perf.fps"].get<std::size_t>()][2], "1") << "one core";
}

TEST_F(Pages, OfASearchCountFeasiblePointsAndShowTheirLimits) {
  folder->write("limits.yaml",
                "schema: raywatt-optimise/1\nresolution: 16x16\nsets: [scene.triangles=500]\nbudget: 4\n"
                "axes: {cores: [1, 2], clocks.tni: [300 MHz]}\nobjectives: [min: area_mm2]\n"
                "constraints: [area_mm2 > 1, power_w < 100]\n");
  ASSERT_EQ(in_folder({"optimise", "limits.yaml", "-o", "limits", "--store", "store", "-j", "1"}).exit, 0);
  const Json data = data_of({"limits"});
  for (const Json& point : data["points"]) EXPECT_EQ(point[point.size() - 3], true) << "eligible";
  const Json limits = data["limits"];
  ASSERT_EQ(limits.size(), 2U);
  EXPECT_EQ(limits[0][0], "area_mm2 > 1");
  EXPECT_EQ(limits[1][0], "power_w < 100");
  for (const Json& limit : limits) EXPECT_EQ(limit[1], 2) << "points that meet it";
  const double power = limits[1][2].get<double>();
  EXPECT_EQ(limits[1][4], fmt::format("{:.1f} %", 100 - power)) << "a group means its nominal";
  EXPECT_SAYS(data["notices"].dump(), "power.dvfs: clocks.tni of 300 MHz");
  EXPECT_SAYS(data["notices"].back().get<std::string>(),
              "There are figures beyond what the tables cover, as warnings[] of the reports say: points 0, 1");
}

TEST_F(Pages, OfASearchOnSeveralWorkloadsHaveAPointPerMachineAndTheAnswer) {
  folder->write("set.yaml",
                "schema: raywatt-optimise/1\nquestion: Which is smallest?\nresolution: 16x16\nbudget: 6\n"
                "workloads: [cornell, teapot]\naxes: {cores: [1, 2], tni.trvs: [1, 2, 4]}\n"
                "objectives: [min: worst(energy_mj)]\nconstraints: [power_w < 100, cycles > 1]\n");
  ASSERT_EQ(in_folder({"optimise", "set.yaml", "-o", "set", "--store", "store", "-j", "1", "--check"}).exit, 0);
  const Json data = data_of({"set"});
  EXPECT_EQ(data["points"].size(), 6U);
  const Json search = data["search"];
  EXPECT_SAYS(search["sentence"].get<std::string>(), "has the least worst(energy_mj.nominal) of 6 machines");
  ASSERT_EQ(search["limits"].size(), 4U) << "two limits on two workloads";
  EXPECT_EQ(search["limits"][0][0], "cornell");
  EXPECT_EQ(search["limits"][3][0], "teapot");
  for (const Json& limit : search["limits"]) EXPECT_EQ(limit[6], "yes") << limit;
  EXPECT_EQ(search["scatter"]["x"], "power_w.nominal");
  EXPECT_EQ(search["scatter"]["rows"].size(), 6U);
  ASSERT_EQ(search["commands"].size(), 3U) << "a command per workload, and the check";
  EXPECT_EQ(search["commands"][2][1], "raywatt optimise set.yaml -o set --store store --check");
  EXPECT_EQ(search["checked"], true);
  EXPECT_GE(search["trades"]["rows"].size(), 2U);

  // A damaged file is named, and the page is that of the simulations.
  std::ofstream(folder->path() / "set/search.json") << R"({"schema": "raywatt-search/1", "goals": 3})";
  const Json damaged = data_of({"set"});
  EXPECT_FALSE(damaged.contains("search"));
  EXPECT_SAYS(damaged["notices"].dump(), "search.json");
}

TEST_F(Pages, AreTheSameBytesForTheSameRun) { EXPECT_EQ(page_of({"base"}), page_of({"base"})); }

TEST_F(Pages, EscapeAllNames) {
  Json report = read_json(folder->path() / "base/report.json");
  const std::string hostile = "</script><img src=x onerror=alert(1)><!--";
  report["scene"]["name"] = hostile;
  report["warnings"] = {hostile};
  report["config"][hostile] = hostile;
  fs::create_directories(folder->path() / "hostile");
  folder->write("hostile/report.json", report.dump());
  const std::string html = page_of({"hostile"});
  EXPECT_EQ(html.find("<img"), std::string::npos);
  EXPECT_EQ(html.find("<!--"), std::string::npos);
  EXPECT_EQ(data_in(html)["report"]["warnings"][0], hostile);
}

TEST_F(Pages, AllowOnlyTheirOwnScripts) {
  const std::string html = page_of({"base"});
  EXPECT_SAYS(html, "default-src &#39;none&#39;; script-src &#39;sha256-");
  EXPECT_EQ(html.find("unsafe"), std::string::npos);
}

TEST_F(Pages, RefuseInputsThatAreNoRunsOrOfMixedKinds) {
  fs::create_directories(folder->path() / "empty");
  expect_refusal(in_folder({"report", "empty", "-o", "x.html"}), {"holds no run, sweep or search", "report.json"});
  expect_refusal(in_folder({"report", "nowhere", "-o", "x.html"}), {"nowhere"});
  expect_refusal(in_folder({"report", "base", "sweep", "-o", "x.html"}), {"is a sweep", "allowed"});
  expect_refusal(in_folder({"report", "sweep", "sweep", "-o", "x.html"}), {"is a sweep", "allowed"});
  EXPECT_FALSE(fs::exists(folder->path() / "x.html"));
}

TEST_F(Pages, ReplaceOnlyPagesAndNoLinks) {
  folder->write("mine.html", "<p>mine</p>");
  expect_refusal(in_folder({"report", "base", "-o", "mine.html"}), {"mine.html"});
  EXPECT_EQ(read_bytes(folder->path() / "mine.html"), "<p>mine</p>");
  EXPECT_EQ(in_folder({"report", "base", "-o", "mine.html", "--force"}).exit, 0);
  EXPECT_EQ(in_folder({"report", "base", "-o", "mine.html"}).exit, 0) << "a page replaces a page";
  fs::create_symlink(folder->path() / "mine.html", folder->path() / "link.html");
  expect_refusal(in_folder({"report", "base", "-o", "link.html", "--force"}), {"link.html"});
  expect_refusal(in_folder({"report", "base", "-o", "base", "--force"}), {"base"});
}

TEST_F(Pages, ListWhatAReportLacks) {
  Json report = read_json(folder->path() / "base/report.json");
  for (const char* part : {"units", "config", "scene", "frames", "program", "resolution"}) report.erase(part);
  for (const char* part : {"top_down", "bottleneck", "kernels", "energy_by_block_mj", "area_band_mm2"})
    report["totals"].erase(part);
  fs::create_directories(folder->path() / "bare");
  folder->write("bare/report.json", report.dump());
  const Json data = data_of({"bare"});
  EXPECT_SAYS(data["picture"]["missing"].get<std::string>(), "no image.png");
  EXPECT_FALSE(data["not_priced"].get<std::string>().empty());
}

using namespace tools::pages;

/// Returns the table of two tiles of side 8 in a picture of 16x5. The second tile has two passes.
tools::TileFrame frame() {
  tools::TileFrame out;
  const auto add = [&](const char* name, std::vector<double> values) {
    out.columns.push_back({.name = name, .unit = "", .values = std::move(values)});
  };
  add("tile", {0, 1, 1});
  add("x", {0, 8, 8});
  add("y", {0, 0, 0});
  add("width", {8, 8, 8});
  add("dispatched", {0, 10, 100});
  add("finished", {7, 30, 1000});
  add("energy_mj_nominal", {1.0 / 3, 2, 3});
  return out;
}

const TileMetric& metric(const char* id) {
  return *std::ranges::find(tile_metrics(), std::string_view(id),
                            [](const TileMetric& each) { return std::string_view(each.id); });
}

TEST(TileMaps, SumTheRowsOfATile) {
  const tools::TileFrame tiles = frame();
  const TileGrid grid = tile_grid(tiles, 16, 5);
  EXPECT_EQ(grid.columns, 2U);
  EXPECT_EQ(grid.rows, 1U);
  EXPECT_EQ(tile_values(metric("cycles"), tiles, grid), (std::vector<double>{7, 20 + 900}));
  EXPECT_EQ(tile_values(metric("energy"), tiles, grid)[1], 5e6) << "nJ";
}

TEST(TileMaps, RefuseTilesOutsideThePictureAndTablesWithoutPlaces) {
  tools::TileFrame tiles = frame();
  EXPECT_THROW(tile_grid(tiles, 8, 5), sim::InputError);
  tiles.columns[1].values[0] = -1;
  EXPECT_THROW(tile_grid(tiles, 16, 5), sim::InputError);
  tiles.columns[1].values[0] = 1e300;
  EXPECT_THROW(tile_grid(tiles, 16, 5), sim::InputError);
  tiles = frame();
  tiles.columns[3].values = {0, 0, 0};
  EXPECT_THROW(tile_grid(tiles, 16, 5), sim::InputError) << "tiles without a width";
  tiles = frame();
  tiles.columns.erase(tiles.columns.begin() + 1);
  EXPECT_THROW(tile_grid(tiles, 16, 5), sim::InputError) << "a replay knows no places";
  EXPECT_THROW(tile_values(metric("steps"), frame(), tile_grid(frame(), 16, 5)), sim::InputError);
}

TEST(TileMaps, KeepWholeNumbersExactlyAndOthersInFiveDigits) {
  EXPECT_EQ(sim::json_line(rounded_for_page({123456789, -2, 0, 1.0 / 3, 123456.7})),
            "[123456789,-2,0,0.33333,123460.0]");
}

TEST(PagePictures, AreAveragedOverSquaresIfTooLarge) {
  const TempFolder folder;
  const std::vector<std::uint8_t> rgb = {10, 0, 0, 20, 0, 0, 100, 0, 5, 30, 0, 0, 40, 0, 0, 100, 0, 5};
  const auto file = folder.path() / "picture.png";
  traces::write_png(file, 3, 2, rgb);
  EXPECT_EQ(picture_as_data_url(file, 6), data_url("image/png", read_bytes(file))) << "one that fits is taken as it is";
  traces::Texture small;
  small.width = 2;
  small.height = 1;
  small.texels = {0xff000019, 0xff050064};  // mean of 10, 20, 30, 40; the right column alone
  EXPECT_EQ(picture_as_data_url(file, 5), data_url("image/png", traces::encode_png(small)));
  folder.write("text.png", "no picture");
  EXPECT_FALSE(picture_as_data_url(folder.path() / "text.png", 6));
  EXPECT_FALSE(picture_as_data_url(folder.path() / "none.png", 6));
}

}  // namespace
}  // namespace test
