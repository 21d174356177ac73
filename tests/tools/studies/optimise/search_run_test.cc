#include "tools/studies/optimise/search_run.h"

#include <algorithm>
#include <functional>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "sim/config/yaml_tree.h"
#include "sim/error.h"
#include "sim/io/file.h"
#include "sim/report/energy.h"
#include "tests/tools/program.h"
#include "tools/run/frame/machine_run.h"
#include "tools/studies/optimise/answer.h"
#include "tools/studies/optimise/trade.h"

// Searches over machines whose results are functions instead of simulations.

namespace test {
namespace {

using namespace tools::optimise;
using tools::sweep::Point;
using tools::sweep::PointStatus;
using Json = nlohmann::json;

/// Results of a machine: by its number of cores, and whether its frame was sampled.
struct Figures {
  double margin = 1, power_w = 1;
  double teapot_margin = 0;  ///< margin on the teapot; 0: as on other scenes
  int teapot_items = 0;      ///< items of a kernel that only the teapot has; 0: its report lacks the kernel
};
using Model = std::function<Figures(int cores, bool sampled)>;

int cores_of(const std::vector<std::pair<std::string, std::string>>& axes) {
  return std::stoi(std::ranges::find(axes, "cores", &std::pair<std::string, std::string>::first)->second);
}

/// Writes the reports of a model. The area is the real one, because searches know it.
class ModelLauncher : public tools::sweep::Launcher {
 public:
  ModelLauncher(const tools::sweep::Store& store, Model model) : Launcher(store, false), model_(std::move(model)) {}

 private:
  tools::sweep::BatchResult run_batch(std::span<const Point> points, const PointWatch& watch) override {
    tools::sweep::BatchResult end;
    for (std::size_t p = 0; p < points.size(); ++p) {
      const bool is_known = store_.is_done(points[p].id);
      if (!is_known) {
        const Json report = report_of(points[p]);
        store_.put_result(points[p].id, keys_.key_of(points[p]).made_of, [&](const std::filesystem::path& folder) {
          sim::write_file_atomically(folder / "report.json", report.dump());
          sim::write_file_atomically(folder / "config.yaml", "cores: 1\n");
        });
      }
      end.statuses.push_back(is_known ? PointStatus::kDone : PointStatus::kComputed);
      watch(p, end.statuses.back());
    }
    return end;
  }

  Json report_of(const Point& point) {
    const bool is_sampled = !point.tile_sampling.empty();
    const Figures figures = model_(cores_of(point.axes), is_sampled);
    const bool is_teapot = point.scene == "teapot" && figures.teapot_margin > 0;
    const tools::RunConfig& config = keys_.config_of(point);
    const double area =
        sim::compute_area(tools::idle_unit_reports(*config.gpu), config.energy, config.area).total.nominal;
    Json report = {{"schema", "raywatt-report/1"},
                   {"resolution", {1920, 1080}},
                   {"totals",
                    {{"cycles", 100},
                     {"area_mm2", area},
                     {"fps_margin", is_teapot ? figures.teapot_margin : figures.margin},
                     {"power_at_fps_w", {{"low", 1}, {"nominal", figures.power_w}, {"high", 3}}}}}};
    if (point.scene == "teapot" && figures.teapot_items != 0) {
      report["totals"]["kernels"]["shade_x"]["items"] = figures.teapot_items;
    }
    const Json interval = {{"estimate", 100}, {"low", 98}, {"high", 102}};
    if (is_sampled) report["totals"]["sampled"] = {{"cycles", interval}, {"energy_mj", interval}};
    return report;
  }

  const Model model_;
  tools::sweep::PointKeys keys_;
};

const std::string kSixteen = "{cores: [1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16]}";

struct SearchOfModel : testing::Test {
  TempFolder folder;
  tools::sweep::Store store{folder.path() / "store"};
  SearchRun::Hooks hooks{[](const std::vector<Point>&) {}, [](std::size_t, PointStatus) {}};

  static Task task_of(const std::string& lines) {
    return parse_task(
        *sim::parse_yaml_mapping("schema: raywatt-optimise/1\nresolution: 1920x1080\nsets: [frame.fps=60]\n" + lines,
                                 "search.yaml"),
        "search.yaml");
  }
  /// Runs a search and returns the number of cores of each machine on its front.
  std::vector<int> run(SearchRun& search, const Model& model, bool check = false) {
    ModelLauncher launcher(store, model);
    EXPECT_TRUE(search.run(launcher, store, hooks));
    EXPECT_TRUE(!check || search.check_front(launcher, store, hooks));
    std::vector<int> cores;
    for (const Trial* trial : search.pareto_front()) cores.push_back(cores_of(trial->axes));
    return cores;
  }
};

TEST_F(SearchOfModel, ContinuesAfterWholeFramesRejectTheBestMachine) {
  SearchRun search(task_of("axes: " + kSixteen + "\nobjectives: [min: area_mm2]\nconstraints: [fps_margin >= 1]\n" +
                           "fidelity: tiles\nbudget: 16\n"),
                   folder.path());
  // Samples of machines with 4 to 8 cores are too optimistic.
  const std::vector<int> best = run(search, [](int cores, bool sampled) {
    return Figures{cores >= 9 ? 1.2 : cores < 4 ? 0.5 : sampled ? 1.01 : 0.97, 1};
  });
  ASSERT_EQ(best, (std::vector<int>{9}));
  EXPECT_FALSE(search.pareto_front().front()->is_sampled()) << "the answer is a whole frame";
}

TEST_F(SearchOfModel, SimulatesWholeFramesOfMachinesThatMissALimitWithinTheNoise) {
  SearchRun search(task_of("axes: " + kSixteen + "\nobjectives: [min: area_mm2]\nconstraints: [fps_margin >= 1]\n" +
                           "fidelity: tiles\nbudget: 16\n"),
                   folder.path());
  const std::vector<int> best = run(search, [](int cores, bool sampled) {
    return Figures{cores >= 6 ? 1.2 : cores < 5 ? 0.5 : sampled ? 0.998 : 1.003, 1};
  });
  EXPECT_EQ(best, (std::vector<int>{5}));
}

TEST_F(SearchOfModel, ChecksMachinesThatEnterTheFrontAfterACheck) {
  SearchRun search(task_of("axes: " + kSixteen + "\nobjectives: [min: area_mm2, min: power_at_fps_w]\n" +
                           "constraints: [fps_margin >= 1]\nfidelity: tiles\nbudget: 16\n"),
                   folder.path());
  // By whole frames every second machine breaks the limit, and those above 8 cores need more power than 8 cores.
  const std::vector<int> front = run(
      search,
      [](int cores, bool sampled) {
        return Figures{sampled || cores % 2 == 0 ? 1.2 : 0.8, cores > 8 && !sampled ? 3.0 : 2 - 0.1 * cores};
      },
      true);
  EXPECT_EQ(front, (std::vector<int>{2, 4, 6, 8}));
  for (const Trial* trial : search.pareto_front()) EXPECT_FALSE(trial->is_sampled());
}

TEST_F(SearchOfModel, OffersNoWiderLimitForAMachineThatBreaksTwo) {
  const std::string lines = "axes: {cores: [3, 4]}\nobjectives: [min: area_mm2]\nfidelity: full\nbudget: 4\n" +
                            std::string("constraints: [fps_margin >= 1, power_at_fps_w < 2]\n");
  for (const bool breaks_power : {false, true}) {
    SCOPED_TRACE(breaks_power);
    SearchRun search(task_of(lines), folder.path());
    store = tools::sweep::Store(folder.path() / (breaks_power ? "two" : "one"));
    const std::vector<int> best = run(search, [&](int cores, bool) {
      return cores == 4 ? Figures{1.1, 1} : Figures{0.9, breaks_power ? 2.02 : 1.5};
    });
    ASSERT_EQ(best, (std::vector<int>{4}));
    const Trial& four = *search.pareto_front().front();
    std::string all;
    for (const std::string& sentence : trade_sentences(search, four, trades_of(search, four))) all += sentence + "\n";
    EXPECT_EQ(all.find("would allow") == std::string::npos, breaks_power) << all;
  }
}

TEST_F(SearchOfModel, NamesTheWorkloadOfALimitThatHasOne) {
  // A margin of 2 on cornell, and of 1 on teapot.
  const std::vector<std::pair<std::string, std::string>> limits = {
      {"worst(fps_margin) < 3", "teapot"}, {"mean(fps_margin) < 3", ""},  {"geomean(fps_margin) > 0.5", ""},
      {"fps_margin > 0.5", "teapot"},      {"fps_margin < 3", "cornell"}, {"on(cornell, fps_margin) > 0.5", "cornell"},
      {"area_mm2 < 1000000", ""}};
  for (const auto& [limit, workload] : limits) {
    SCOPED_TRACE(limit);
    SearchRun search(task_of("workloads: [cornell, teapot]\naxes: {cores: [3, 4]}\nobjectives: [min: area_mm2]\n"
                             "fidelity: full\nbudget: 4\nconstraints: ['" +
                             limit + "']\n"),
                     folder.path());
    ASSERT_EQ(run(search, [](int, bool) { return Figures{2, 1, 1}; }), (std::vector<int>{3}));
    EXPECT_EQ(binding_workload(search, *search.pareto_front().front(), 1), workload);
    const Answer answer{.search = search};
    const bool has_one = limit.starts_with("fps") || limit.starts_with("on") || limit.starts_with("area");
    EXPECT_EQ(answer_text(answer).find(" yes") != std::string::npos, has_one) << answer_text(answer);
  }
}

TEST_F(SearchOfModel, NamesTheLimitThatANeighbourMissesByConfidenceAlone) {
  SearchRun search(task_of("axes: {cores: [3, 4]}\nobjectives: [min: area_mm2]\nconstraints: [fps_margin >= 1]\n"
                           "fidelity: full\nconfidence: 0.9\nbudget: 4\n"),
                   folder.path());
  ASSERT_EQ(run(search, [](int cores, bool) { return Figures{cores == 4 ? 1.5 : 1.0001, 1}; }), (std::vector<int>{4}));
  const std::vector<Trade> trades = trades_of(search, *search.pareto_front().front());
  ASSERT_EQ(trades.size(), 1U);
  EXPECT_EQ(trades[0].values[1], 1.0001) << "the nominal value is shown";
  EXPECT_EQ(trades[0].breaks, 1U);
  EXPECT_LT(trades[0].reached, 1);
  EXPECT_FALSE(trades[0].is_feasible);
}

TEST_F(SearchOfModel, KnowsFullPathsAndDirectionsBeforeTheFirstSimulation) {
  const SearchRun search(task_of("workloads: [cornell, teapot]\naxes: {cores: [3, 4]}\nobjectives: [min: area_mm2]\n"
                                 "constraints: [worst(fps) < 100, kernels.shade_diffuse.cycles < 9]\nbudget: 4\n"),
                         folder.path());
  EXPECT_EQ(search.goals()[0].metric, "totals.area_mm2");
  EXPECT_EQ(search.goals()[1].metric, "totals.perf.fps");
  EXPECT_TRUE(search.goals()[1].is_larger_better()) << "the direction of the metric, not of its limit";
  EXPECT_FALSE(search.goals()[1].applies_to_each_workload());
  EXPECT_EQ(search.goals()[2].metric, "kernels.shade_diffuse.cycles") << "scenes decide which kernels there are";
}

TEST_F(SearchOfModel, FailsOnlyTheRunsThatLackAMetricOfTheirWorkload) {
  SearchRun search(task_of("workloads: [cornell, teapot]\naxes: {cores: [3, 4]}\nfidelity: full\nbudget: 4\n"
                           "objectives: [min: 'on(teapot, power_at_fps_w)']\n"
                           "constraints: ['on(teapot, shade_x.items) > 5']\n"),
                   folder.path());
  EXPECT_EQ(search.goals()[1].metric, "shade_x.items") << "scenes decide which kernels there are";
  const std::vector<int> best = run(
      search, [](int cores, bool) { return Figures{.margin = 1, .power_w = 1, .teapot_items = cores == 3 ? 10 : 0}; });
  EXPECT_EQ(best, (std::vector<int>{3}));
  EXPECT_EQ(search.goals()[1].metric, "totals.kernels.shade_x.items");
  for (const Trial& trial : search.trials()) {
    if (cores_of(trial.axes) != 4) continue;
    EXPECT_EQ(trial.status, PointStatus::kFailed);
    EXPECT_EQ(trial.error, "teapot: its report has no totals.kernels.shade_x.items");
  }
}

TEST_F(SearchOfModel, RefusesAMetricThatNoReportOfItsWorkloadHas) {
  SearchRun search(
      task_of("axes: {cores: [3, 4]}\nfidelity: full\nbudget: 4\nobjectives: [min: kernels.none.cycles]\n"),
      folder.path());
  EXPECT_THROW(run(search, [](int, bool) { return Figures{}; }), sim::InputError);
}

TEST_F(SearchOfModel, SimulatesEveryMachineOnRequest) {
  Task task = task_of("axes: " + kSixteen + "\nobjectives: [min: area_mm2]\nfidelity: full\nbudget: 16\n");
  SearchRun search(task, folder.path());
  const Model model = [](int, bool) { return Figures{}; };
  EXPECT_EQ(run(search, model), (std::vector<int>{1}));
  EXPECT_LT(search.simulated_count(), 16U) << "the area of a machine is known before";
  task.simulates_all = true;
  SearchRun all(task, folder.path());
  EXPECT_EQ(run(all, model), (std::vector<int>{1}));
  EXPECT_EQ(all.simulated_count(), 16U);
}

TEST_F(SearchOfModel, NamesAllStartsOfItsFrames) {
  SearchRun search(task_of("axes: {cores: [1, 2], frame.start: [warm, cold]}\nobjectives: [min: area_mm2]\n"
                           "fidelity: full\n"),
                   folder.path());
  EXPECT_EQ(search.fidelity_text(), "whole frames of 1920x1080, cold or warm start");
}

}  // namespace
}  // namespace test
