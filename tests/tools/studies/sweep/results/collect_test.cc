#include "tools/studies/sweep/results/collect.h"

#include <algorithm>
#include <fstream>
#include <thread>

#include <SQLiteCpp/SQLiteCpp.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/stat.h>

#include "sim/error.h"
#include "tests/tools/program.h"
#include "tests/tools/studies/sweep/results/made_sweep.h"

// Tests of collecting points into results.csv and index.sqlite.

namespace test {
namespace {

namespace fs = std::filesystem;
using tools::results::Collected;
using tools::results::PointStatus;
using tools::results::Results;
using tools::results::StatusCounts;
using tools::sweep::SweepFolder;

StatusCounts counts(std::size_t done, std::size_t failed, std::size_t missing, std::size_t damaged) {
  StatusCounts all = {{PointStatus::kDone, done},
                      {PointStatus::kFailed, failed},
                      {PointStatus::kMissing, missing},
                      {PointStatus::kDamaged, damaged}};
  std::erase_if(all, [](const auto& entry) { return entry.second == 0; });
  return all;
}
void expect_counts(const Collected& is, const StatusCounts& wanted) { EXPECT_EQ(is.counts, wanted); }

/// A sweep of three points; one is done.
struct Three : MadeSweep {
  Three() {
    for (const char* size : {"4 KiB", "8 KiB", "16 KiB"}) add({{"l1.size", size}});
    finish(0, 1000);
  }
};

std::string refusal(const SweepFolder& folder) {
  try {
    tools::results::collect_results(folder);
  } catch (const sim::InputError& error) {
    return error.what();
  }
  return {};
}

std::vector<std::string> column(const MadeSweep& sweep, std::size_t index) {
  std::vector<std::string> out;
  for (const auto& row : cells_of(sweep.csv())) out.push_back(row.at(index));
  return out;
}

TEST(Collect, EveryPointIsARowWhateverBecameOfIt) {
  Three sweep;
  sweep.fail(1, "stuck");
  expect_counts(sweep.collect(), counts(1, 1, 1, 0));
  EXPECT_EQ(column(sweep, 0), (std::vector<std::string>{"n", "0", "1", "2"}));
  EXPECT_EQ(column(sweep, 1), (std::vector<std::string>{"id", sweep.id(0), sweep.id(1), sweep.id(2)}));
  EXPECT_EQ(column(sweep, 2), (std::vector<std::string>{"status", "done", "failed", "missing"}));
  EXPECT_EQ(column(sweep, 3), (std::vector<std::string>{"l1.size", "4 KiB", "8 KiB", "16 KiB"}));
  EXPECT_EQ(column(sweep, 5), (std::vector<std::string>{"l1.size_bytes", "4096", "8192", "16384"}));
  EXPECT_EQ(column(sweep, 6), (std::vector<std::string>{"totals.cycles", "1000", "", ""}));
}

TEST(Collect, AResultWinsOverAnEarlierFailure) {
  Three sweep;
  sweep.fail(0, "stuck");
  expect_counts(sweep.collect(), counts(1, 0, 2, 0));
}

TEST(Collect, AReportCutAnywhereIsDamaged) {
  const std::string whole = minimal_report(1000).dump(2);
  for (std::size_t eighths = 0; eighths < 8; ++eighths) {
    Three sweep;
    sweep.damage(0, whole.substr(0, whole.size() * eighths / 8));
    expect_counts(sweep.collect(), counts(0, 0, 2, 1));
    EXPECT_EQ(column(sweep, 2)[1], "damaged");
  }
}

TEST(Collect, WhatIsNoFinishedReportIsDamaged) {
  nlohmann::ordered_json partial = minimal_report(1000), other = partial, empty = partial;
  partial["partial"] = true;
  other["schema"] = "another";
  empty["totals"] = nlohmann::ordered_json::object();
  const std::string deep(200'000, '['), nul(100, '\0');
  for (const std::string& bytes : {partial.dump(), other.dump(), empty.dump(), deep, nul, std::string("[]"),
                                   std::string("{\"schema\": 1, \"totals\": {\"cycles\": 1e999}}")}) {
    Three sweep;
    sweep.finish(0, bytes);
    expect_counts(sweep.collect(), counts(0, 0, 2, 1));
  }
  Three sweep;
  fs::remove(sweep.point(0) / "report.json");
  expect_counts(sweep.collect(), counts(0, 0, 2, 1));
}

TEST(Collect, ADamagedRecordOfAFailureIsAFailure) {
  Three sweep;
  sweep.fail(1, "stuck");
  fs::resize_file(sweep.store().failure_file(sweep.id(1)), 10);
  expect_counts(sweep.collect(), counts(1, 1, 1, 0));
}

TEST(Collect, EqualSweepsGiveEqualTables) {
  Three a, b;
  for (const std::size_t n : {1U, 2U}) a.finish(n, static_cast<double>(n));
  for (const std::size_t n : {2U, 1U}) b.finish(n, static_cast<double>(n));
  a.collect();
  b.collect();
  EXPECT_EQ(a.csv(), b.csv());
  b.finish(2, 3);
  b.collect();
  EXPECT_NE(a.csv(), b.csv());
}

TEST(Collect, TheTableHoldsEveryPlainFigureOfTheTotalsAndNothingOfTheHost) {
  const TempFolder temporary;
  ASSERT_EQ(raywatt(small_run(temporary.path() / "run", {"--reference", "full:4"})).exit, 0);
  const std::string report = read_bytes(temporary.path() / "run" / "report.json");
  MadeSweep sweep;
  sweep.finish(sweep.add({}), nlohmann::ordered_json::parse(report));
  sweep.collect();
  const Results results(sweep.folder());
  const auto totals = nlohmann::ordered_json::parse(report)["totals"].flatten();
  std::size_t figures = 0;
  for (const auto& [pointer, value] : totals.items()) {
    if (value.is_null() || value.is_structured()) continue;
    std::string path = "totals";
    for (std::size_t at = 0; at < pointer.size();) {
      const std::size_t end = std::min(pointer.find('/', at + 1), pointer.size());
      const std::string part = pointer.substr(at + 1, end - at - 1);
      path += part.find_first_not_of("0123456789") == std::string::npos ? "[" + part + "]" : "." + part;
      at = end;
    }
    const tools::results::Value is = results.column(path).values.at(0);
    if (value.is_number()) {
      EXPECT_EQ(tools::results::magnitude_of(is)->value, value.get<double>()) << path;
    } else {
      EXPECT_EQ(tools::results::exact_text(is), value.is_string() ? value.get<std::string>() : value.dump()) << path;
    }
    ++figures;
  }
  EXPECT_GT(figures, 200U);
  EXPECT_EQ(cells_of(sweep.csv())[0].size(), 3 + 1 + figures);
  EXPECT_EQ(sweep.csv().find("host"), std::string::npos);
}

TEST(Collect, TheTableHasItsFiguresInOrderAndQuantitiesAsNumbersToo) {
  MadeSweep sweep;
  nlohmann::ordered_json report = minimal_report(1);
  report["totals"]["a_last_one"] = 2;
  sweep.finish(sweep.add({{"size", "8 KiB"}, {"cores", "2"}, {"clock", "500 MHz"}}), report);
  sweep.finish(sweep.add({{"size", "none"}, {"cores", "4"}, {"clock", "1 GHz"}}), report);
  sweep.collect();
  const auto rows = cells_of(sweep.csv());
  const std::vector<std::string> axes(rows[0].begin() + 3, rows[0].begin() + 9);
  EXPECT_EQ(axes, (std::vector<std::string>{"size", "cores", "clock", "program", "size_bytes", "clock_hz"}));
  EXPECT_EQ(rows[1][7], "8192");
  EXPECT_EQ(rows[2][7], "") << "no quantity";
  EXPECT_EQ(std::stod(rows[2][8]), 1e9);
  EXPECT_TRUE(std::is_sorted(rows[0].begin() + 9, rows[0].end()));
}

TEST(Collect, TheIndexIsSoundAndItsTablesAgree) {
  Three sweep;
  sweep.fail(1, "stuck");
  sweep.collect();
  const auto index = tools::results::open_index(sweep.folder() / "index.sqlite");
  const auto number = [&](const char* sql) { return index->execAndGet(sql).getInt64(); };
  EXPECT_EQ(number("SELECT COUNT(*) FROM pragma_integrity_check WHERE integrity_check != 'ok'"), 0);
  EXPECT_EQ(number("SELECT COUNT(*) FROM pragma_foreign_key_check"), 0);
  EXPECT_EQ(number("SELECT COUNT(*) FROM points"), 3);
  EXPECT_EQ(number("SELECT number FROM parameters JOIN axes USING (axis) WHERE name = 'l1.size' AND point = 1"), 8192);
  EXPECT_EQ(number("SELECT value FROM results WHERE path = 'totals.cycles' AND point = 0"), 1000);
  EXPECT_EQ(number("SELECT value * 100 FROM results WHERE path = 'totals.top_down.cores[1].boxes'"), 50);
  EXPECT_EQ(number("SELECT COUNT(*) FROM frames WHERE point = 0 AND frame = 3 AND cycles = 1000 AND rays = 17"), 2);
  EXPECT_EQ(number("SELECT COUNT(*) FROM host WHERE name = 'a' AND threads = 2"), 1);
  EXPECT_EQ(
      number("SELECT attempt FROM errors WHERE error = 'stuck' AND exit = 3 AND log = 'one' || char(10) || 'two'"), 2);
}

TEST(Collect, NothingIsWrittenIfNothingHasHappened) {
  Three sweep;
  EXPECT_FALSE(sweep.collect().unchanged);
  const auto index = sweep.folder() / "index.sqlite";
  const auto time = fs::last_write_time(index);
  const Collected again = sweep.collect();
  EXPECT_TRUE(again.unchanged);
  expect_counts(again, counts(1, 0, 2, 0));
  EXPECT_EQ(fs::last_write_time(index), time);
}

TEST(Collect, WhateverHappensIsNoticed) {
  Three sweep;
  sweep.collect();
  sweep.finish(1, 7);
  EXPECT_FALSE(sweep.collect().unchanged);
  sweep.damage(1, "");
  expect_counts(sweep.collect(), counts(1, 0, 1, 1));
  sweep.remove(1);
  expect_counts(sweep.collect(), counts(1, 0, 2, 0));
  sweep.fail(2, "stuck");
  expect_counts(sweep.collect(), counts(1, 1, 1, 0));
  sweep.add({{"l1.size", "1 MiB"}});
  expect_counts(sweep.collect(), counts(1, 1, 2, 0));
  fs::remove(sweep.folder() / "results.csv");
  EXPECT_FALSE(sweep.collect().unchanged);
  EXPECT_EQ(cells_of(sweep.csv()).size(), 5U);
}

TEST(Collect, ADamagedIndexIsMadeAnew) {
  Three sweep;
  sweep.collect();
  const fs::path index = sweep.folder() / "index.sqlite";
  const std::string sound = read_bytes(index);
  for (const std::size_t size : {std::size_t{0}, std::size_t{50}, sound.size() / 2}) {
    fs::resize_file(index, size);
    const ProcessResult ending = raywatt({"sweep", "table", sweep.folder().string()});
    EXPECT_EQ(ending.exit, 0) << ending.err;
    EXPECT_EQ(read_bytes(index).size(), sound.size());
  }
  fs::remove(index);
  ASSERT_EQ(::mkfifo(index.c_str(), 0600), 0);
  EXPECT_EQ(raywatt({"sweep", "table", sweep.folder().string()}).exit, 0) << "a pipe without a writer";
  EXPECT_EQ(read_bytes(index).size(), sound.size());
}

TEST(Collect, AListThatIsNoneIsRefusedWithItsLine) {
  MadeSweep sweep;
  sweep.add({});
  const std::string sound = format_point_line(sweep.points()[0]) + "\n";
  const auto other = [&](const std::string& part, const std::string& instead) {
    std::string line = sound;
    return line.replace(line.find(part), part.size(), instead);
  };
  const std::pair<std::string, std::string> lists[] = {{"", "no point"},
                                                       {sound + "{", "points.jsonl:2"},
                                                       {sound + sound, "points.jsonl:2"},
                                                       {"[]\n", "points.jsonl:1"},
                                                       {other("\"n\":0", "\"n\":-1"), "points.jsonl:1"},
                                                       {other(sweep.id(0), "../../x"), "points.jsonl:1"},
                                                       {other("{}", "{\"a\":[1]}"), "points.jsonl:1"}};
  const SweepFolder folder = sweep.write();
  for (const auto& [text, part] : lists) {
    std::ofstream(folder.path() / "points.jsonl") << text;
    EXPECT_SAYS(refusal(folder), part);
  }
  const TempFolder empty;
  expect_refusal(raywatt({"sweep", "collect", empty.path().string()}), {"holds no sweep"});
}

TEST(Collect, AFullDiskLeavesWhatWasThere) {
  Three sweep;
  sweep.collect();
  const std::string csv = sweep.csv(), index = read_bytes(sweep.folder() / "index.sqlite");
  sweep.finish(1, 7);
  ProcessEnvironment full;
  full.longest_file = 100;
  const Words collect = {"sweep", "collect", sweep.folder().string()};
  const ProcessResult ending = raywatt(collect, full);
  EXPECT_EQ(ending.exit, 74) << ending.err;
  EXPECT_EQ(sweep.csv(), csv);
  EXPECT_EQ(read_bytes(sweep.folder() / "index.sqlite"), index);
  EXPECT_EQ(raywatt(collect).exit, 0);
  EXPECT_NE(sweep.csv(), csv);
}

TEST(Collect, TwoCollectorsAtOnceLeaveOneSoundIndex) {
  Three sweep;
  sweep.collect();
  const std::string csv = sweep.csv();
  for (int round = 0; round < 5; ++round) {
    fs::remove(sweep.folder() / "index.sqlite");
    {
      std::vector<std::jthread> collectors;
      for (int i = 0; i < 4; ++i)
        collectors.emplace_back([&] { tools::results::collect_results(SweepFolder::open(sweep.folder())); });
    }
    EXPECT_EQ(sweep.csv(), csv);
    EXPECT_EQ(Results(sweep.folder()).rows().size(), 3U);
    EXPECT_TRUE(sweep.collect().unchanged);
  }
}

}  // namespace
}  // namespace test
