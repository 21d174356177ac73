#include <algorithm>
#include <csignal>
#include <fstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/stat.h>
#include <unistd.h>

#include "sim/error.h"
#include "tests/tools/program.h"
#include "tools/host/run_folder.h"

// Tests of result folders: where they may be written, and that they appear as a whole.

namespace test {
namespace {

namespace fs = std::filesystem;

const Words kResults = {"config.yaml", "image.exr",   "image.png",  "intervals.bin.zst",
                        "pixels.exr",  "report.json", "report.txt", "tiles.json"};

void expect_run_into(const fs::path& out, const Words& more = {}) {
  const ProcessResult ending = raywatt(small_run(out, more));
  EXPECT_EQ(ending.exit, 0) << ending.err;
  EXPECT_EQ(names_in(out), kResults);
  EXPECT_EQ(names_in(out.parent_path()), Words{out.filename().string()}) << "nothing beside it";
}

TEST(Folder, NewOrEmptyIsTaken) {
  const TempFolder folder;
  fs::create_directory(folder.path() / "empty");
  expect_run_into(folder.path() / "empty");
  EXPECT_EQ(raywatt(small_run(folder.path() / "new" / ".." / "empty" / "")).exit, 0) << "however it is written";
  EXPECT_EQ(names_in(folder.path()), Words{"empty"});
}

TEST(Folder, OfAFormerRunIsReplacedWhole) {
  const TempFolder folder;
  const fs::path out = folder.path() / "out";
  expect_run_into(out);
  expect_run_into(out, {"--set", "cores=1"});
  EXPECT_EQ(read_json(out / "report.json")["config"]["cores"], 1);
}

TEST(Folder, KilledRunsLeaveIsRemovedByTheNextRun) {
  const TempFolder folder;
  const fs::path out = folder.path() / "out";
  Program killed(small_run(out, {"--scene", "cornell", "--frames", "0:100000"}));
  EXPECT_TRUE(killed.wait_for_file(folder.path(), "frame-0001.png"));
  killed.send(SIGKILL);
  EXPECT_EQ(killed.wait().exit, 128 + SIGKILL);
  ASSERT_EQ(names_in(folder.path()).size(), 1U) << "what it has left";
  const fs::path left = folder.path() / names_in(folder.path()).front();
  fs::create_directory(folder.path() / ".other.1.0.raywatt-tmp");
  fs::create_directory(folder.path() / ".out.notes.raywatt-tmp");
  Program other(small_run(out, {"--scene", "cornell", "--frames", "0:100000"}));
  EXPECT_TRUE(wait_until([&] { return !fs::exists(left); }));
  EXPECT_TRUE(other.wait_for_file(folder.path(), "frame-0001.png"));
  EXPECT_EQ(raywatt(small_run(out)).exit, 0);
  EXPECT_FALSE(fs::exists(folder.path() / ".other.1.0.raywatt-tmp")) << "of a killed run with another target";
  EXPECT_EQ(names_in(folder.path()).size(), 3U) << "a locked folder and other names stay";
  other.send(SIGKILL);
  other.wait();
  EXPECT_EQ(raywatt(small_run(out)).exit, 0);
  EXPECT_EQ(names_in(folder.path()), (Words{".out.notes.raywatt-tmp", "out"}));
}

TEST(Folder, OfADateRemovesWhatKilledRunsOfOtherDatesHaveLeft) {
  const TempFolder folder;
  const fs::path all = folder.path() / "raywatt-out";
  const Words others = {".2026-01-02.notes.raywatt-tmp", ".raywatt-tmp", "2026-01-01.1.0.raywatt-tmp"};
  fs::create_directories(all / ".2026-01-01_12-00-00.123.0.raywatt-tmp");
  for (const std::string& name : others) fs::create_directory(all / name);
  Words words = small_run({});
  words.erase(std::ranges::find(words, "-o"), std::ranges::find(words, "-o") + 2);
  EXPECT_EQ(raywatt(words, {.folder = folder.path()}).exit, 0);
  EXPECT_EQ(names_in(all).size(), others.size() + 1);
  for (const std::string& name : others) EXPECT_TRUE(fs::exists(all / name)) << name;
}

TEST(Folder, NamesThatAreNoUtf8KeepTheirBytes) {
  const TempFolder folder;
  const fs::path out = folder.path() / "o\xff";
  const ProcessResult ending = raywatt(small_run(out));
  EXPECT_EQ(ending.exit, 0) << ending.err;
  const std::vector<std::string> argv = read_json(out / "report.json")["provenance"]["argv"];
  EXPECT_TRUE(std::ranges::any_of(argv, [](const std::string& word) { return word.ends_with("/o\\xff"); }));
  ASSERT_EQ(raywatt({"scenes", "export", "cornell", "--set", "scene.triangles=60", "-o",
                     (folder.path() / "n\xff.glb").string()})
                .exit,
            0);
  const fs::path of_scene = folder.path() / "of-scene";
  EXPECT_EQ(raywatt(small_run(of_scene, {"--scene", (folder.path() / "n\xff.glb").string()})).exit, 0);
  const nlohmann::json report = read_json(of_scene / "report.json");
  EXPECT_TRUE(report["scene"]["name"].get<std::string>().ends_with("n\\xff")) << report["scene"]["name"];
  EXPECT_TRUE(report["config"]["scene"]["name"].get<std::string>().ends_with("/n\\xff.glb"));
  EXPECT_NE(read_bytes(of_scene / "config.yaml").find("n\\\\xff.glb"), std::string::npos);
}

TEST(Folder, KeepsItsPermissionsWhenItIsReplaced) {
  const TempFolder folder;
  const fs::path out = folder.path() / "out";
  const auto kPrivate = fs::perms::owner_all | fs::perms::set_gid;
  fs::create_directory(out);
  fs::permissions(out, kPrivate);
  for (const char* former : {"empty", "a run"}) {
    expect_run_into(out);
    EXPECT_EQ(fs::status(out).permissions(), kPrivate) << former;
  }
}

TEST(Folder, ThatIsTheWorkingDirectoryStaysTheSame) {
  const TempFolder folder;
  struct stat before {
  }, after{};
  ASSERT_EQ(::stat(folder.path().c_str(), &before), 0);
  for (const char* former : {"empty", "a run"}) {
    const ProcessResult ending = raywatt(small_run("."), {.folder = folder.path()});
    EXPECT_EQ(ending.exit, 0) << former << ending.err;
    EXPECT_EQ(names_in(folder.path()), kResults);
    ASSERT_EQ(::stat(folder.path().c_str(), &after), 0);
    EXPECT_EQ(after.st_ino, before.st_ino) << former;
  }
}

TEST(Folder, ThatTheUserMayNotReadIsRefused) {
  const TempFolder folder;
  const fs::path out = folder.path() / "out";
  fs::create_directory(out);
  fs::permissions(out, fs::perms::owner_write | fs::perms::owner_exec);
  constexpr uid_t kNobody = 65534;
  const bool is_root = ::geteuid() == 0;  // root may read everything
  ASSERT_TRUE(!is_root || (::chmod(folder.path().c_str(), 0755) == 0 && ::seteuid(kNobody) == 0));
  EXPECT_THROW(tools::RunFolder(out, true), sim::InputError);
  ASSERT_TRUE(!is_root || ::seteuid(0) == 0);
  fs::permissions(out, fs::perms::owner_all);
}

TEST(Folder, ByForceTakesNothingThatWouldStayInTheWay) {
  const TempFolder folder;
  const fs::path out = folder.path() / "out";
  fs::create_directories(out / "image.png");
  std::ofstream(out / "report.json") << "another program's";
  expect_refusal(raywatt(small_run(out, {"--force"})),
                 {"image.png: has the name of a result and is not a regular file"});
  EXPECT_EQ(read_bytes(out / "report.json"), "another program's");
  EXPECT_EQ(names_in(out), (Words{"image.png", "report.json"}));
}

TEST(Folder, TakesNoTraceOfTheNameOfAResult) {
  const TempFolder folder;
  const fs::path out = folder.path() / "new";
  expect_refusal(raywatt(small_run(out, {"--record", (out / "report.json").string()})),
                 {"--record", "report.json: the run's own results have a file of this name"});
  EXPECT_EQ(names_in(folder.path()), Words{});
}

TEST(Folder, TakesNoTraceInItsOwnPlaceOrAboveIt) {
  const TempFolder folder;
  const fs::path out = folder.path() / "new" / "run";
  for (const fs::path& trace : {out, out.parent_path()}) {
    expect_refusal(raywatt(small_run(out, {"--record", trace.string()})), {"--record", "the run's folder goes there"});
    EXPECT_EQ(names_in(folder.path()), Words{}) << trace;
  }
}

TEST(Folder, WithForeignFilesIsRefusedAndLeftAlone) {
  const TempFolder folder;
  const fs::path out = folder.path() / "out";
  fs::create_directories(out / "deep");
  std::ofstream(out / "deep" / "thesis.txt") << "three years";
  expect_refusal(raywatt(small_run(out)), {out.string(), "holds files but no report.json of a former run", "--force"});
  std::ofstream(out / "report.json") << "{\"schema\": \"another program's\"}";
  expect_refusal(raywatt(small_run(out)), {out.string(), "holds files but no report.json of a former run", "--force"});
  EXPECT_EQ(read_bytes(out / "deep" / "thesis.txt"), "three years");
  EXPECT_EQ(names_in(out), (Words{"deep", "report.json"}));
  EXPECT_EQ(names_in(folder.path()), Words{"out"});
}

TEST(Folder, OfAnotherVerbIsRefusedAndByForceKeepsWhatTheNewOneDoesNotWrite) {
  const TempFolder folder;
  const fs::path ran = folder.path() / "ran", replayed = folder.path() / "replayed";
  const std::string trace = (folder.path() / "a.trace").string();
  ASSERT_EQ(raywatt(small_run(ran, {"--record", trace})).exit, 0);
  const std::string picture = read_bytes(ran / "image.png"), report = read_bytes(ran / "report.json");
  const auto replay = [&](const fs::path& out, const Words& more = {}) {
    Words words = {"trace", "replay", trace, "-o", out.string(), "--quiet"};
    words.insert(words.end(), more.begin(), more.end());
    return raywatt(words);
  };
  expect_refusal(replay(ran), {ran.string(), "holds the results of raywatt run", "--force"});
  EXPECT_EQ(names_in(ran), kResults);
  EXPECT_EQ(read_bytes(ran / "report.json"), report);
  ASSERT_EQ(replay(replayed).exit, 0);
  ASSERT_EQ(replay(replayed).exit, 0) << "its own";
  expect_refusal(raywatt(small_run(replayed)),
                 {replayed.string(), "holds the results of raywatt trace replay", "--force"});
  for (int time = 0; time < 2; ++time) {
    ASSERT_EQ(replay(ran, {"--force"}).exit, 0);
    EXPECT_EQ(names_in(ran), kResults);
    EXPECT_EQ(read_bytes(ran / "image.png"), picture);
    EXPECT_NE(read_bytes(ran / "report.json"), report);
  }
}

TEST(Folder, WithForeignFilesTakesResultsByForceAndLosesNothing) {
  const TempFolder folder;
  const fs::path out = folder.path() / "out";
  fs::create_directories(out / "deep");
  std::ofstream(out / "deep" / "thesis.txt") << "three years";
  std::ofstream(out / "notes.txt") << "ours";
  EXPECT_EQ(raywatt(small_run(out, {"--force"})).exit, 0);
  EXPECT_EQ(read_bytes(out / "deep" / "thesis.txt"), "three years");
  EXPECT_EQ(read_bytes(out / "notes.txt"), "ours");
  EXPECT_TRUE(fs::exists(out / "report.json"));
  EXPECT_EQ(names_in(folder.path()), Words{"out"});
}

TEST(Folder, OfAFormerRunKeepsTheNotesMadeInIt) {
  const TempFolder folder;
  const fs::path out = folder.path() / "out";
  ASSERT_EQ(raywatt(small_run(out, {"--reference", "full:1"})).exit, 0);
  ASSERT_TRUE(fs::exists(out / "reference.exr"));
  std::ofstream(out / "notes.txt") << "ours";
  EXPECT_EQ(raywatt(small_run(out)).exit, 0);
  EXPECT_EQ(read_bytes(out / "notes.txt"), "ours");
  EXPECT_FALSE(fs::exists(out / "reference.exr"));
}

TEST(Folder, IsResolvedThroughLinks) {
  const TempFolder folder;
  fs::create_directories(folder.path() / "disk" / "out");
  fs::create_directory_symlink(folder.path() / "disk" / "out", folder.path() / "link");
  EXPECT_EQ(raywatt(small_run(folder.path() / "link")).exit, 0);
  EXPECT_EQ(names_in(folder.path() / "disk" / "out"), kResults);
  EXPECT_TRUE(fs::is_symlink(folder.path() / "link"));
}

TEST(Folder, IsADatedOneIfNoneIsGivenAndTwoRunsNeverShareIt) {
  const TempFolder folder;
  const Words words = {"run", "--resolution", "16x16", "--quiet"};
  const ProcessEnvironment around{folder.path(), {}, 0, {}};
  Program one(words, around), two(words, around), three(words, around);
  for (Program* program : {&one, &two, &three}) EXPECT_EQ(program->wait().exit, 0);
  const Words dated = names_in(folder.path() / "raywatt-out");
  EXPECT_EQ(dated.size(), 3U);
  for (const std::string& name : dated) EXPECT_EQ(names_in(folder.path() / "raywatt-out" / name), kResults) << name;
}

TEST(Folder, LeftByAKilledRunDoesNotDisturbTheNext) {
  const TempFolder folder;
  const std::string stale = ".out." + std::to_string(::getpid()) + ".0.raywatt-tmp";
  fs::create_directories(folder.path() / stale / "half");
  tools::RunFolder results(folder.path() / "out", false);
  results.fill([](const tools::RunFolder::Open& open) {
    const fs::path& staging = open();
    std::ofstream(staging / "report.json") << "{}";
    return "it";
  });
  EXPECT_EQ(names_in(folder.path()), Words{"out"});
  EXPECT_EQ(names_in(folder.path() / "out"), Words{"report.json"});
}

TEST(Folder, AFailureWhileWritingLeavesTheFormerResults) {
  const TempFolder folder;
  const fs::path out = folder.path() / "out";
  fs::create_directory(out);
  std::ofstream(out / "report.json") << "{\"schema\": \"raywatt-report/1\"}";
  tools::RunFolder results(out, false);
  EXPECT_THROW(results.fill([](const tools::RunFolder::Open& open) -> std::string {
    const fs::path& staging = open();
    std::ofstream(staging / "half") << "made";
    throw sim::IoError("disk full");
  }),
               sim::IoError);
  EXPECT_EQ(names_in(folder.path()), Words{"out"});
  EXPECT_EQ(names_in(out), Words{"report.json"});
}

TEST(Folder, AFullDiskEndsWith74AndLeavesNothing) {
  // report.json exceeds the first limit; image.exr, written by another library, the second.
  const auto full_disk_of = [](std::uint64_t bytes, const char* resolution, const char* file) {
    const TempFolder folder;
    const Words words = {"run", "--resolution", resolution, "-o", (folder.path() / "new" / "out").string()};
    const ProcessResult ending = raywatt(words, {{}, {}, bytes, {}});
    EXPECT_EQ(ending.exit, 74);
    EXPECT_EQ(ending.out, "");
    EXPECT_SAYS(ending.err, file);
    EXPECT_EQ(std::ranges::count(ending.err, '\n'), 1) << ending.err;
    EXPECT_EQ(names_in(folder.path()), Words{});
  };
  full_disk_of(4096, "16x8", "report.json");
  full_disk_of(80'000, "160x128", "image.exr");
}

}  // namespace
}  // namespace test
