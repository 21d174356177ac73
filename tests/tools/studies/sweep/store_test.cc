#include "tools/studies/sweep/store/store.h"

#include <fstream>
#include <limits>

#include <gtest/gtest.h>

#include "sim/error.h"
#include "sim/io/file.h"
#include "sim/sha256.h"
#include "tests/tools/studies/sweep/small_sweep.h"

// Tests of the result store: a result is complete or absent.

namespace test {
namespace {

namespace fs = std::filesystem;
using tools::sweep::PointStatus;
using tools::sweep::Store;

struct SweepStore : testing::Test {
  TempFolder folder;
  Store store{folder.path() / "store"};
  sim::Json made_of = {{"schema", "raywatt-point/1"}, {"config_hash", "c"}};
  std::string id = sim::sha256_hex(sim::json_line(made_of));

  void put() {
    store.put_result(id, made_of, [](const fs::path& to) {
      sim::write_file_atomically(to / "report.json", "{\"totals\": {\"cycles\": 1}}\n");
      sim::write_file_atomically(to / "config.yaml", "cores: 1\n");
    });
  }
};

TEST_F(SweepStore, HasAPointOnceItIsPut) {
  EXPECT_EQ(store.status_of(id), PointStatus::kMissing);
  EXPECT_FALSE(store.read_report(id));
  put();
  EXPECT_EQ(store.status_of(id), PointStatus::kDone);
  EXPECT_EQ(store.read_report(id), "{\"totals\": {\"cycles\": 1}}\n");
  EXPECT_EQ(names_in(store.folder_of(id)), (Words{"config.yaml", "point.json", "report.json"}));
  EXPECT_TRUE(names_in(store.root() / "tmp").empty());
  put();  // the second of two equal results is dropped
  EXPECT_EQ(store.status_of(id), PointStatus::kDone);
  EXPECT_TRUE(names_in(store.root() / "tmp").empty());
}

TEST_F(SweepStore, NeverServesWhatIsDamaged) {
  const std::vector<std::function<void(const fs::path&)>> damages = {
      [](const fs::path& p) { fs::resize_file(p / "report.json", 5); },
      [](const fs::path& p) { std::ofstream(p / "report.json") << "{\"totals\": {\"cycles\": 2}}\n"; },
      [](const fs::path& p) { fs::remove(p / "report.json"); },
      [](const fs::path& p) { fs::resize_file(p / "config.yaml", 0); },
      [](const fs::path& p) { fs::resize_file(p / "point.json", 40); },
      [](const fs::path& p) { fs::remove(p / "point.json"); },
      [](const fs::path& p) { std::ofstream(p / "point.json") << "{}"; },
      [](const fs::path& p) { std::ofstream(p / "point.json") << "[[[["; },
  };
  for (std::size_t d = 0; d < damages.size(); ++d) {
    put();
    damages[d](store.folder_of(id));
    EXPECT_EQ(store.status_of(id), PointStatus::kDamaged) << d;
    EXPECT_TRUE(d == 3 || !store.read_report(id)) << d;
    EXPECT_TRUE(store.lock_point(id)) << d;
    EXPECT_EQ(store.status_of(id), PointStatus::kMissing) << d << ": removed by the process that computes it again";
  }
  EXPECT_EQ(names_in(store.root() / "damaged").size(), damages.size());
}

TEST_F(SweepStore, HasAPointOfAnotherIdForDamaged) {
  put();
  const std::string other = sim::sha256_hex("other");
  fs::create_directories(store.folder_of(other).parent_path());
  fs::copy(store.folder_of(id), store.folder_of(other));
  EXPECT_EQ(store.status_of(other), PointStatus::kDamaged);
}

TEST_F(SweepStore, LocksAPointForOneAtATime) {
  {
    const auto lock = store.lock_point(id);
    ASSERT_TRUE(lock);
    EXPECT_FALSE(store.lock_point(id));
    EXPECT_TRUE(store.is_locked(id));
    EXPECT_TRUE(store.lock_point(sim::sha256_hex("other")));
  }
  EXPECT_FALSE(store.is_locked(id));
  EXPECT_TRUE(store.lock_point(id));
  EXPECT_TRUE(names_in(store.root() / "locks").empty()) << "nothing stays";
}

TEST_F(SweepStore, WhatAKilledProcessHasLeftIsRemovedAndWhatALivingOneHasIsNot) {
  const std::string living = sim::sha256_hex("living");
  const auto lock = store.lock_point(living);
  for (const std::string& name : {id, living}) {
    for (const std::string& left :
         {"." + name + ".123-0.raywatt-tmp", name + ".host.1"}) {  // as older versions wrote it
      sim::make_folders(store.root() / "tmp" / left);
      std::ofstream(store.root() / "tmp" / left / "report.json") << "{";
    }
  }
  std::ofstream(store.root() / "locks" / id) << "";
  for (const std::string& name : {id, living}) {
    sim::make_folders(store.root() / "failed" / name.substr(0, 2));
    std::ofstream(store.root() / "failed" / name.substr(0, 2) / (name + ".123-0.raywatt-tmp.json")) << "{";
  }
  store.remove_stale();
  EXPECT_EQ(names_in(store.root() / "failed" / id.substr(0, 2)), Words{});
  EXPECT_EQ(names_in(store.root() / "failed" / living.substr(0, 2)), Words{living + ".123-0.raywatt-tmp.json"});
  EXPECT_EQ(names_in(store.root() / "tmp"), (Words{"." + living + ".123-0.raywatt-tmp", living + ".host.1"}));
  EXPECT_EQ(names_in(store.root() / "locks"), Words{living});
}

TEST_F(SweepStore, AFailedWriteLeavesNothing) {
  EXPECT_THROW(store.put_result(id, made_of, [](const fs::path&) { throw std::runtime_error("no"); }),
               std::runtime_error);
  EXPECT_EQ(store.status_of(id), PointStatus::kMissing);
  EXPECT_TRUE(names_in(store.root() / "tmp").empty());
}

TEST_F(SweepStore, RemembersFailures) {
  store.put_failure({id, 3, "stuck", "core0: waits\n", "here", 2});
  const auto failure = store.read_failure(id);
  ASSERT_TRUE(failure);
  EXPECT_EQ(failure->exit, 3);
  EXPECT_EQ(failure->error, "stuck");
  EXPECT_EQ(failure->log, "core0: waits\n");
  EXPECT_EQ(failure->attempt, 2);
  store.remove_failure(id);
  EXPECT_FALSE(store.read_failure(id));
}

TEST_F(SweepStore, HasNoFailureWhoseNumbersAreNoneOrTooLarge) {
  const auto with = [&](const std::string& exit, const std::string& attempt) {
    const std::filesystem::path file = store.failure_file(id);
    std::filesystem::create_directories(file.parent_path());
    std::ofstream(file) << R"({"exit": )" << exit << R"(, "error": "", "log": "", "host": "", "attempt": )" << attempt
                        << "}";
    return store.read_failure(id);
  };
  ASSERT_TRUE(with("-2147483648", "2147483647"));
  EXPECT_EQ(with("-2147483648", "1")->exit, std::numeric_limits<int>::min());
  for (const char* number : {"1e300", "2.0", "2147483648", "-2147483649", "18446744073709551615", "true", "null"}) {
    EXPECT_FALSE(with(number, "1")) << number;
    EXPECT_FALSE(with("1", number)) << number;
  }
}

}  // namespace
}  // namespace test
