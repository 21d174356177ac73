#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>

#include <gtest/gtest.h>

#include "tests/temp_folder.h"
#include "tests/tools/program.h"

// Tests of completion scripts and the manual page, which are generated from the declared options.

namespace test {
namespace {

std::string printed(const Words& arguments) {
  const ProcessResult ending = raywatt(arguments);
  EXPECT_EQ(ending.exit, 0) << ending.err;
  return ending.out;
}

/// Returns the output lines of a command.
Words lines_of_command(const std::string& command) {
  const std::unique_ptr<FILE, int (*)(FILE*)> shell(::popen(command.c_str(), "r"), ::pclose);
  Words words(1);
  for (int c = std::fgetc(shell.get()); c != EOF; c = std::fgetc(shell.get())) {
    if (c == '\n') {
      words.emplace_back();
    } else {
      words.back() += static_cast<char>(c);
    }
  }
  words.pop_back();
  return words;
}

struct Bash : testing::Test {
  TempFolder folder;
  std::filesystem::path script = folder.write("completion", printed({"completion", "bash"}));

  /// Returns the completions of bash for an incomplete command line.
  Words offered(const std::string& line) const {
    const std::string command = "cd '" + folder.path().string() +
                                "' && mkdir -p empty && cd empty && bash -c 'source " + script.string() +
                                "; read -ra COMP_WORDS <<<\"" + line + "\"; [[ \"" + line +
                                "\" != *\" \" ]] || COMP_WORDS+=(\"\"); COMP_CWORD=$((${#COMP_WORDS[@]} - 1)); " +
                                "_raywatt; printf \"%s\\n\" \"${COMPREPLY[@]}\"'";
    return lines_of_command(command);
  }
};

TEST_F(Bash, CompletesVerbsAndThoseBelowThem) {
  EXPECT_EQ(offered("raywatt opt"), Words{"optimise"});
  EXPECT_EQ(offered("raywatt sweep ca"), Words{"cancel"});
  EXPECT_EQ(offered("raywatt trace rep"), Words{"replay"});
}

TEST_F(Bash, CompletesOptionsOfTheVerbAlone) {
  EXPECT_EQ(offered("raywatt run --tile-"), Words{"--tile-sampling"});
  EXPECT_EQ(offered("raywatt run sgrt-2016 --scene chess --tile-"), Words{"--tile-sampling"});
  EXPECT_EQ(offered("raywatt config show --tile-"), Words{""});
}

TEST_F(Bash, CompletesChoices) {
  const Words launchers = {"local", "slurm"};
  EXPECT_EQ(offered("raywatt sweep run --launcher "), launchers);
  EXPECT_EQ(offered("raywatt optimise --launcher s"), Words{"slurm"});
  const Words switches = {"on", "off"};
  EXPECT_EQ(offered("raywatt run --intervals "), switches);
}

TEST_F(Bash, CompletesNamesOfConfigurationsScenesWorkloadsProgramsAndExperiments) {
  const Words presets = {"sgrt-2016", "sgrt-2016-tiles16", "sgrt-balanced"},
              workloads = offered("raywatt run --scene lee2016-");
  EXPECT_EQ(offered("raywatt run sgrt-"), presets);
  EXPECT_EQ(offered("raywatt run sgrt-2016 --scene teap"), Words{"teapot"});
  EXPECT_TRUE(std::ranges::count(workloads, "lee2016-car") == 1) << workloads.size();
  EXPECT_EQ(offered("raywatt run --program under"), Words{"undersample"});
  EXPECT_EQ(offered("raywatt optimise optimise-c"), Words{"optimise-cores"});
  EXPECT_EQ(offered("raywatt worth adaptive-s"), Words{"adaptive-sampling"});
  EXPECT_EQ(offered("raywatt sweep run l1-i"), Words{"l1-ist"});
}

TEST_F(Bash, CompletesNamesOfWhatIsShownOrReproduced) {
  EXPECT_EQ(offered("raywatt scenes info teap"), Words{"teapot"});
  EXPECT_EQ(offered("raywatt reproduce lee"), Words{"lee2016"});
  EXPECT_EQ(offered("raywatt kernels show shade_d"), Words{"shade_diffuse"});
  EXPECT_EQ(offered("raywatt energy show tni.box_test_"),
            (Words{"tni.box_test_hybrid", "tni.box_test_q12", "tni.box_test_q8"}));
}

TEST_F(Bash, CompletesWhatFollowsAnEqualsSign) {
  EXPECT_EQ(offered("raywatt run --scene = teap"), Words{"teapot"});
  const Words switches = {"on", "off"};
  EXPECT_EQ(offered("raywatt run --intervals ="), switches);
}

TEST_F(Bash, CompletesKeysThatAreSetAndTheirFewValues) {
  const Words rays = {"rays", "raster"}, none = {""};
  const Words keys = offered("raywatt run --set tni.t");
  EXPECT_EQ(std::ranges::count(keys, "tni.trvs="), 1);
  EXPECT_TRUE(
      std::ranges::all_of(keys, [](const std::string& key) { return key.starts_with("tni.t") && key.ends_with("="); }));
  EXPECT_EQ(offered("raywatt run sgrt-2016 --set render.pri"), Words{"render.primary="});
  EXPECT_EQ(offered("raywatt config show --set = render.pri"), Words{"render.primary="});
  EXPECT_EQ(offered("raywatt run --set render.primary ="), rays);
  EXPECT_EQ(offered("raywatt run --set render.primary = ra"), rays);
  EXPECT_EQ(offered("raywatt run --set = render.primary = ras"), Words{"raster"});
  EXPECT_EQ(offered("raywatt run --set cores ="), none);
  EXPECT_EQ(offered("raywatt run --set dram.extends = dram/lpddr5-6"), Words{"dram/lpddr5-6400"});
  EXPECT_EQ(offered("raywatt energy price --set cores"), none) << "does not affect energy alone";
  EXPECT_EQ(offered("raywatt energy price --set energy.ext"), Words{"energy.extends="});
}

TEST_F(Bash, OffersFilesAloneForValuesWithoutNames) {
  std::filesystem::create_directory(folder.path() / "empty");
  folder.write("empty/old-run", "");
  EXPECT_EQ(offered("raywatt run --output "), Words{"old-run"});
  EXPECT_EQ(offered("raywatt run -o "), Words{"old-run"});
}

TEST_F(Bash, CompletesWhatFollowsAColonThoughItBreaksWords) {
  const Words halves = {"under", "super"};
  EXPECT_EQ(offered("raywatt run --program multirate :"), halves);
  EXPECT_EQ(offered("raywatt run --program multirate : un"), Words{"under"});
}

TEST_F(Bash, OffersFilesWhereNamesAreKnown) {
  std::filesystem::create_directory(folder.path() / "empty");
  folder.write("empty/teapot-club.glb", "");
  const Words both = {"teapot", "teapot-club.glb"};
  EXPECT_EQ(offered("raywatt run --scene teap"), both);
}

TEST_F(Bash, OffersEveryOptionThatHelpShows) {
  const std::string help = printed({"sweep", "run", "--help"});
  const Words words = offered("raywatt sweep run --");
  EXPECT_GT(words.size(), 8U);
  for (const std::string& word : words) EXPECT_NE(help.find(word), std::string::npos) << word;
  for (std::size_t at = help.find(" --"); at != std::string::npos; at = help.find(" --", at + 1)) {
    const std::string name = help.substr(at + 1, help.find_first_of(" ,\n", at + 1) - at - 1);
    const bool is_another_program_s = name.find('=') != std::string::npos;
    EXPECT_TRUE(std::ranges::count(words, name) == 1 || is_another_program_s) << name;
  }
}

/// Tests of other shells' scripts, if these shells are installed (`tools/validate package` installs them).
struct OtherShells : testing::Test {
  TempFolder folder;
  bool has(const char* shell) const {
    return std::filesystem::exists(std::filesystem::path("/usr/bin") / shell) ||
           std::filesystem::exists(std::filesystem::path("/bin") / shell);
  }
};

TEST_F(OtherShells, ZshParsesItsScriptAndOffersNames) {
  if (!has("zsh")) GTEST_SKIP() << "there is no zsh";
  const std::filesystem::path script = folder.write("_raywatt", printed({"completion", "zsh"}));
  EXPECT_EQ(std::system(("zsh -n '" + script.string() + "'").c_str()), 0);
  // Replaces the shell's completion functions by functions that print the offers.
  const auto offered = [&](const std::string& words, int current) {
    const std::string command =
        "zsh -f -c 'compadd() { while [[ $1 != -- ]]; do shift; done; shift; [ $# = 0 ] || print -l -- $@ }; "
        "compset() { }; _files() { print FILES }; words=(" +
        words + "); CURRENT=" + std::to_string(current) + "; source " + script.string() + "'";
    return lines_of_command(command);
  };
  const Words launchers = {"local", "slurm"}, scenes = offered("raywatt run --scene \"\"", 4);
  EXPECT_EQ(offered("raywatt sweep run --launcher \"\"", 5), launchers);
  EXPECT_EQ(std::ranges::count(scenes, "chess"), 1);
  EXPECT_EQ(std::ranges::count(scenes, "FILES"), 1);
  const Words verbs = offered("raywatt ru", 2);
  EXPECT_EQ(std::ranges::count(verbs, "run"), 1);
  EXPECT_EQ(offered("raywatt run -o \"\"", 4), Words{"FILES"});
  const Words rays = {"rays", "raster"}, keys = offered("raywatt run --set tni.t", 4);
  EXPECT_EQ(std::ranges::count(keys, "tni.trvs="), 1);
  EXPECT_EQ(std::ranges::count(keys, "FILES"), 0);
  EXPECT_EQ(offered("raywatt run --set render.primary=", 4), rays);
  EXPECT_EQ(offered("raywatt run --set=render.primary=ra", 3), rays);
  EXPECT_EQ(offered("raywatt run --set cores=", 4), Words{});
}

TEST_F(OtherShells, FishParsesItsScriptAndOffersNames) {
  if (!has("fish")) GTEST_SKIP() << "there is no fish";
  const std::filesystem::path script = folder.write("raywatt.fish", printed({"completion", "fish"}));
  const std::string home = "HOME='" + folder.path().string() + "' ";
  EXPECT_EQ(std::system((home + "fish -n '" + script.string() + "'").c_str()), 0);
  const auto offered = [&](const std::string& line) {
    Words words =
        lines_of_command(home + "fish --no-config -c 'source " + script.string() + "; complete -C \"" + line + "\"'");
    for (std::string& word : words) word.erase(std::min(word.find('\t'), word.size()));
    return words;
  };
  EXPECT_EQ(offered("raywatt run --scene teap"), Words{"teapot"});
  EXPECT_EQ(offered("raywatt optimise --launcher s"), Words{"slurm"});
  EXPECT_EQ(offered("raywatt sweep ca"), Words{"cancel"});
  EXPECT_EQ(offered("raywatt run --program multirate:un"), Words{"multirate:under"});
  EXPECT_EQ(offered("raywatt run --set tni.trvs"), Words{"tni.trvs="});
  EXPECT_EQ(offered("raywatt run --set render.primary=ras"), Words{"render.primary=raster"});
  EXPECT_EQ(offered("raywatt run --set cores="), Words{});
  EXPECT_EQ(offered("raywatt energy price --set energy.ext"), Words{"energy.extends="});
}

TEST(Completion, ShellsAreChecked) { expect_refusal(raywatt({"completion", "csh"}), {"csh", "bash", "zsh", "fish"}); }

TEST(ManualPage, HasEveryVerbAndIsNoRequestByAccident) {
  const std::string page = printed({"man"});
  for (const char* part :
       {".TH RAYWATT 1", ".SS raywatt run\n", ".SS raywatt trace replay\n", ".SS raywatt sweep best\n",
        "\\fB\\-o, \\-\\-output\\fR", ".SH EXIT STATUS", "\n.TP\n2\nbad input, an output that cannot be written, ",
        "\n.TP\n130\ninterrupted", "\n.TP\n143\n"}) {
    EXPECT_NE(page.find(part), std::string::npos) << part;
  }
  const Words requests = {"TH", "SH", "SS", "TP", "PP", "nf", "fi", "B "};
  for (std::size_t at = page.find("\n."); at != std::string::npos; at = page.find("\n.", at + 1)) {
    EXPECT_TRUE(std::ranges::count(requests, page.substr(at + 2, 2)) == 1) << page.substr(at, 40);
  }
}

}  // namespace
}  // namespace test
