#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/temp_folder.h"
#include "tests/tools/program.h"
#include "tools/host/build_info.h"

// Tests of an installation in its own folder.

namespace test {
namespace {

namespace fs = std::filesystem;

struct Installation : testing::Test {
  static void SetUpTestSuite() {
    folder = new TempFolder;
#ifdef RAYWATT_SANITIZED
    return;
#endif
    const std::string command = "cmake --install '" + std::string(tools::build_info().binary_dir) + "' --prefix '" +
                                root().string() + "' >/dev/null";
    ASSERT_EQ(std::system(command.c_str()), 0);
  }
  static void TearDownTestSuite() {
    delete folder;
    folder = nullptr;
  }
  void SetUp() override {
#ifdef RAYWATT_SANITIZED
    GTEST_SKIP() << "builds under sanitizers are not installed";
#endif
  }
  static fs::path root() { return folder->path() / "usr"; }
  static ProcessResult installed(const Words& arguments) {
    return raywatt(arguments, {.folder = folder->path(), .program = root() / "bin" / "raywatt"});
  }
  static TempFolder* folder;
};
TempFolder* Installation::folder = nullptr;

TEST_F(Installation, HasWhatTheProgramAndItsUsersNeed) {
  for (const char* file :
       {"bin/raywatt", "lib/raywatt/modules/raywatt_images.so", "lib/raywatt/modules/raywatt_search.so",
        "share/raywatt/configs/sgrt-2016.yaml", "share/raywatt/workloads/lee2016-car.yaml",
        "share/raywatt/published/lee2016.yaml", "share/raywatt/python/raywatt/__init__.py",
        "share/doc/raywatt/README.md", "share/doc/raywatt/copyright", "share/man/man1/raywatt.1.gz",
        "share/bash-completion/completions/raywatt", "share/zsh/vendor-completions/_raywatt",
        "share/fish/vendor_completions.d/raywatt.fish"}) {
    EXPECT_TRUE(fs::is_regular_file(root() / file)) << file;
  }
}

TEST_F(Installation, HasTheLicencesOfTheLockedLibrariesOfPages) {
  if (!fs::exists(root() / "share/raywatt/report_page/libraries.js"))
    GTEST_SKIP() << "no scripts of pages were bundled";
  std::ifstream file(root() / "share/doc/raywatt/copyright");
  const std::string copyright(std::istreambuf_iterator<char>(file), {});
  EXPECT_NE(copyright.find("Files: *\nCopyright: 2026 the Raywatt maintainers\nLicense: Apache-2.0\n"),
            std::string::npos);
  const nlohmann::json lock = read_json("tools/report_page/package-lock.json")["packages"];
  for (const auto& [name, asked] : lock[""]["dependencies"].items()) {
    const std::string package = "node_modules/" + name;
    EXPECT_NE(copyright.find("\n " + package + "/*\n"), std::string::npos) << name;
    const std::string version = name + " " + lock[package]["version"].get<std::string>();
    EXPECT_NE(copyright.find("\n " + version + "\n"), std::string::npos) << version;
  }
  for (const char* holder :
       {"\n 2015-2023, University of Washington Interactive Data Lab\n", "\n 2015, Mike Bostock\n"}) {
    EXPECT_NE(copyright.find(holder), std::string::npos) << holder;
  }
}

TEST_F(Installation, RendersAndWritesPictures) {
  const ProcessResult ending = installed(small_run(folder->path() / "out"));
  EXPECT_EQ(ending.exit, 0) << ending.err;
  EXPECT_TRUE(fs::exists(folder->path() / "out" / "image.png"));
}

TEST_F(Installation, ReadsItsOwnPresetsAndNotThoseOfTheSources) {
  const fs::path presets = root() / "share/raywatt/configs";
  std::ofstream(presets / "mine.yaml") << "extends: sgrt-2016\ncores: 3\n";
  fs::rename(presets / "sgrt-2016.yaml", presets / "other.yaml");
  const ProcessResult missing = installed({"config", "show", "sgrt-2016"});
  fs::rename(presets / "other.yaml", presets / "sgrt-2016.yaml");
  expect_refusal(missing, {"no configuration is called 'sgrt-2016'"});
  const ProcessResult shown = installed({"config", "show", "mine"});
  EXPECT_EQ(shown.exit, 0) << shown.err;
  EXPECT_NE(shown.out.find("cores: 3"), std::string::npos);
}

TEST_F(Installation, NamesTheSearchedFoldersIfThereAreNoConfigurations) {
  const fs::path share = root() / "share/raywatt";
  fs::rename(share, root() / "share/away");
  const ProcessResult alone = installed({"run"});
  fs::rename(root() / "share/away", share);
  expect_refusal(alone, {"no configuration is called 'sgrt-2016'; none is known",
                         "no configurations in " + share.string(), "RAYWATT_PATH"});
}

}  // namespace
}  // namespace test
