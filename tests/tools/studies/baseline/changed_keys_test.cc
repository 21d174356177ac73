#include <set>

#include <gtest/gtest.h>

#include "hw_models/machines/unit_kinds.h"
#include "sim/config/config.h"
#include "tools/run/frame/load_config.h"
#include "tools/studies/baseline/check.h"

// Tests of finding the unit that a configuration key belongs to.

namespace tools {
namespace {

TEST(UnitOfKey, IsTheKindOfUnitsOfTheInnermostGroup) {
  EXPECT_EQ(unit_of_key("tni.trv.l1.size"), "core.tni.trv");
  EXPECT_EQ(unit_of_key("tni.trv.rays"), "core.tni.trv");
  EXPECT_EQ(unit_of_key("tni.ist.l1.mshrs"), "core.tni.ist");
  EXPECT_EQ(unit_of_key("tile_buffer.size"), "core.tile_buffer");
  EXPECT_EQ(unit_of_key("srp.latency.fp_add"), "core.srp");
  EXPECT_EQ(unit_of_key("raster.l1.ways"), "core.raster");
  EXPECT_EQ(unit_of_key("dma.depth"), "core.dma");
}

TEST(UnitOfKey, IsTheOnlyKindInsideTheGroup) {
  EXPECT_EQ(unit_of_key("l2.mshrs"), "l2.bank");
  EXPECT_EQ(unit_of_key("dram.timing.rl"), "dram.channel");
}

TEST(UnitOfKey, IsTheOutermostGroupIfItHasSeveralKindsOrNone) {
  EXPECT_EQ(unit_of_key("tni.miss_handling"), "tni");
  EXPECT_EQ(unit_of_key("tni.rau.rows"), "tni");
  EXPECT_EQ(unit_of_key("direct_interface.interval"), "direct_interface");
  EXPECT_EQ(unit_of_key("interconnect.latency"), "interconnect");
  EXPECT_EQ(unit_of_key("clocks.tni"), "clocks");
  EXPECT_EQ(unit_of_key("render.raster.batch"), "render") << "a setting of the function, no unit's";
  EXPECT_EQ(unit_of_key("area.arrays.l2@256KiB"), "area");
  EXPECT_EQ(unit_of_key("cores"), "");
}

TEST(UnitOfKey, IsAKindOfUnitsOrAGroupForEveryKey) {
  std::set<std::string> groups;
  const std::vector<sim::FieldInfo> fields = sim::list_fields(RunConfig{});
  for (const sim::FieldInfo& field : fields) groups.insert(field.path.substr(0, field.path.find('.')));
  for (const sim::FieldInfo& field : fields) {
    const std::string unit = unit_of_key(field.path);
    const bool is_kind = std::ranges::find(hw::kUnitKinds, unit, &hw::UnitKind::name) != hw::kUnitKinds.end();
    if (field.path.find('.') == std::string::npos) {
      EXPECT_EQ(unit, "") << field.path;
    } else {
      EXPECT_TRUE(is_kind || groups.contains(unit)) << field.path << ": " << unit;
    }
  }
}

TEST(UnitOfKey, CoversTheUnitsOfItsCounters) {
  EXPECT_TRUE(is_part_of("core.tni.trv", "core.tni.trv"));
  EXPECT_TRUE(is_part_of("core.tni.trv", "tni"));
  EXPECT_TRUE(is_part_of("l2.bank", "l2.bank"));
  EXPECT_FALSE(is_part_of("core.tni.trv", "core.tni.ist"));
  EXPECT_FALSE(is_part_of("core.dma_port", "core.dma"));
  EXPECT_FALSE(is_part_of("core.srp", "clocks"));
  EXPECT_FALSE(is_part_of("core.srp", ""));
}

TEST(ChangedKeys, ListKeysOfOnlyOneConfigurationSeparately) {
  const ChangedKeys keys = changed_keys({{"l2.mshrs", "32"}, {"l2.ways", "8"}, {"old", "1"}},
                                        {{"l2.mshrs", "8"}, {"l2.ways", "8"}, {"new.key", "2"}});
  EXPECT_EQ(changed_keys_text(keys.changed), "Changed in l2.bank: l2.mshrs was 32, is 8\n");
  EXPECT_EQ(changed_keys_text(keys.of_one), "Changed in new: new.key was none, is 2\nChanged: old was 1, is none\n");
}

TEST(ChangedKeys, MoreThanFourOfAGroupAreOneLine) {
  std::vector<KeyPair> keys = {{"dram.grade", "A", "B"}};
  for (const char* name : {"ccd_l", "faw", "ras", "rc"}) keys.push_back({std::string("dram.timing.") + name, "1", "2"});
  EXPECT_EQ(
      changed_keys_text(keys),
      "Changed in dram.channel: dram.grade was A, is B\nChanged in dram.channel: dram.timing.ccd_l was 1, is 2\n"
      "Changed in dram.channel: dram.timing.faw was 1, is 2\nChanged in dram.channel: dram.timing.ras was 1, is 2\n"
      "Changed in dram.channel: dram.timing.rc was 1, is 2\n");
  keys.push_back({"dram.timing.rcd", "1", "2"});
  EXPECT_EQ(changed_keys_text(keys),
            "Changed in dram.channel: dram.grade was A, is B\n"
            "Changed in dram.channel: dram.timing.ccd_l was 1, is 2, and 4 more keys of dram.timing\n");
}

TEST(ChangedKeys, AreGroupedByUnit) {
  EXPECT_EQ(changed_keys_text({{"l2.mshrs", "32", "8"}, {"cores", "4", "2"}, {"l2.ways", "8", "4"}}),
            "Changed in l2.bank: l2.mshrs was 32, is 8\nChanged in l2.bank: l2.ways was 8, is 4\n"
            "Changed: cores was 4, is 2\n");
}

}  // namespace
}  // namespace tools
