#include <gtest/gtest.h>
#include <sys/stat.h>

#include "harness.h"
#include "tests/param_name.h"

namespace sim::test {
namespace {

struct Case {
  const char* text;
  const char* complaint;
};
void PrintTo(const Case& c, std::ostream* out) { *out << c.text; }
std::string case_name(const ::testing::TestParamInfo<Case>& info) {
  const std::string name = ::test::name_of_text(info.param.text);
  return name.substr(0, 40) + (name.empty() ? "" : "_") + std::to_string(info.index);
}

class ConfigError : public ::testing::TestWithParam<Case> {};

TEST_P(ConfigError, NamesFileLineColumnKeyAndWhatIsAllowed) {
  EXPECT_EQ(ConfigHarness().error(GetParam().text), GetParam().complaint);
}

INSTANTIATE_TEST_SUITE_P(
    Values, ConfigError,
    ::testing::Values(
        Case{"seed: 1\nunit:\n  rays: l33t\n",
             "a.yaml:3:9: unit.rays: 'l33t' is not a whole number; allowed: 1 to 64 rays"},
        Case{"unit: {rays: 65}", "a.yaml:1:14: unit.rays: '65' is out of range; allowed: 1 to 64 rays"},
        Case{"unit: {rays: 99999999999}",
             "a.yaml:1:14: unit.rays: '99999999999' is out of range; allowed: 1 to 64 rays"},
        Case{"unit: {rays: 1.5}", "a.yaml:1:14: unit.rays: '1.5' is not a whole number; allowed: 1 to 64 rays"},
        Case{"unit: {rays: -1}", "a.yaml:1:14: unit.rays: '-1' is out of range; allowed: 1 to 64 rays"},
        Case{"unit: {rays: 6 cycles}",
             "a.yaml:1:14: unit.rays: '6 cycles' is not a whole number; allowed: 1 to 64 rays"},
        Case{"unit: {rays: [1]}",
             "a.yaml:1:14: unit.rays: is a list; allowed: one value, 1 to 64 rays; lists are for axes of a sweep "
             "(docs/sweeps.md)"},
        Case{"unit: {rays: {x: 1}}", "a.yaml:1:14: unit.rays: has no value; allowed: 1 to 64 rays"},
        Case{"unit:\n  rays:\n", "a.yaml:2:3: unit.rays: has no value; allowed: 1 to 64 rays"},
        Case{"seed: 18446744073709551616",
             "a.yaml:1:7: seed: '18446744073709551616' is out of range; allowed: at least 0"},
        Case{"direct: yes", "a.yaml:1:9: direct: 'yes' is not true or false; allowed: true, false"},
        Case{"threshold: nan", "a.yaml:1:12: threshold: 'nan' is not a number; allowed: -1 to 1"},
        Case{"threshold: 2", "a.yaml:1:12: threshold: '2' is out of range; allowed: -1 to 1"},
        Case{"unit: {stack: shrt}",
             "a.yaml:1:15: unit.stack: 'shrt' is not one of the choices; allowed: full, short, restart"},
        Case{"clock: 500", "a.yaml:1:8: clock: '500' has no unit (one of Hz, kHz, MHz, GHz); allowed: 1 MHz to 10 GHz"},
        Case{"clock: 500 mhz",
             "a.yaml:1:8: clock: '500 mhz' has the unknown unit 'mhz' (not one of Hz, kHz, MHz, GHz); allowed: 1 MHz "
             "to 10 GHz"},
        Case{"clock: fast", "a.yaml:1:8: clock: 'fast' is not a number with a unit; allowed: 1 MHz to 10 GHz"},
        Case{"clock: 20 GHz", "a.yaml:1:8: clock: '20 GHz' is out of range; allowed: 1 MHz to 10 GHz"},
        Case{"l2: {line: 0.3 B}",
             "a.yaml:1:12: l2.line: '0.3 B' is not a whole number of B; allowed: powers of two from 16 B to 256 B"},
        Case{"l2: {line: 48 B}",
             "a.yaml:1:12: l2.line: '48 B' is out of range; allowed: powers of two from 16 B to 256 B"},
        Case{"fabric: 99999999999999 s", "a.yaml:1:9: fabric: '99999999999999 s' is too large; allowed: 0 fs to 1 us"},
        Case{"refresh: 3 mW", "a.yaml:1:10: refresh: '3 mW' is not a number; allowed: at least 0 pJ"},
        Case{"refresh: {low: 1, nominal: 2}", "a.yaml:1:10: refresh: is incomplete; allowed: low, nominal and high"},
        Case{"refresh: {low: 1, mid: 2}", "a.yaml:1:19: refresh.mid: unknown key; allowed: low, nominal, high"},
        Case{"refresh: {low: 1, nominal: x, high: 3}",
             "a.yaml:1:28: refresh.nominal: 'x' is not a number; allowed: at least 0 pJ"},
        Case{"refresh: {low: 3, nominal: 2, high: 1}",
             "a.yaml:1:10: refresh: '{low: 3, nominal: 2, high: 1}' is not in order; allowed: low <= nominal <= high"},
        Case{"events: 3", "a.yaml:1:9: events: '3' is not a mapping of names to figures; allowed: at least 0 pJ"},
        Case{"events: {a: -1}", "a.yaml:1:13: events.a: '-1' is out of range; allowed: at least 0 pJ"},
        Case{"unit: 3", "a.yaml:1:7: unit: is a group of fields; allowed: a mapping"},
        Case{"seed: 1\nl2: {line: 32 B, size: 100 B}", "a.yaml:2:18: l2.size: is no whole number of sets"},
        Case{"l2: {ways: 3}", "a.yaml:1:1: l2.size: is no whole number of sets"}),
    case_name);

INSTANTIATE_TEST_SUITE_P(
    Keys, ConfigError,
    ::testing::Values(Case{"unit: {rasy: 1}", "a.yaml:1:8: unit.rasy: unknown key 'rasy'; did you mean 'unit.rays'?"},
                      Case{"stack: full", "a.yaml:1:1: stack: unknown key 'stack'; did you mean 'unit.stack'?"},
                      Case{"l2: {blue: 1}", "a.yaml:1:6: l2.blue: unknown key 'blue'; allowed: size, line, ways"},
                      Case{"seed: 1\nseed: 2", "a.yaml:2:1: the key 'seed' is given twice"},
                      Case{"? [a]\n: 1", "a.yaml:1:3: a key must be plain text"},
                      Case{"~: 1", "a.yaml:1:1: a key must be plain text"}),
    case_name);

INSTANTIATE_TEST_SUITE_P(
    Files, ConfigError,
    ::testing::Values(
        Case{"", "a.yaml: is empty; allowed: a mapping"}, Case{"# nothing\n", "a.yaml: is empty; allowed: a mapping"},
        Case{"~", "a.yaml: is empty; allowed: a mapping"},
        Case{"- 1\n- 2\n", "a.yaml:1:1: holds no 'key: value' at its top level"},
        Case{"seed", "a.yaml:1:1: holds no 'key: value' at its top level"},
        Case{"seed: 1\n---\nseed: 2\n", "a.yaml:2:1: a second document begins; allowed: one"},
        Case{"seed: !!int 1",
             "a.yaml:1:7: the tag 'tag:yaml.org,2002:int' has no meaning here; allowed: values without tags"},
        Case{"unit: &x {l1: *x}", "a.yaml:1:15: an alias stands inside the value it repeats"},
        Case{"unit: {rays: 1\nseed: 3\nl2: 4\n", "a.yaml:2:5: is not valid YAML: end of map flow not found"},
        Case{"name: \"plain\nseed: 1\n", "a.yaml:2:8: is not valid YAML: illegal EOF in scalar"},
        Case{"seed: 1\n\tunit: 2\n", "a.yaml:2:1: a tab indents this line; allowed: spaces"}),
    case_name);

TEST(ConfigFile, AliasBombsAreRefusedAtOnce) {
  std::string bomb = "a0: &a0 [x, x]\n";
  for (int i = 1; i < 64; ++i) {
    const std::string last = "*a" + std::to_string(i - 1);
    bomb += "a" + std::to_string(i) + ": &a" + std::to_string(i) + " [" + last + ", " + last + "]\n";
  }
  EXPECT_EQ(ConfigHarness().error(bomb + "unit: *a63\n").substr(0, 28), "a.yaml:1:1: a0: unknown key ");
}

TEST(ConfigFile, DeepNestingIsRefused) {
  const std::string deep = "unit: " + std::string(100'000, '[') + std::string(100'000, ']');
  EXPECT_NE(ConfigHarness().error(deep).find(": is nested too deeply"), std::string::npos);
}

TEST(ConfigFile, MustBeAReadableFileOfSensibleSize) {
  const ConfigHarness b;
  const auto load = [&](const char* name) {
    return complaint<InputError>(b.folder(), [&] { load_config<MachineConfig>(b.folder().path() / name); });
  };
  EXPECT_EQ(load("none.yaml"), "none.yaml: no such file");
  std::filesystem::create_directory(b.folder().path() / "folder.yaml");
  EXPECT_EQ(load("folder.yaml"), "folder.yaml: is a folder, not a file");
  ::mkfifo((b.folder().path() / "pipe.yaml").c_str(), 0600);
  EXPECT_EQ(load("pipe.yaml"), "pipe.yaml: is not a regular file");
  std::filesystem::create_symlink("loop.yaml", b.folder().path() / "loop.yaml");
  EXPECT_EQ(load("loop.yaml"), "loop.yaml: Too many levels of symbolic links");
  if (::geteuid() != 0) {
    ::chmod(b.folder().write("secret.yaml", "seed: 1").c_str(), 0);
    EXPECT_EQ(load("secret.yaml"), "secret.yaml: cannot be opened: Permission denied");
  }
  b.folder().write("large.yaml", std::string((4 << 20) + 1, '#'));
  EXPECT_EQ(load("large.yaml"), "large.yaml: is too large; allowed: 4194304 bytes");
}

TEST(ConfigFile, MessagesAreOneLineOfPrintableText) {
  const std::string message = ConfigHarness().error("unit: {\"ra\\nys\\e[31m\": 1}");
  EXPECT_EQ(message, "a.yaml:1:8: unit.ra?ys?[31m: unknown key 'ra?ys?[31m'; allowed: rays, stack, prefetch, l1");
}

TEST(ConfigRules, NameTheFileThatChangedTheOtherFieldOfTheRule) {
  ConfigHarness b;
  b.folder().write("base.yaml", "unit:\n  l1: {size: 1 KiB}\n");
  EXPECT_EQ(b.error("extends: base\nunit: {l1: {ways: 3}}\n"),
            "a.yaml:2:13: unit.l1.size: is no whole number of sets (base.yaml:2:8 has its value)");
  EXPECT_EQ(b.error("extends: base\nunit: {l1: {ways: 4, size: 100 B}}\n"),
            "a.yaml:2:22: unit.l1.size: is no whole number of sets");
}

TEST(ConfigRules, NameTheArgumentThatChangedTheOtherFieldOfTheRule) {
  const std::string file = "unit:\n  l1: {size: 1 KiB}\nl2: {size: 1 KiB}\n";
  EXPECT_EQ(ConfigHarness().error(file, {"unit.l1.ways=3", "unit.rays=8"}),
            "--set unit.l1.ways=3: unit.l1.size: is no whole number of sets (a.yaml:2:8 has its value)");
  EXPECT_EQ(
      ConfigHarness().error(file, {"unit.l1.ways=3", "unit.l1.line=128 B"}),
      "--set unit.l1.line=128 B, --set unit.l1.ways=3: unit.l1.size: is no whole number of sets (a.yaml:2:8 has its "
      "value)");
  EXPECT_EQ(ConfigHarness().error(file, {"unit.l1.size=100 B", "unit.l1.ways=4"}),
            "--set unit.l1.size=100 B: unit.l1.size: is no whole number of sets");
}

TEST(CheckConfig, NamesTheKeyOfAStructFilledInCode) {
  MachineConfig c;
  EXPECT_NO_THROW(check_config(c));
  c.unit.rays = 0;
  const Folder folder;
  EXPECT_EQ(complaint<InputError>(folder, [&] { check_config(c); }),
            "unit.rays: '0' is out of range; allowed: 1 to 64 rays");
  c.unit.rays = 1;
  c.l2.ways = 3;
  EXPECT_EQ(complaint<InputError>(folder, [&] { check_config(c); }), "l2.size: is no whole number of sets");
}

}  // namespace
}  // namespace sim::test
