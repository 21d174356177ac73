#include "sim/report/table_checks.h"

#include <gtest/gtest.h>

#include "../folder.h"
#include "sim/error.h"

namespace sim::test {
namespace {

UnitReport unit(const char* path, const char* block, std::vector<UnitPart> parts = {}) {
  UnitReport u;
  u.path = path;
  u.block = block;
  u.parts = std::move(parts);
  return u;
}

/// Returns the reports of two kinds of units. One has a part whose number is a configuration key.
std::vector<UnitReport> units() {
  return {unit("core0.tni.trv0", "tni", {{"tester", 2}}), unit("core0.tni.trv1", "tni", {{"tester", 2}}),
          unit("core0.srp", "srp")};
}

template <class Config>
std::string refusal(const Config& config) {
  const Folder folder;
  return complaint<InputError>(folder, [&] { check_unit_names(config, units()); });
}

TEST(TableNames, EventsAreThoseThatCountersName) {
  EnergyConfig c;
  c.events = {{"box", {1, 2, 3}}, {"read@16KiB", {1, 2, 3}}, {"read@32KiB", {2, 3, 4}}};
  const Folder folder;
  const auto check = [&](const std::vector<std::string>& declared) {
    return complaint<InputError>(folder, [&] { check_energy_events(c, declared); });
  };
  EXPECT_EQ(check({"box", "read"}), "no error");
  EXPECT_EQ(check({"read"}), "energy.events.box: no counter names this event; allowed: read");
  EXPECT_EQ(check({"boxes", "read"}), "energy.events.box: no counter names this event; allowed: boxes, read");
  EXPECT_EQ(check({"bax", "read"}),
            "energy.events.box: no counter names this event, did you mean 'bax'?; allowed: bax, read");
  EXPECT_EQ(check({"box", "read", "write"}), "energy.events: no figure for 'write'");
}

TEST(TableNames, LogicAndFlopsAreOfUnitsOrBlocks) {
  EnergyConfig c;
  c.logic = {{"tni", {}}, {"tni.trv", {}}, {"srp", {}}};
  c.flops = {{"tni.trv", {}}, {"srp.srp", {}}};
  EXPECT_EQ(refusal(c), "no error");
  EnergyConfig logic = c, flops = c;
  logic.logic["tni.trvv"] = {};
  EXPECT_EQ(refusal(logic),
            "energy.logic.tni.trvv: no unit goes by this name, did you mean 'tni.trv'?; allowed: srp, srp.srp, tni, "
            "tni.trv");
  EnergyConfig sized = c;
  sized.logic["srp@16KiB"] = {};
  EXPECT_EQ(refusal(sized).substr(0, 50), "energy.logic.srp@16KiB: no unit goes by this name;");
  flops.flops["dram_controller"] = {};
  EXPECT_EQ(refusal(flops),
            "energy.flops.dram_controller: no unit goes by this name; allowed: srp, srp.srp, tni, tni.trv");
}

TEST(TableNames, PartsAreThoseThatUnitsHave) {
  EnergyConfig c;
  c.parts = {{"tni.trv.tester", {}}, {"tni.tester", {}}};
  c.parts_in_logic = {{"tni.trv.tester", {}}};
  EXPECT_EQ(refusal(c), "no error");
  EnergyConfig parts = c, held = c;
  parts.parts["tni.trv.testers"] = {};
  EXPECT_EQ(refusal(parts),
            "energy.parts.tni.trv.testers: no unit has a part of this name, did you mean 'tni.trv.tester'?; allowed: "
            "tni.tester, tni.trv.tester");
  held.parts_in_logic["srp.tester"] = {};
  EXPECT_EQ(refusal(held),
            "energy.parts_in_logic.srp.tester: no unit has a part of this name, did you mean 'tni.tester'?; allowed: "
            "tni.tester, tni.trv.tester");
}

TEST(TableNames, AreaIsOfUnitsOrBlocksAtAnySize) {
  AreaConfig c;
  c.arrays = {{"tni@16KiB", {}}, {"srp.srp@4KiB", {}}};
  c.buffers = {{"tni", {}}};
  c.pads = {{"srp", {}}};
  EXPECT_EQ(refusal(c), "no error");
  AreaConfig arrays = c, buffers = c, pads = c;
  arrays.arrays["tin@16KiB"] = {};
  EXPECT_EQ(refusal(arrays),
            "area.arrays.tin: no unit goes by this name, did you mean 'tni'?; allowed: srp, srp.srp, tni, tni.trv");
  buffers.buffers["sr"] = {};
  EXPECT_EQ(refusal(buffers),
            "area.buffers.sr: no unit goes by this name, did you mean 'srp'?; allowed: srp, srp.srp, tni, tni.trv");
  pads.pads["ddr"] = {};
  EXPECT_EQ(refusal(pads), "area.pads.ddr: no unit goes by this name; allowed: srp, srp.srp, tni, tni.trv");
}

}  // namespace
}  // namespace sim::test
