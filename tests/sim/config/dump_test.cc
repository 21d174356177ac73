#include <gtest/gtest.h>

#include "harness.h"
#include "sim/config/config.h"
#include "sim/config/quantity.h"

namespace sim::test {
namespace {

MachineConfig unusual() {
  MachineConfig c;
  c.direct = false;
  c.seed = ~std::uint64_t{0};
  c.threshold = 0.1 + 0.2;
  c.name = "line\nbreak \"quoted\" \\ # no comment: \xc3\xa9";
  c.clock.hz = 1'333'333'333;
  c.fabric.time = 18'125'001;
  c.refresh = {1e-9, 1.0 / 3, 1e22};
  c.events = {{"a b: c", {0, 0, 0}}, {"null", {1, 2, 3}}, {"tni.box_test@16KiB", {0.1, 0.2, 0.3}}};
  c.unit.stack = Stack::kRestart;
  c.unit.prefetch = Mode::kOn;
  c.l2 = {{3 * 1024}, {32}, 3};
  return c;
}

TEST(DumpConfig, LoadsBackToTheSameConfigurationAndTheSameDump) {
  for (const MachineConfig& c : {MachineConfig{}, unusual()}) {
    ConfigHarness b;
    const std::string dump = dump_config(c);
    const MachineConfig back = b.load(dump);
    EXPECT_EQ(back, c) << dump;
    EXPECT_EQ(dump_config(back), dump);
  }
}

TEST(DumpConfig, GivesNumbersAPointThatYaml11ReadersNeed) {
  MachineConfig c;
  c.threshold = 1e-05;
  c.refresh = {1e-9, 2.5e-7, 1e22};
  c.events = {{"step", {3e-7, 3e-7, 3e-7}}};
  const std::string dump = dump_config(c);
  for (const char* line :
       {"threshold: 1.0e-05  #", "refresh: {low: 1.0e-09, nominal: 2.5e-07, high: 1.0e+22}  #", "  step: 3.0e-07\n"}) {
    EXPECT_NE(dump.find(line), std::string::npos) << dump;
  }
  const ConfigNode tree = config_tree(c);
  EXPECT_NE(dump_tree(tree, Comments::kOff).find("threshold: 1e-05\n"), std::string::npos)
      << "hashes stay as they were";
}

TEST(DumpConfig, ShowsEveryFieldWithUnitAndMeaning) {
  MachineConfig c;
  c.events["tni.box_test"] = {1, 2, 3};
  EXPECT_EQ(dump_config(c), R"(direct: true  # rays go straight to the unit
seed: 7  # of the hash
threshold: 0.1  # similarity
name: "plain"  # in reports
clock: 500 MHz  # of the unit
fabric: 50 ns  # to memory
refresh: {low: 1, nominal: 2, high: 3}  # [pJ] of a bank
events:  # [pJ] of one event
  tni.box_test: {low: 1, nominal: 2, high: 3}
unit:  # traversal unit
  rays: 32  # [rays] rays held at once
  stack: full  # where far children wait | full: all of them
  prefetch: "off"  # next line on a miss
  l1:  # private cache
    size: 16 KiB  # data held
    line: 64 B  # data of one line
    ways: 4  # [ways] lines of a set
l2:  # shared cache
  size: 16 KiB  # data held
  line: 64 B  # data of one line
  ways: 4  # [ways] lines of a set
)");
}

TEST(DumpConfig, IsReadBackFromReadersThatTakeOffAndOnForBooleans) {
  ConfigHarness b;
  EXPECT_EQ(b.load("unit: {prefetch: true}\n").unit.prefetch, Mode::kOn);
  EXPECT_EQ(b.load("unit: {prefetch: false}\n").unit.prefetch, Mode::kOff);
  EXPECT_EQ(b.load("seed: 1\n", {"unit.prefetch=\"on\""}).unit.prefetch, Mode::kOn);
  EXPECT_NE(b.error("unit: {stack: false}\n").find("allowed: full, short, restart"), std::string::npos);
}

TEST(ConfigHash, ChangesWithItsFieldsOnly) {
  const MachineConfig plain;
  MachineConfig timing, walk;
  timing.unit.rays = 1;
  walk.unit.stack = Stack::kShort;
  EXPECT_EQ(config_hash(plain).size(), 64U);
  EXPECT_NE(config_hash(plain), config_hash(timing));
  EXPECT_NE(config_hash(plain, Affects::kTiming), config_hash(timing, Affects::kTiming));
  EXPECT_EQ(config_hash(plain, Affects::kWalk), config_hash(timing, Affects::kWalk));
  EXPECT_NE(config_hash(plain, Affects::kWalk), config_hash(walk, Affects::kWalk));
}

TEST(ListFields, GivesEveryFieldAsASetArgument) {
  const MachineConfig c = unusual();
  const std::vector<FieldInfo> fields = list_fields(c);
  std::vector<std::string> sets;
  for (const FieldInfo& field : fields) sets.push_back(field.path + "=" + field.value);
  EXPECT_EQ(ConfigHarness().load("seed: 1\n", sets), c);
  ASSERT_EQ(fields.size(), 17U);
  const FieldInfo& stack = fields.at(9);
  EXPECT_EQ(stack.path, "unit.stack");
  EXPECT_EQ(stack.kind, FieldKind::kEnum);
  EXPECT_EQ(stack.affects, Affects::kWalk);
  EXPECT_EQ(stack.value, "restart");
  EXPECT_EQ(stack.choices, (std::vector<std::string>{"full", "short", "restart"}));
  EXPECT_EQ(fields.at(8).kind, FieldKind::kUint32);
  EXPECT_EQ(fields.at(8).limits.max, 64);
  EXPECT_EQ(fields.at(8).unit, "rays");
}

TEST(ConfigJson, HasNumbersAsNumbersAndQuantitiesAsText) {
  const Json json = config_json(MachineConfig{});
  EXPECT_EQ(json.at("unit").at("rays"), 32);
  EXPECT_EQ(json.at("unit").at("l1").at("size"), "16 KiB");
  EXPECT_EQ(json.at("direct"), true);
  EXPECT_EQ(json.at("refresh").at("nominal"), 2.0);
  EXPECT_EQ(json.at("unit").at("stack"), "full");
  EXPECT_TRUE(json.at("events").is_object());
}

TEST(ConfigSchema, DescribesEveryFieldAndNothingElse) {
  const Json schema = config_schema<MachineConfig>();
  const Json& unit = schema.at("properties").at("unit");
  EXPECT_EQ(unit.at("additionalProperties"), false);
  EXPECT_EQ(unit.at("properties").at("rays").at("anyOf").at(0).at("maximum"), 64);
  EXPECT_EQ(unit.at("properties").at("rays").at("default"), 32);
  EXPECT_EQ(unit.at("properties").at("stack").at("enum").size(), 3U);
  EXPECT_EQ(unit.at("properties").at("prefetch").at("enum"), (Json{"off", "on", "alternate", false, true}));
  EXPECT_EQ(unit.at("properties").at("extends").at("type"), "string");
  EXPECT_EQ(schema.at("properties").at("clock").at("pattern"), "^[0-9]+(\\.[0-9]+)? *(Hz|kHz|MHz|GHz)$");
}

TEST(ConfigManual, HasATableForEachGroup) {
  const std::string manual = config_manual(MachineConfig{});
  EXPECT_NE(manual.find("| `rays` | `32` | rays | 1 to 64 | timing | rays held at once |\n"), std::string::npos);
  EXPECT_NE(manual.find("where far children wait \\| full"), std::string::npos);
  EXPECT_NE(manual.find("## unit.l1\n\nprivate cache\n\n"), std::string::npos);
}

TEST(Quantities, AreExact) {
  EXPECT_EQ(quantity_text(1536, byte_units()), "1536 B");
  EXPECT_EQ(quantity_text(3 << 20, byte_units()), "3 MiB");
  EXPECT_EQ(quantity_text(0, duration_units()), "0 fs");
  EXPECT_EQ(read_quantity("1.5 KiB", byte_units()), 1536U);
  EXPECT_EQ(read_quantity("0.469 ns", duration_units()), 469'000U);
  EXPECT_EQ(read_quantity("18446744073709551615B", byte_units()), ~std::uint64_t{0});
}

}  // namespace
}  // namespace sim::test
