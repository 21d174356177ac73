#include <gtest/gtest.h>

#include "tests/tools/program.h"

// Tests that invalid command lines cause one line on stderr, exit code 2 and no output.

namespace test {
namespace {

/// Expects `run` with these arguments to fail without creating its output folder.
void expect_run_refused(Words arguments, const Words& parts) {
  const TempFolder folder;
  arguments.insert(arguments.begin(), "run");
  arguments.insert(arguments.end(), {"-o", (folder.path() / "new" / "out").string()});
  expect_refusal(raywatt(arguments, {folder.path(), {}, 0, {}}), parts);
  EXPECT_EQ(names_in(folder.path()), Words{});
}

TEST(BadArguments, AResolutionThatIsNone) {
  for (const char* text : {"64", "64x", "x32", "64x32x1", "64*32", "0x32", "64x0", "-64x32", "64x-32", "64x32 ",
                           "16385x1", "99999999999x1", "6.4x3", "0x40x32"}) {
    expect_run_refused({"--resolution", text}, {"WIDTHxHEIGHT", "1 to 16384", "e.g. 1024x512"});
  }
}

TEST(BadArguments, AProgramThatIsNotThere) {
  for (const char* option : {"--program", "--reference"}) {
    expect_run_refused({option, "fool:1"}, {"'fool:1'", "full:N"});
    expect_run_refused({option, "full:3"}, {"'full:3'", "square"});
    expect_run_refused({option, "full:0"}, {"'full:0'", "square"});
    expect_run_refused({option, "full:-1"}, {"'full:-1'", "square"});
  }
}

TEST(BadArguments, ThreadsThatAreNoneOrTooMany) {
  for (const char* threads : {"0", "-1", "1025", "many", "1.5"}) {
    expect_run_refused({"--threads", threads}, {"--threads"});
  }
}

TEST(BadArguments, ASceneWithoutAName) {
  expect_refusal(raywatt({"run", "--scene", ""}), {"--scene: allowed: a name"});
  expect_refusal(raywatt({"run", "-o", ""}), {"--output: allowed: a folder"});
}

TEST(BadArguments, ValuesThatAreEmpty) {
  for (const char* option :
       {"--camera", "--resolution", "--frames", "--reference", "--record", "--rays", "--program"}) {
    expect_run_refused({option, ""}, {std::string(option) + ": is empty; allowed: a value, or to leave it out"});
  }
  for (const Words& verb :
       std::vector<Words>{{"sweep", "run", "a.yaml"}, {"optimise", "a.yaml"}, {"reproduce", "chiu"}}) {
    Words words = verb;
    words.insert(words.end(), {"-o", ""});
    expect_refusal(raywatt(words), {"--output: is empty"});
  }
  expect_refusal(raywatt({"baseline", "check", "a.yaml", "--junit", ""}), {"--junit: is empty"});
  expect_refusal(raywatt({"sweep", "status", ""}), {"folder: is empty; allowed: a value; see"});
}

TEST(BadArguments, NegativeNumbersWhereNumbersAreWhole) {
  for (const Words& words : std::vector<Words>{{"sweep", "table", "out", "--limit", "-1"},
                                               {"optimise", "a.yaml", "--seed", "-1"},
                                               {"sweep", "point", "out", "--index", "-1"}}) {
    expect_refusal(raywatt(words), {words[words.size() - 2] + ": -1 is negative; allowed: a whole number from 0 on"});
  }
}

TEST(BadArguments, OptionsThatAreUnknownRepeatedOrWithoutAValue) {
  expect_run_refused({"--colour", "red"}, {"--colour"});
  expect_run_refused({"--scene", "cornell", "--scene", "teapot"}, {"--scene"});
  expect_run_refused({"sgrt-2016", "teapot"}, {"teapot"});
  expect_refusal(raywatt({"run", "--scene"}), {"--scene"});
}

TEST(BadArguments, AVerbThatIsNotThereGetsTheNearestOneAndTheList) {
  expect_refusal(raywatt({"verfy"}),
                 {"unknown verb 'verfy'", "did you mean 'verify'?", "run, verify, reproduce, scenes"});
  expect_refusal(raywatt({"config", "shwo"}), {"unknown subcommand 'shwo'", "did you mean 'show'?", "list, show"});
  expect_refusal(raywatt({}), {"raywatt --help"});
  expect_refusal(raywatt({"config"}), {"see raywatt config --help"});
  expect_refusal(raywatt({"trace", "replay", "a.trace", "--no-such"}),
                 {"unknown option '--no-such'", "; see raywatt trace replay --help"});
}

TEST(BadArguments, AnOptionCutShortGetsTheOneThatBeginsSo) {
  expect_run_refused({"--res", "64x32"}, {"unknown option '--res', did you mean '--resolution'?"});
  expect_run_refused({"--deb"}, {"unknown option '--deb', did you mean '--debug-images'?"});
}

TEST(BadArguments, AKernelThatIsNotThereGetsTheNearestOne) {
  expect_refusal(raywatt({"kernels", "show", "shade_difuse"}), {"'shade_difuse'", "did you mean 'shade_diffuse'?"});
}

TEST(BadArguments, AKeyOrAProgramThatIsNotThereGetsThoseThatWereMeant) {
  expect_run_refused({"--set", "l1.size=8KiB"}, {"did you mean 'tni.trv.l1' or 'tni.ist.l1'"});
  expect_run_refused({"--program", "ful:1"}, {"did you mean 'full:1'?", "there is: full:N"});
}

TEST(BadArguments, AComplaintIsOneLineWhateverItQuotes) {
  expect_run_refused({"two\nlines"}, {"two?lines"});
  expect_run_refused({"--two\nlines"}, {"two?lines"});
  expect_run_refused({"--scene", "two\nlines"}, {"two?lines"});
  expect_run_refused({"--set", "two\nlines=1"}, {"two?lines"});
  expect_run_refused({"--program", "two\nlines"}, {"two?lines"});
}

TEST(BadArguments, AnOutputFolderThatCannotBeWritten) {
  const TempFolder folder;
  folder.write("file", "text");
  const std::string file = (folder.path() / "file").string();
  const auto refused = [&](const std::string& out, const std::string& why) {
    expect_refusal(raywatt({"run", "-o", out}), {why, out.substr(0, 200)});
    expect_refusal(raywatt({"verify", "-o", out}), {why});
  };
  refused(file, "is a file, not a folder");
  refused(file + "/out", "Not a directory");
  refused(file + "/deep/out", "Not a directory");
  refused("/proc/raywatt", "cannot be written");
  refused(folder.path().string() + "/" + std::string(300, 'a'), "File name too long");
  std::filesystem::create_symlink(folder.path() / "nowhere", folder.path() / "link");
  refused((folder.path() / "link").string(), "is a file, not a folder");
  EXPECT_EQ(names_in(folder.path()), (Words{"file", "link"}));
  EXPECT_EQ(read_bytes(file), "text");
}

TEST(BadArguments, NamesThatNoFileCanHave) {
  const TempFolder folder;
  const std::string name(300, 'x'), page = (folder.path() / "page.html").string();
  const std::vector<Words> all = {{"report", name, "-o", page},
                                  {"report", page, "-o", name},
                                  {"energy", "price", name},
                                  {"run", "--resolution", "16x16", "--record", name},
                                  {"reproduce", "lee2016", "--scenes", name}};
  for (const Words& words : all) {
    SCOPED_TRACE(words[0]);
    expect_refusal(raywatt(words, {.folder = folder.path()}), {name.substr(0, 100)});
  }
  std::filesystem::create_symlink("raywatt-out", folder.path() / "raywatt-out");
  expect_refusal(raywatt({"run", "--resolution", "16x16"}, {.folder = folder.path()}),
                 {"raywatt-out", "cannot be written"});
}

}  // namespace
}  // namespace test
