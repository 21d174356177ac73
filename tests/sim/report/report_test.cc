#include <array>
#include <string_view>

#include <gtest/gtest.h>

#include "sim/named.h"
#include "sim/report/report_json.h"
#include "sim/report/table.h"
#include "sim/unit_report.h"

namespace sim::test {
namespace {

enum class Block : std::uint8_t { kL2, kTni };
constexpr std::array<std::string_view, 2> names_of(Block) { return {"l2", "tni"}; }

/// Test unit that worked for three cycles and waited for seven.
struct Worker {
  static constexpr Block kBlock = Block::kTni;
  enum class CycleReason : std::uint8_t { kIdle, kWorking, kCount };
  static constexpr auto kReasons =
      reasons<CycleReason>({{CycleReason::kIdle, idle_reason("idle", "nothing to do")},
                            {CycleReason::kWorking, working_reason("working", "a job is under way")}});
  struct Stats {
    std::uint64_t jobs = 3;
    static void describe(auto& s, auto&& counter) {
      counter(NAMED(s.jobs), "jobs done", "worker.job");
      counter(s.jobs, "again", "the same, at no cost");
    }
  };

  Worker() {
    for (Time t = 0; t < 3; ++t) work.spend(t * 2'000'000, 2'000'000, CycleReason::kWorking, CycleReason::kIdle);
    work.finish(20'000'000);
  }
  Clock clock() const { return Clock(2'000'000); }
  const Stats& stats() const { return counted; }
  const Activity<CycleReason>& activity() const { return work; }

  Stats counted;
  Activity<CycleReason> work;
};

TEST(UnitReport, HoldsWhatTheUnitDeclares) {
  const UnitReport r = report_of(Worker(), "core0.worker1", 4096, 1024);
  EXPECT_EQ(r.block, "tni");
  EXPECT_EQ(r.elapsed, 10U);
  EXPECT_EQ(r.cycles_by_reason, (std::vector<std::pair<std::string, std::uint64_t>>{{"idle", 7}, {"working", 3}}));
  ASSERT_EQ(r.counters.size(), 2U);
  EXPECT_EQ(r.counters[0].event, "worker.job");
  EXPECT_EQ(r.counters[1].event, "");
  EXPECT_EQ(r.clock_mhz, 500U);
  EXPECT_EQ(r.cache_bytes, 1024U);
  EXPECT_EQ(report_of(Worker(), "w", 4096).cache_bytes, 4096U);
}

TEST(ReportJson, FollowsThePathsOfTheUnits) {
  const std::vector<UnitReport> units = {report_of(Worker(), "core0.tni.trv0"), report_of(Worker(), "core0.tni"),
                                         report_of(Worker(), "l2")};
  const auto json = units_json(units);
  EXPECT_EQ(json.at("core0").at("tni").at("trv0").at("why").at("working"), 3);
  EXPECT_EQ(json.at("core0").at("tni").at("elapsed"), 10);
  EXPECT_EQ(json_lines(json.at("l2")), R"({
  "elapsed": 10,
  "why": {
    "idle": 7,
    "working": 3
  },
  "counters": {
    "jobs": 3,
    "again": 3
  }
}
)");
  EXPECT_EQ(json_line(band_json({1, 2, 3}, 0.5)), R"({"low":0.5,"nominal":1.0,"high":1.5})");
}

TEST(SiText, KeepsThreeDigits) {
  EXPECT_EQ(si_text(12'345'678), "12.3 M");
  EXPECT_EQ(si_text(999), "999");
  EXPECT_EQ(si_text(999.6), "1.00 k");
  EXPECT_EQ(si_text(999'499), "999 k");
  EXPECT_EQ(si_text(0), "0");
  EXPECT_EQ(si_text(-0.00456, "J"), "-4.56 mJ");
  EXPECT_EQ(si_text(3.14159, "W"), "3.14 W");
  EXPECT_EQ(si_text(5, "frames"), "5 frames");
  EXPECT_EQ(si_text(0.11), "0.110");
  EXPECT_EQ(si_text(2.5e20, "B"), "250000 PB");
}

TEST(Table, AlignsItsColumns) {
  Table table({"unit", "cycles", "share"});
  table.add_row({"trv", "12.3 M", "7 %"});
  table.add_row({"dispatcher \xc2\xb5", "5"});
  EXPECT_EQ(table.text(),
            "unit          cycles  share\n"
            "------------  ------  -----\n"
            "trv           12.3 M    7 %\n"
            "dispatcher \xc2\xb5       5\n");
}

TEST(Table, AlignsWordsToTheLeft) {
  Table table({"scene", "what it is", "size"});
  table.add_row({"cornell", "a box", "10.3 k"});
  table.add_row({"chess", "32 men on a board", ""});
  EXPECT_EQ(table.text(),
            "scene    what it is           size\n"
            "-------  -----------------  ------\n"
            "cornell  a box              10.3 k\n"
            "chess    32 men on a board\n");
}

}  // namespace
}  // namespace sim::test
