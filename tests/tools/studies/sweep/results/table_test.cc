#include <array>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "sim/error.h"
#include "tests/tools/program.h"
#include "tests/tools/studies/sweep/results/made_sweep.h"
#include "tools/studies/sweep/results/results.h"

// Tests of `raywatt sweep table`.

namespace test {
namespace {

using tools::results::TableOptions;

/// A sweep with sizes in random order, whose last point has failed.
struct FourRows : MadeSweep {
  FourRows() {
    for (const char* size : {"16 KiB", "4 KiB", "1 MiB", "8 KiB"}) add({{"l1.size", size}, {"trvs", "4"}});
    finish(0, 3000);
    finish(1, 1000);
    finish(2, 2000);
    fail(3, "stuck");
  }
  std::vector<std::vector<std::string>> table(TableOptions options) const {
    options.csv = true;
    return cells_of(results_table(results(), options));
  }
  std::string order(const std::string& sort) const {
    std::string points;
    for (const auto& row : table({{"n"}, sort, {}, {}, false})) points += row[0];
    return points.substr(1);
  }
};

TEST(ResultsTable, ShowsAxesThatVaryAndTheUsualFigures) {
  const FourRows sweep;
  EXPECT_EQ(results_table(sweep.results(), {}),
            "n  status  l1.size  cycles  perf.fps  power_w.nominal  perf.frames_per_joule_gpu\n"
            "-  ------  -------  ------  --------  ---------------  -------------------------\n"
            "0  done     16 KiB    3000     333.3           0.5000                      666.7\n"
            "1  done      4 KiB    1000      1000           0.5000                       2000\n"
            "2  done      1 MiB    2000     500.0           0.5000                       1000\n"
            "3  failed    8 KiB       -         -                -                          -\n");
}

TEST(ResultsTable, ShowsMeansAndIntervalsOfReplicates) {
  const FourRows sweep;
  for (std::size_t point = 0; point < 3; ++point) {
    auto report = minimal_report(1000);
    report["totals"]["replicates"] = {
        {"count", 5}, {"figures", {{"cycles", {{"mean", 1010}, {"deviation", 10}, {"low", 998}, {"high", 1022}}}}}};
    sweep.finish(point, report);
  }
  // 2.776 x 10 / sqrt(5) = 12.4 cycles.
  EXPECT_SAYS(results_table(sweep.results(), {}), "  1010 ± 1.2 %");
  TableOptions csv;
  csv.csv = true;
  EXPECT_SAYS(results_table(sweep.results(), csv),
              "totals.replicates.figures.cycles.mean,totals.replicates.figures.cycles.low,"
              "totals.replicates.figures.cycles.high,totals.perf.fps");
}

/// Returns the printed cells of a column over three points.
Words shown_fps(const std::array<double, 3>& values) {
  const FourRows sweep;
  for (std::size_t point = 0; point < values.size(); ++point) {
    auto report = minimal_report(1000);
    report["totals"]["perf"]["fps"] = values[point];
    sweep.finish(point, report);
  }
  return shown_cells(sweep.results().column("fps"), {0, 1, 2});
}

TEST(ResultsTable, ShowsAtMostFourDigitsInTheUnitOfTheLargest) {
  EXPECT_EQ(shown_fps({9.876, 101.2345, 1000}), (Words{"9.876", "101.2", "1000"}));
  EXPECT_EQ(shown_fps({77120, 9876.54, 12345.67}), (Words{"77.12 k", "9.877 k", "12.35 k"}));
  EXPECT_EQ(shown_fps({1234567, 250000.5, 12.5}), (Words{"1.235 M", "0.2500 M", "12.50"})) << "too small for millions";
}

TEST(ResultsTable, ShowsCountsInFourDigitsTooButNoSettings) {
  MadeSweep sweep;
  for (const int cycles : {771200, 99000, 1010}) {
    auto report = minimal_report(1000);
    report["totals"]["cycles"] = cycles;
    sweep.finish(sweep.add({{"triangles", std::to_string(cycles)}}), report);
  }
  const auto results = sweep.results();
  EXPECT_EQ(shown_cells(results.column("cycles"), {0, 1, 2}), (Words{"771.2 k", "99.00 k", "1.010 k"}));
  EXPECT_EQ(shown_cells(results.column("triangles"), {0, 1, 2}), (Words{"771200", "99000", "1010"}));
}

TEST(ResultsTable, ShowsWholeMeansInFourDigits) {
  const FourRows sweep;
  for (std::size_t point = 0; point < 3; ++point) {
    auto report = minimal_report(1000);
    const double mean = 98765 + 10 * static_cast<double>(point);
    report["totals"]["replicates"] = {{"count", 5}, {"figures", {{"cycles", {{"mean", mean}, {"deviation", 10}}}}}};
    sweep.finish(point, report);
  }
  EXPECT_SAYS(results_table(sweep.results(), {}), "  98.77 k ± ");
}

/// A sweep whose order by the mean of three replicates differs from that by the first replicate.
struct PlaysInAnotherOrder : FourRows {
  PlaysInAnotherOrder() {
    const double means[] = {1500, 3500, 2500};
    for (std::size_t point = 0; point < 3; ++point) {
      auto report = minimal_report(1000 * (3 - static_cast<double>(point)));
      report["totals"]["replicates"] = {{"count", 3},
                                        {"figures", {{"cycles", {{"mean", means[point]}, {"deviation", 10}}}}}};
      finish(point, report);
    }
  }
};

TEST(ResultsTable, OrderAndConditionsGoByMeansOfReplicates) {
  const PlaysInAnotherOrder sweep;
  EXPECT_EQ(sweep.order("cycles:asc"), "0213");
  EXPECT_EQ(sweep.order("totals.cycles:desc"), "1203");
  EXPECT_EQ(sweep.table({{"n"}, "", {"cycles>2000"}, {}, false}), (std::vector<Words>{{"n"}, {"1"}, {"2"}}));
}

TEST(ResultsTable, AskedColumnsAreMeansForPeopleAndWhatTheirPathSaysInCsv) {
  const PlaysInAnotherOrder sweep;
  EXPECT_SAYS(results_table(sweep.results(), {{"n", "cycles"}, "", {"n=1"}, {}, false}), "3500 ± 0.71 %");
  EXPECT_EQ(sweep.table({{"totals.cycles"}, "", {"n=1"}, {}, false}),
            (std::vector<Words>{{"totals.cycles"}, {"2000"}}));
}

TEST(ResultsTable, CallsAFigureAsAllVerbsDo) {
  const FourRows sweep;
  for (const char* spelling : {"fps", "perf.fps", "totals.perf.fps"}) {
    EXPECT_TRUE(results_table(sweep.results(), {{spelling}, "", {}, {}, false}).starts_with("perf.fps\n")) << spelling;
  }
}

TEST(ResultsTable, ShowsFourDigitsOfFiguresThatAreNoCounts) {
  const FourRows sweep;
  auto report = minimal_report(3000);
  report["totals"]["perf"]["fps"] = 12345.67;
  sweep.finish(0, report);
  EXPECT_SAYS(results_table(sweep.results(), {}), "  12.35 k  ");
  TableOptions csv;
  csv.csv = true;
  EXPECT_SAYS(results_table(sweep.results(), csv), "12345.67");
}

TEST(ResultsTable, ShowsExtrapolatedFiguresIfThereAreSome) {
  const FourRows sweep;
  auto report = minimal_report(3000);
  report["totals"]["extrapolated"] = 0;
  sweep.finish(0, report);
  EXPECT_EQ(results_table(sweep.results(), {}).find("extrapolated"), std::string::npos);
  report["totals"]["extrapolated"] = 2;
  sweep.finish(0, report);
  EXPECT_SAYS(results_table(sweep.results(), {}), "  extrapolated\n");
}

TEST(ResultsTable, AnyClearEndOfAPathIsAColumn) {
  const FourRows sweep;
  const auto rows = sweep.table({{"size", "fps", "perf.fps", "totals.perf.fps", "error"}, "", {}, {}, false});
  EXPECT_EQ(rows[0],
            (std::vector<std::string>{"l1.size", "totals.perf.fps", "totals.perf.fps", "totals.perf.fps", "error"}));
  EXPECT_EQ(rows[3], (std::vector<std::string>{"1 MiB", "500", "500", "500", ""}));
  EXPECT_EQ(rows[4], (std::vector<std::string>{"8 KiB", "", "", "", "stuck"}));
}

TEST(ResultsTable, CountersOfUnitsAreColumnsToo) {
  const FourRows sweep;
  const auto rows = sweep.table({{"units.core.srp.counters.loads", "core1.srp.counters.loads"}, "", {}, {}, false});
  EXPECT_EQ(rows[1], (std::vector<std::string>{"15", "8"}));
  EXPECT_EQ(rows[4], (std::vector<std::string>{"", ""}));
}

TEST(ResultsTable, AnEndThatMeansSeveralIsRefusedWithThem) {
  const FourRows sweep;
  sweep.collect();
  const std::string folder = sweep.folder().string();
  expect_refusal(raywatt({"sweep", "table", folder, "--columns", "n,boxes"}),
                 {"'boxes'", "totals.top_down.cores[0].boxes", "totals.top_down.cores[1].boxes"});
  expect_refusal(raywatt({"sweep", "table", folder, "--columns", "counters.loads"}),
                 {"units.core0.srp.counters.loads", "units.core.srp.counters.loads"});
  expect_refusal(raywatt({"sweep", "table", folder, "--sort", "cylces"}), {"did you mean 'cycles'"});
  expect_refusal(raywatt({"sweep", "table", folder, "--sort", "cycles:down"}), {"asc, desc"});
}

TEST(ResultsTable, SaysThatNothingMeetsAConditionToPeopleAlone) {
  const FourRows sweep;
  sweep.collect();
  const Words words = {"sweep", "table", sweep.folder().string(), "--where", "cycles<0"};
  EXPECT_SAYS(raywatt(words).out, "no point meets --where");
  Words csv = words;
  csv.emplace_back("--csv");
  EXPECT_EQ(raywatt(csv).out.find("no point"), std::string::npos);
}

TEST(ResultsTable, SortsByAmountAndPutsWhatIsAbsentLast) {
  const FourRows sweep;
  EXPECT_EQ(sweep.order(""), "0123");
  EXPECT_EQ(sweep.order("l1.size"), "1302");
  EXPECT_EQ(sweep.order("l1.size:desc"), "2031");
  EXPECT_EQ(sweep.order("cycles"), "1203");
  EXPECT_EQ(sweep.order("cycles:desc"), "0213");
  EXPECT_EQ(sweep.order("trvs:desc"), "0123") << "equal ones stay in their order";
}

TEST(ResultsTable, ShowsOnlyWhatIsAskedFor) {
  const FourRows sweep;
  EXPECT_EQ(sweep.table({{"n"}, "cycles:desc", {"cycles<3000"}, {}, false}).size(), 1U + 2);
  EXPECT_EQ(sweep.table({{"n"}, "cycles:desc", {"cycles<3000"}, 1, false}),
            (std::vector<std::vector<std::string>>{{"n"}, {"2"}}));
}

TEST(ResultsTable, CsvHasAllDigitsAndQuotesWhatNeedsThem) {
  const FourRows sweep;
  const std::string csv = results_table(sweep.results(), {{"fps", "limiter"}, "", {"n=0"}, {}, true});
  EXPECT_EQ(csv, "totals.perf.fps,totals.limiter\n333.3333333333333,\"L2, and \"\"DRAM\"\"\"\n");
}

TEST(ResultsTable, NothingOfAReportReachesTheTerminalAsItIs) {
  MadeSweep sweep;
  auto report = minimal_report(1);
  report["totals"]["limiter"] = "\x1b[2J";
  sweep.finish(sweep.add({{"a\x1b", "b\x1b"}}), report);
  const std::string text = results_table(sweep.results(), {{"limiter", "a\x1b"}, "", {}, {}, false});
  EXPECT_EQ(text.find('\x1b'), std::string::npos);
}

TEST(ResultsTable, IsOfWhatThereIsNow) {
  const FourRows sweep;
  sweep.write();
  const Words table = {"sweep", "table", sweep.folder().string(), "--columns", "n,cycles", "--csv"};
  EXPECT_EQ(raywatt(table).out, "n,totals.cycles\n0,3000\n1,1000\n2,2000\n3,\n");
  sweep.finish(3, 4000);
  EXPECT_EQ(raywatt(table).out, "n,totals.cycles\n0,3000\n1,1000\n2,2000\n3,4000\n");
}

TEST(ResultsTable, IsOfWhatWasLastCollectedWhereNothingCanBeWritten) {
  const FourRows sweep;
  const Words table = {"sweep", "table", sweep.folder().string(), "--columns", "n,cycles", "--csv"};
  const std::string before = raywatt((sweep.write(), table)).out;
  sweep.finish(3, 4000);
  std::filesystem::remove(sweep.folder() / "results.csv");
  std::filesystem::create_directory(sweep.folder() / "results.csv");  // blocks the output file
  const ProcessResult ending = raywatt(table);
  EXPECT_EQ(ending.exit, 0) << ending.err;
  EXPECT_EQ(ending.out, before);
  EXPECT_SAYS(ending.err, "last collected");
}

TEST(ResultsTable, AFolderWithoutASweepIsRefused) {
  const MadeSweep sweep;
  expect_refusal(raywatt({"sweep", "table", sweep.folder().string()}), {"holds no sweep"});
}

using tools::results::csv_cell;

TEST(CsvCell, QuotesCommasQuotesAndLineEnds) {
  EXPECT_EQ(csv_cell("16 KiB"), "16 KiB");
  EXPECT_EQ(csv_cell("a,b"), "\"a,b\"");
  EXPECT_EQ(csv_cell("a\"b"), "\"a\"\"b\"");
  EXPECT_EQ(csv_cell("a\nb"), "\"a\nb\"");
}

TEST(CsvCell, LeavesNoFormulaForASpreadsheet) {
  EXPECT_EQ(csv_cell("=1+1"), "'=1+1");
  EXPECT_EQ(csv_cell("@SUM(A1)"), "'@SUM(A1)");
  EXPECT_EQ(csv_cell("+cmd"), "'+cmd");
  EXPECT_EQ(csv_cell("-a"), "'-a");
  EXPECT_EQ(csv_cell("\ta"), "'\ta");
  EXPECT_EQ(csv_cell("=a,b"), "\"'=a,b\"");
}

TEST(CsvCell, LeavesNegativeNumbersNumbers) {
  EXPECT_EQ(csv_cell("-1.5"), "-1.5");
  EXPECT_EQ(csv_cell("-2e-05"), "-2e-05");
}

// Tests of conditions, as in `raywatt sweep table --where`.

using tools::results::Results;

/// A sweep of points 0 to 3 with sizes of 4, 8, 16 and 32 KiB and cycles of 400, 300, 200 and none.
struct FourKinds : MadeSweep {
  FourKinds() {
    const char* kinds[] = {"none", "2", "rau", "4"};
    for (std::size_t i = 0; i < 4; ++i) add({{"l1.size", std::to_string(4 << i) + " KiB"}, {"kind", kinds[i]}});
    for (std::size_t i = 0; i < 3; ++i) finish(i, 400 - 100.0 * static_cast<double>(i));
  }
};

std::string met(const std::vector<std::string>& conditions) {
  static const FourKinds sweep;
  static const Results results = sweep.results();
  std::string points;
  const std::vector<bool> all = rows_meeting(results, conditions);
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (all[i]) points += std::to_string(i);
  }
  return points;
}

std::string refusal(const std::string& condition) {
  try {
    met({condition});
  } catch (const sim::InputError& error) {
    return error.what();
  }
  return "it is allowed";
}

TEST(Condition, ComparesNumbers) {
  EXPECT_EQ(met({"cycles<300"}), "2");
  EXPECT_EQ(met({"cycles<=300"}), "12");
  EXPECT_EQ(met({"cycles=300"}), "1");
  EXPECT_EQ(met({"cycles == 3e2"}), "1");
  EXPECT_EQ(met({"cycles!=300"}), "02");
  EXPECT_EQ(met({"totals.cycles >= 300"}), "01");
  EXPECT_EQ(met({"  cycles > 300  "}), "0");
  EXPECT_EQ(met({"cycles>-1.5"}), "012");
}

TEST(Condition, APointWithoutTheValueNeverMeetsIt) {
  EXPECT_EQ(met({"cycles!=1"}), "012");
  EXPECT_EQ(met({"cycles<1e9"}), "012");
}

TEST(Condition, ComparesQuantitiesByWhatTheyAre) {
  EXPECT_EQ(met({"l1.size>=16 KiB"}), "23");
  EXPECT_EQ(met({"l1.size<'8 KiB'"}), "0");
  EXPECT_EQ(met({"size=8192 B"}), "1");
  EXPECT_EQ(met({"size=8KiB"}), "1");
}

TEST(Condition, ComparesTextsForEquality) {
  EXPECT_EQ(met({"kind=rau"}), "2");
  EXPECT_EQ(met({"kind!=\"rau\""}), "013");
  EXPECT_EQ(met({"status=missing"}), "3");
  EXPECT_EQ(met({"totals.limiter='L2, and \"DRAM\"'"}), "012");
  EXPECT_EQ(met({"kind>2"}), "3") << "texts beside numbers are not above any";
}

TEST(Condition, AMetricWithABandDenotesItsNominalValue) {
  EXPECT_EQ(met({"power_w>=0"}), met({"power_w.nominal>=0"}));
  EXPECT_EQ(met({"power_w<0"}), "");
}

TEST(Condition, AllMustHold) {
  EXPECT_EQ(met({"cycles<400 and l1.size<16 KiB"}), "1");
  EXPECT_EQ(met({"cycles<400", "l1.size<16 KiB"}), "1");
  EXPECT_EQ(met({"cycles<400 and kind=2 and n=1"}), "1");
  EXPECT_EQ(met({}), "0123");
}

TEST(Condition, SaysAtWhichColumnItIsWrong) {
  const std::pair<const char*, const char*> wrong[] = {{"", "column 1"},
                                                       {"<1", "column 1"},
                                                       {"cycles", "column 7"},
                                                       {"cycles<", "column 8"},
                                                       {"cycles<1 or n=1", "column 10"},
                                                       {"cycles<1 and", "column 13"},
                                                       {"cycles<1 andn=1", "column 10"},
                                                       {"cycles='a", "column 8"},
                                                       {"cycles ~ 1", "column 8"}};
  for (const auto& [condition, column] : wrong) EXPECT_SAYS(refusal(condition), column);
}

TEST(Condition, RefusesWhatCannotBeCompared) {
  EXPECT_SAYS(refusal("l1.size<16"), "'4 KiB'");
  EXPECT_SAYS(refusal("l1.size<16 MHz"), "'4 KiB'");
  EXPECT_SAYS(refusal("cycles<fast"), "'fast' is no number");
  EXPECT_SAYS(refusal("limiter<3"), "texts are compared with = and !=");
  EXPECT_SAYS(refusal("cylces<3"), "did you mean 'cycles'");
}

TEST(Condition, SaysThatAUnitOrOrIsNotKnown) {
  EXPECT_SAYS(refusal("cycles<=12mm2"), "'mm2' of '12mm2' is no unit of frequency, time or bytes");
  EXPECT_SAYS(refusal("cycles<=12 mm2"), "'mm2' after '12' is no unit of frequency, time or bytes");
  EXPECT_SAYS(refusal("cycles<300 or cycles>400"), "'or' is not known");
  EXPECT_SAYS(refusal("kind=rau cycles<3"), "'and' is missing");
}

}  // namespace
}  // namespace test
