#include "sim/io/file.h"

#include <atomic>
#include <csignal>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <thread>
#include <vector>

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include "../folder.h"
#include "sim/error.h"
#include "sim/io/printable.h"
#include "sim/sha256.h"

namespace sim::test {
namespace {

std::size_t files_in(const std::filesystem::path& folder) {
  return static_cast<std::size_t>(
      std::distance(std::filesystem::directory_iterator(folder), std::filesystem::directory_iterator{}));
}

TEST(WriteFile, ReplacesTheWholeFileAndLeavesNothingElse) {
  const Folder folder;
  const auto file = folder.write("x.json", "something much longer than what follows");
  const std::string bytes("a\0b\n", 4);
  write_file_atomically(file, bytes);
  EXPECT_EQ(read_file(file, 100), bytes);
  EXPECT_EQ(files_in(folder.path()), 1U);
}

TEST(WriteFile, TouchesNoOtherFileAndFollowsNoLink) {
  const Folder folder;
  // Names that a temporary file never has.
  const std::string own = std::to_string(::getpid());
  const auto mine = folder.write("x.raywatt-tmp.json", "mine"),
             first = folder.write("x." + own + "-0.raywatt-tmp.json", "mine");
  const auto target = folder.write("target", "kept");
  std::filesystem::create_symlink(target, folder.path() / ("x." + own + "-1.raywatt-tmp.json"));
  write_file_atomically(folder.path() / "x.json", "new");
  EXPECT_EQ(read_file(folder.path() / "x.json", 100), "new");
  EXPECT_EQ(read_file(mine, 100), "mine");
  EXPECT_EQ(read_file(first, 100), "mine");
  EXPECT_EQ(read_file(target, 100), "kept");
  EXPECT_EQ(files_in(folder.path()), 5U);
}

TEST(WriteFile, TwoWritersOfOneFileDoNotMix) {
  const Folder folder;
  const auto path = folder.path() / "x";
  NewFile a(path), b(path);
  a.write("first");
  b.write("2nd");
  a.commit();
  EXPECT_EQ(read_file(path, 100), "first");
  b.commit();
  EXPECT_EQ(read_file(path, 100), "2nd");
  NewFile(path).write("neither");
  EXPECT_EQ(read_file(path, 100), "2nd");
  EXPECT_EQ(files_in(folder.path()), 1U);
}

TEST(WriteFile, HasThePermissionsThatTheUmaskLeaves) {
  const Folder folder;
  const mode_t before = ::umask(027);
  write_file_atomically(folder.path() / "x", "");
  ::umask(before);
  EXPECT_EQ(std::filesystem::status(folder.path() / "x").permissions(), std::filesystem::perms{0640});
}

TEST(AppendToFile, TakesRegularFilesAlone) {
  const Folder folder;
  const auto file = folder.path() / "log", link = folder.path() / "link", pipe = folder.path() / "pipe";
  append_to_file(file, "one\n");
  append_to_file(file, "two\n");
  EXPECT_EQ(read_file(file, 100), "one\ntwo\n");
  std::filesystem::create_symlink(file, link);
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_THROW(append_to_file(link, "three\n"), IoError);
  EXPECT_THROW(append_to_file(pipe, "three\n"), IoError) << "no process reads it, and the call does not wait";
  EXPECT_EQ(read_file(file, 100), "one\ntwo\n");
}

TEST(CheckOutput, RemovesStaleFilesOnlyIfTheOutputIsAccepted) {
  const Folder folder;
  const auto out = folder.write("x.json", "of others"), left = folder.write("x.123-0.raywatt-tmp.json", "half"),
             theirs = folder.write("x.2024-01.tmp.json", "of others");
  EXPECT_THROW(check_output(out, {.mark = "mine"}), InputError);
  EXPECT_TRUE(std::filesystem::exists(left));
  check_output(out, {.any = true});
  EXPECT_FALSE(std::filesystem::exists(left));
  EXPECT_TRUE(std::filesystem::exists(theirs));
  EXPECT_THROW(check_output(folder.path() / "no" / "x.json", {.any = true}), InputError) << "no such folder";
  EXPECT_THROW(check_output(folder.path() / std::string(300, 'x'), {.any = true}), InputError) << "too long a name";
}

TEST(CheckOutput, AFolderThatTheUserMayNotWriteIntoIsRefused) {
  const Folder folder;
  const auto former = folder.write("former.html", "a page");
  std::filesystem::permissions(folder.path(), std::filesystem::perms::owner_read | std::filesystem::perms::owner_exec);
  constexpr uid_t kNobody = 65534;
  const bool is_root = ::geteuid() == 0;  // root may write everywhere
  ASSERT_TRUE(!is_root || ::seteuid(kNobody) == 0);
  EXPECT_THROW(check_output(folder.path() / "page.html", {.kind = "page"}), InputError);
  EXPECT_THROW(check_output(former, {.kind = "page", .any = true}), InputError) << "a new one would go beside it";
  ASSERT_TRUE(!is_root || ::seteuid(0) == 0);
  std::filesystem::permissions(folder.path(), std::filesystem::perms::owner_all);
}

TEST(WriteFile, AStaleFileOfAKilledWriterIsRecognisedByItsName) {
  EXPECT_TRUE(is_temporary_name("x.123-0.raywatt-tmp.json", "x.json"));
  EXPECT_TRUE(is_temporary_name("x.123-45.raywatt-tmp", "x"));
  for (const char* other : {"x.json", "x.raywatt-tmp.json", "x.123.raywatt-tmp.json", "x.a-0.raywatt-tmp.json",
                            "y.123-0.raywatt-tmp.json", "x.-1.raywatt-tmp.json", "x.1-2-3.raywatt-tmp.json",
                            "x.123-0.tmp.json", "x.123-0.raywatt-tmp.yaml", "x..raywatt-tmp.json"}) {
    EXPECT_FALSE(is_temporary_name(other, "x.json")) << other;
  }
  const Folder folder;
  NewFile file(folder.path() / "x.y.png");
  EXPECT_TRUE(
      is_temporary_name(std::filesystem::directory_iterator(folder.path())->path().filename().string(), "x.y.png"));
}

TEST(WriteFile, WithoutAFolderIsAnIoError) {
  const Folder folder;
  EXPECT_EQ(complaint<IoError>(folder, [&] { write_file_atomically(folder.path() / "none/x.json", "x"); }),
            "none/x.json: cannot be written: No such file or directory");
}

TEST(WriteFile, OntoAFolderIsAnIoErrorAndLeavesNothing) {
  const Folder folder;
  std::filesystem::create_directories(folder.path() / "x.json/inside");
  EXPECT_EQ(complaint<IoError>(folder, [&] { write_file_atomically(folder.path() / "x.json", "x"); }),
            "x.json: cannot be written: Is a directory");
  EXPECT_EQ(files_in(folder.path()), 1U);
}

TEST(WriteFile, WithoutRoomIsAnIoErrorAndKeepsTheOldFile) {
  const Folder folder;
  const auto file = folder.write("x.json", "old");
  std::signal(SIGXFSZ, SIG_IGN);
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  const rlimit tight{1000, before.rlim_max};
  setrlimit(RLIMIT_FSIZE, &tight);
  const std::string message = complaint<IoError>(folder, [&] { write_file_atomically(file, std::string(5000, 'x')); });
  setrlimit(RLIMIT_FSIZE, &before);
  EXPECT_EQ(message, "x.json: cannot be written: File too large");
  EXPECT_EQ(read_file(file, 100), "old");
  EXPECT_EQ(files_in(folder.path()), 1U);
}

TEST(ReadFile, RefusesWhatIsMissingTooLargeOrNoFile) {
  const Folder folder;
  const auto read = [&](const char* name) {
    return complaint<InputError>(folder, [&] { read_file(folder.path() / name, 3); });
  };
  folder.write("fits", "abc");
  folder.write("large", "abcd");
  EXPECT_EQ(read("fits"), "no error");
  EXPECT_EQ(read("large"), "large: is too large; allowed: 3 bytes");
  EXPECT_EQ(read("none"), "none: no such file");
  EXPECT_EQ(read("."), ".: is a folder, not a file");
}

TEST(ReadFile, LooksAtTheSizeBeforeItReads) {
  const Folder folder;
  folder.write("sparse", "");
  std::filesystem::resize_file(folder.path() / "sparse", std::uintmax_t{1} << 40);
  EXPECT_EQ(complaint<InputError>(folder, [&] { read_file(folder.path() / "sparse", std::uint64_t{1} << 39); }),
            "sparse: is too large; allowed: 549755813888 bytes");
}

TEST(Printable, KeepsTextAndReplacesTheRest) {
  EXPECT_EQ(printable("plain \xc3\xa9 \xe2\x82\xac \xf0\x9f\x98\x80"), "plain \xc3\xa9 \xe2\x82\xac \xf0\x9f\x98\x80");
  EXPECT_EQ(printable("a\nb\x1b[m\x7f"), "a?b?[m?");
  EXPECT_EQ(printable("\xff \xc3 \xe2\x82 \xed\xa0\x80 \xc0\xaf \xc2\x85"), "? ? ?? ??? ?? ??");
  EXPECT_EQ(printable("12345", 5), "12345");
  EXPECT_EQ(printable("123456", 5), "12345...");
  EXPECT_EQ(printable("1234\xc3\xa9", 5), "1234...");
}

TEST(Sha256, EqualsThePublishedExamples) {
  EXPECT_EQ(sha256_hex(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(sha256_hex("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

TEST(Sha256, TakesItsInputPieceByPiece) {
  Sha256 digest;
  digest.add("a");
  digest.add("b");
  EXPECT_EQ(digest.hex_digest(), sha256_hex("ab"));
  digest.add("c");
  EXPECT_EQ(digest.hex_digest(), sha256_hex("abc"));
}

// Tests of temporary folders and lock files that several processes or threads use at once.

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
