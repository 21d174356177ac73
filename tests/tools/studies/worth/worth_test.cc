#include "tools/studies/worth/worth.h"

#include <algorithm>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "sim/config/yaml_tree.h"
#include "sim/error.h"
#include "tests/tools/program.h"
#include "tools/host/build_info.h"
#include "tools/studies/sweep/spec/plan.h"

// raywatt worth: its file, its sentence, and the verb on spaces of a few machines.

namespace test {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;
using namespace tools::worth;

const std::string kHead = "schema: raywatt-worth/1\nfeature: a second box tester\n";
const std::string kSides = "without: {sets: [tni.trv.box_testers=1]}\nwith: {sets: [tni.trv.box_testers=2]}\n";
const std::string kSpace = "resolution: 16x16\naxes: {cores: [1, 2], tni.trvs: [1, 2]}\nbudget: 4\n";

WorthFile read(const std::string& lines) {
  const TempFolder folder;
  return read_worth_file(folder.write("worth.yaml", lines));
}

std::string complaint(const std::string& lines) {
  try {
    read(lines);
  } catch (const sim::InputError& error) {
    return error.what();
  }
  return {};
}

TEST(WorthFile, BothSidesAreTheSearchWithTheirChanges) {
  const WorthFile file = read(kHead +
                              "question: Is it?\nsets: [cores=3]\nprogram: full:1\nconstraints: [perf.fps > 1]\n"
                              "without: {sets: [tni.trvs=2]}\n"
                              "with: {program: multirate:under, constraints: [perf.fps > 2], axes: {l2.size: [64 KiB], "
                              "cores: [1]}}\n" +
                              kSpace);
  EXPECT_EQ(file.feature, "a second box tester");
  EXPECT_EQ(file.question, "Is it?");
  const tools::optimise::Task &without = file[Side::kWithout].task, &with = file[Side::kWith].task;
  EXPECT_EQ(without.space.sets, (Words{"frame.start=warm", "cores=3", "tni.trvs=2"}));
  EXPECT_EQ(with.space.sets, (Words{"frame.start=warm", "cores=3"}));
  EXPECT_EQ(without.space.program, "full:1");
  EXPECT_EQ(with.space.program, "multirate:under");
  ASSERT_EQ(without.goals.size(), 2U);
  ASSERT_EQ(with.goals.size(), 3U);
  EXPECT_EQ(without.goals[0].text(), "min area_mm2");
  EXPECT_EQ(with.goals[2].text(), "perf.fps > 2");
  ASSERT_EQ(with.space.axes.size(), 3U);
  EXPECT_EQ(with.space.axes[0].values.size(), 1U) << "cores: replaced";
  EXPECT_EQ(with.space.axes[2].name, "l2.size");
  EXPECT_EQ(without.budget, 4U);
}

TEST(WorthFile, TheTextOfASideIsTheFileOfItsSearch) {
  const WorthFile file = read(kHead + kSides + "scene: teapot\nconstraints: ['perf.fps > 1']\n" + kSpace);
  for (const SideSearch& side : file.sides) {
    const tools::optimise::Task again =
        tools::optimise::parse_task(*sim::parse_yaml_mapping(side.text, "again"), "again");
    EXPECT_EQ(again.space.sets, side.task.space.sets);
    EXPECT_EQ(again.space.scene, "teapot");
    EXPECT_EQ(again.goals.size(), side.task.goals.size());
    EXPECT_EQ(again.space.axes.size(), side.task.space.axes.size());
    EXPECT_TRUE(side.text.starts_with("schema: raywatt-optimise/1\n")) << side.text;
  }
}

TEST(WorthFile, RefusesWhatIsMissingOrUnknownWithItsPlace) {
  const auto refused = [](const std::string& lines, const Words& parts) {
    const std::string text = complaint(lines);
    for (const std::string& part : parts) EXPECT_NE(text.find(part), std::string::npos) << text << "\nlacks " << part;
  };
  refused("schema: raywatt-optimise/1\n" + kSpace, {"schema: raywatt-worth/1"});
  refused("schema: raywatt-worth/1\n" + kSides + kSpace, {"has no feature"});
  refused(kHead + "with: {program: full:1}\n" + kSpace, {"has no 'without'"});
  refused(kHead + "without: {program: full:1}\n" + kSpace, {"has no 'with'"});
  refused(kHead + "without: {scene: teapot}\nwith: {program: full:1}\n" + kSpace, {":3:11", "scene", "allowed"});
  refused(kHead + "without: {program: ful:1}\nwith: {program: full:1}\n" + kSpace, {":3:20", "ful:1"});
  refused(kHead + kSides + "sets: [x=1]\n" + "bugdet: 4\n" + kSpace, {":6:1", "bugdet", "did you mean 'budget'"});
  refused(kHead + "sets: [cores=1]\nwithout: {sets: cores=1}\nwith: {sets: [cores=2]}\n" + kSpace,
          {":4:17", "form of the search's 'sets'"});
  refused(kHead + kSides + "objectives: [{min: area_mm2}, {max: perf.fps}]\n" + kSpace, {"two objectives"});
}

TEST(WorthFile, ShippedOnesAreQuestionsOverPossibleMachines) {
  const fs::path folder = fs::path(tools::build_info().source_dir) / "configs/worth";
  std::size_t files = 0;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const WorthFile file = read_worth_file(entry.path());
    EXPECT_TRUE(file.question.ends_with("?")) << entry.path();
    ++files;
    for (const SideSearch& side : file.sides) {
      const std::vector<tools::sweep::Point> points = tools::sweep::plan_points(side.task.space, folder);
      EXPECT_GE(points.size(), 2 * side.task.budget) << entry.path() << ": a search is worth it";
      EXPECT_LE(points.size(), 200U) << entry.path() << ": --check takes minutes";
      for (const tools::sweep::Point& point : points) EXPECT_EQ(point.error, "") << entry.path();
    }
  }
  EXPECT_EQ(files, 4U);
}

Machine machine_of(const sim::Band& area) {
  Machine machine;
  machine.axes = {{"cores", "2"}};
  machine.objective = area.nominal;
  machine.objective_band = area;
  WorkloadResult& workload = machine.workloads.emplace_back();
  workload.name = "chess";
  workload.resolution = "512x256";
  workload.fps = 61;
  workload.target_fps = 60;
  workload.energy_mj = {1, 2, 4};
  workload.power_w = {0.5, 1, 2};
  workload.rooms = {{"fps_margin >= 1", "1.7 %", 1.017, 0.017}};
  return machine;
}

Answer answer_of(const std::optional<Machine>& without, const std::optional<Machine>& with) {
  Answer answer{read(kHead + kSides + "constraints: [fps_margin >= 1]\n" + kSpace), {}};
  answer.file.feature = "adaptive sampling";
  answer.sides[0].best = without;
  answer.sides[1].best = with;
  return answer;
}

TEST(Worth, IsTheShareSavedUnderTheSameTables) {
  const sim::Band share = saved_share(machine_of({10, 20, 40}), machine_of({6, 15, 32}), true);
  EXPECT_DOUBLE_EQ(share.low, 0.4);
  EXPECT_DOUBLE_EQ(share.nominal, 0.25);
  EXPECT_DOUBLE_EQ(share.high, 0.2);
  EXPECT_DOUBLE_EQ(saved_share(machine_of({10, 20, 40}), machine_of({6, 15, 32}), false).nominal, -0.25);
}

TEST(Worth, IsSaidInOneSentence) {
  const Machine large = machine_of({10, 20, 40}), small = machine_of({6, 15, 32});
  EXPECT_EQ(worth_sentence(answer_of(large, small)),
            "Adaptive sampling saves 5 mm2 of die area (25 %, band 20 to 40 %) at 60 frames/s on chess (512x256): 15 "
            "mm2 with it, "
            "20 mm2 without.");
  EXPECT_EQ(worth_sentence(answer_of(small, large)),
            "Adaptive sampling costs 5 mm2 of die area (33 %, band 25 to 67 %) at 60 frames/s on chess (512x256): 20 "
            "mm2 with it, "
            "15 mm2 without.");
  EXPECT_SAYS(worth_sentence(answer_of(large, large)), "saves nothing in this space");
  EXPECT_SAYS(worth_sentence(answer_of({}, large)), "Only with adaptive sampling");
  EXPECT_SAYS(worth_sentence(answer_of(large, {})), "With adaptive sampling no machine meets");
  EXPECT_SAYS(worth_sentence(answer_of({}, {})), "No machine of either space");
}

TEST(Worth, ShowsBothMachinesAndLeavesCellsOfAMissingOneEmpty) {
  const Machine large = machine_of({10, 20, 40}), small = machine_of({6, 15, 32});
  const std::string text = worth_text(answer_of(large, small));
  for (const char* part : {"area_mm2", "-25.0 %", "-40 to -20 %", "W at 60 frames/s", "room to fps_margin >= 1",
                           "constraints: fps_margin >= 1"})
    EXPECT_SAYS(text, part);
  EXPECT_EQ(worth_text(answer_of({}, small)).find("-25.0 %"), std::string::npos);
  EXPECT_TRUE(worth_json(answer_of({}, small))["without"]["best"].is_null());
  EXPECT_EQ(worth_json(answer_of(large, small))["saved_share"]["nominal"], 0.25);
}

TEST(Worth, IsConfirmedIfAllMachinesHaveNoneThatIsTwoPercentBetter) {
  SideAnswer side;
  EXPECT_TRUE(is_confirmed(side)) << "nothing was checked";
  side.best = machine_of({1, 10.1, 20});
  side.all = {4, 10};
  EXPECT_TRUE(is_confirmed(side));
  EXPECT_NEAR(search_error(side).value(), 0.01, 1e-12);
  side.all->objective = 9.8;
  EXPECT_FALSE(is_confirmed(side));
  side.best.reset();
  EXPECT_FALSE(is_confirmed(side)) << "the search found none, but there is one";
  side.all->objective.reset();
  EXPECT_TRUE(is_confirmed(side));
}

struct WorthVerb : testing::Test {
  TempFolder folder;
  fs::path out = folder.path() / "out";

  ProcessResult run(const std::string& lines, const Words& more = {}) const {
    Words words = {"worth",   folder.write("worth.yaml", lines).string(), "-o", out.string(),
                   "--store", (folder.path() / "store").string()};
    words.insert(words.end(), more.begin(), more.end());
    return raywatt(words);
  }
};

TEST_F(WorthVerb, FindsTheSmallestMachinesAndTheirDifference) {
  const ProcessResult ending = run(kHead + kSides + "constraints: [perf.fps > 1]\n" + kSpace, {"--check", "-j", "1"});
  ASSERT_EQ(ending.exit, 0) << ending.out << ending.err;
  EXPECT_SAYS(ending.out, "A second box tester costs ");
  EXPECT_SAYS(ending.out, "check, with: the best of all machines has area_mm2");
  const Json json = read_json(out / "worth.json");
  EXPECT_EQ(json["schema"], "raywatt-worth-result/1");
  std::vector<double> areas;
  for (const char* side : {"without", "with"}) {
    SCOPED_TRACE(side);
    const Json& best = json[side]["best"];
    EXPECT_EQ(best["axes"], (Json{{"cores", "1"}, {"tni.trvs", "1"}}));
    EXPECT_EQ(json[side]["all"]["machines"], 4);
    EXPECT_EQ(json[side]["all"]["search_error"], 0);
    EXPECT_EQ(json[side]["machines"], 4);
    areas.push_back(best["area_mm2"]["nominal"]);
    EXPECT_EQ(json[side]["all"]["area_mm2"], areas.back());
    EXPECT_GT(best["workloads"][0]["room"]["perf.fps > 1"], 0);
    EXPECT_TRUE(fs::exists(out / side / "history.jsonl"));
  }
  EXPECT_DOUBLE_EQ(json["difference"].get<double>(), areas[1] - areas[0]);
  EXPECT_NEAR(json["saved_share"]["nominal"].get<double>(), 1 - areas[1] / areas[0], 1e-12);
  EXPECT_LT(json["saved_share"]["nominal"], 0);

  const ProcessResult again = run(kHead + kSides + "constraints: [perf.fps > 1]\n" + kSpace, {"--json", "-j", "2"});
  ASSERT_EQ(again.exit, 0) << again.err;
  Json without_check = json;
  for (const char* side : {"without", "with"}) without_check[side].erase("all");
  EXPECT_EQ(Json::parse(again.out), without_check) << "for any number of workers";
}

TEST_F(WorthVerb, ChecksAgainstEveryMachine) {
  const ProcessResult ending = run(kHead + kSides + "constraints: [perf.fps > 1]\nresolution: 16x16\nbatch: 1\n" +
                                       "axes: {cores: [1, 2, 3, 4], tni.trvs: [1, 2, 4]}\nbudget: 8\n",
                                   {"--check", "--json"});
  ASSERT_EQ(ending.exit, 0) << ending.err;
  const Json json = Json::parse(ending.out);
  EXPECT_LT(json["with"]["machines"], 12) << "a search ends early";
  EXPECT_EQ(json["with"]["all"]["machines"], 12);
}

TEST_F(WorthVerb, TakesTheRateAndAnObjectiveOfItsOwn) {
  const ProcessResult ending =
      run(kHead + kSides + "constraints: [fps_margin >= 1]\nobjectives: [{min: power_at_fps_w}]\n" + kSpace,
          {"--fps", "100", "--json"});
  ASSERT_EQ(ending.exit, 0) << ending.out << ending.err;
  const Json json = Json::parse(ending.out);
  const Json& workload = json["with"]["best"]["workloads"][0];
  EXPECT_EQ(workload["target_fps"], 100);
  EXPECT_EQ(workload["power_at_fps_w"], json["with"]["best"]["power_at_fps_w"]) << json.dump(1);
  EXPECT_SAYS(json["answer"].get<std::string>(), " at 100 frames/s on cornell (16x16)");
}

TEST_F(WorthVerb, WritesAPageOfBothMachines) {
  fs::create_directories(folder.path() / "scripts/report_page");
  for (const char* name : {"page.js", "libraries.js", "page.css"})
    folder.write(std::string("scripts/report_page/") + name, "/* */");
  const fs::path page = folder.path() / "both.html";
  const Words words = {"worth",   folder.write("worth.yaml", kHead + kSides + kSpace).string(),
                       "-o",      out.string(),
                       "--store", (folder.path() / "store").string(),
                       "--page",  page.string(),
                       "--quiet"};
  const ProcessResult ending = raywatt(words, {.variables = {{"RAYWATT_PATH", (folder.path() / "scripts").string()}}});
  ASSERT_EQ(ending.exit, 0) << ending.err;
  EXPECT_EQ(ending.out, "");
  EXPECT_SAYS(read_bytes(page), "tni.trv.box_testers");
  EXPECT_SAYS(read_bytes(page), "with against without");

  folder.write("worth.yaml", kHead + kSides + "workloads: [cornell, teapot]\n" + kSpace);
  fs::remove(page);
  ASSERT_EQ(raywatt(words, {.variables = {{"RAYWATT_PATH", (folder.path() / "scripts").string()}}}).exit, 0);
  EXPECT_FALSE(fs::exists(page));
  for (const char* workload : {"cornell", "teapot"})
    EXPECT_SAYS(read_bytes(folder.path() / fmt::format("both-{}.html", workload)), workload);
}

TEST_F(WorthVerb, WithoutAFeasibleMachineEndsWithOne) {
  const ProcessResult none = run(kHead + kSides + "constraints: [perf.fps > 1e9]\n" + kSpace);
  EXPECT_EQ(none.exit, 1);
  EXPECT_SAYS(none.out, "No machine of either space meets the constraints");
  const ProcessResult one =
      run(kHead + "without: {constraints: [perf.fps > 1e9]}\nwith: {sets: [tni.trv.box_testers=2]}\n" + kSpace);
  EXPECT_EQ(one.exit, 0) << one.err;
  EXPECT_SAYS(one.out, "Only with a second box tester");
}

TEST_F(WorthVerb, RefusesForeignFoldersUnknownNamesAndSpacesTooLargeToCheck) {
  fs::create_directories(out);
  folder.write("out/other.txt", "");
  expect_refusal(run(kHead + kSides + kSpace), {"out", "holds other files"});
  expect_refusal(raywatt({"worth", "adaptive-samplin"}), {"adaptive-samplin", "did you mean 'adaptive-sampling'"});
  fs::remove_all(out);
  const std::string large =
      "axes: {cores: {from: 1, to: 64, step: 1}, tni.trvs: {from: 1, to: 64, step: 1}, tni.trv.rays: [8, 16]}\n";
  expect_refusal(run(kHead + kSides + large, {"--check"}), {"--check simulates all 8192 machines"});
  EXPECT_FALSE(fs::exists(out));
}

}  // namespace
}  // namespace test
