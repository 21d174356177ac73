#include <atomic>
#include <filesystem>
#include <fstream>
#include <thread>
#include <vector>

#include <gtest/gtest.h>
#include <sys/stat.h>

#include "../folder.h"
#include "sim/error.h"
#include "sim/io/file.h"

// Tests of temporary folders and lock files that several processes or threads use at once.

namespace sim::test {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> names_in(const fs::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) names.push_back(entry.path().filename().string());
  return names;
}

// Each thread removes stale folders, and none of them is one that another thread uses.
TEST(NewFolder, NoneIsRemovedWhileItIsUsedAlsoIfManyHaveOneTarget) {
  const Folder folder;
  std::atomic<int> lost = 0;
  std::vector<std::thread> threads;
  for (int t = 0; t < 8; ++t) {
    threads.emplace_back([&] {
      for (int i = 0; i < 300; ++i) {
        NewFolder temporary(folder.path() / "out");
        temporary.remove_stale();
        lost += temporary.make() || !(std::ofstream(temporary.path() / "report.json") << "{}") ? 1 : 0;
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(lost, 0);
  EXPECT_EQ(names_in(folder.path()), std::vector<std::string>());
}

TEST(NewFolder, RemovesStaleFoldersOfThisAndOfFormerVersionsOnly) {
  const Folder folder;
  for (const char* stale : {".out.1-0.raywatt-tmp", ".other.1-7.raywatt-tmp", ".out.1.0.raywatt-tmp"}) {
    fs::create_directories(folder.path() / stale / "half");
  }
  const fs::path notes = folder.path() / ".out.notes.raywatt-tmp";
  fs::create_directory(notes);
  NewFolder(folder.path() / "out").remove_stale();
  EXPECT_EQ(names_in(folder.path()), std::vector<std::string>{notes.filename().string()});
}

TEST(NewFolder, MakesMissingParentsAndRemovesThemIfTheyStayEmpty) {
  const Folder folder;
  {
    NewFolder temporary(folder.path() / "a" / "b" / "out");
    ASSERT_FALSE(temporary.make());
    EXPECT_EQ(temporary.path().parent_path(), folder.path() / "a" / "b");
  }
  EXPECT_FALSE(fs::exists(folder.path() / "a"));
}

TEST(FileLock, IsHeldByOneAtATimeAndLeavesNoFile) {
  const Folder folder;
  const fs::path name = folder.path() / "lock";
  {
    const auto lock = FileLock::try_acquire(name, "host 1\n");
    ASSERT_TRUE(lock);
    EXPECT_FALSE(FileLock::try_acquire(name));
    EXPECT_EQ(FileLock::read_holder(name), "host 1\n");
  }
  EXPECT_EQ(FileLock::read_holder(name), std::nullopt);
  EXPECT_FALSE(fs::exists(name));
}

TEST(FileLock, TakesNoFileThatIsNoLockFile) {
  const Folder folder;
  const fs::path precious = folder.path() / "precious", name = folder.path() / "lock";
  const auto expect_refusal = [&] {
    EXPECT_THROW(FileLock::try_acquire(name, "host 1\n"), InputError);
    EXPECT_EQ(FileLock::read_holder(name), std::nullopt);
    EXPECT_TRUE(fs::exists(fs::symlink_status(name)));
    fs::remove(name);
  };
  std::ofstream(precious) << "three years";
  fs::create_symlink(precious, name);
  expect_refusal();
  EXPECT_EQ(read_file(precious, 100), "three years");
  fs::create_symlink(folder.path() / "absent", name);
  expect_refusal();
  for (const char* text : {"three years", "4 years\n1", "host 1", "host 1a\n"}) {
    std::ofstream(name) << text;
    expect_refusal();
  }
  ASSERT_EQ(::mkfifo(name.c_str(), 0600), 0);
  expect_refusal();
  std::ofstream(name) << "host 1\n";
  EXPECT_TRUE(FileLock::try_acquire(name, "host 2\n")) << "a killed process has left it";
}

}  // namespace
}  // namespace sim::test
