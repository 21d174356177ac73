#include "tests/tools/run/hand_made_trace.h"

#include <cstdint>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/tools/program.h"

// Tests of replaying traces that are written byte by byte.

namespace test {
namespace {

nlohmann::json played(const TempFolder& folder, const std::string& name, const std::string& content,
                      const std::string& set = "cores=4") {
  const std::string file = folder.write(name + ".trace", content).string();
  const std::filesystem::path out = folder.path() / name;
  const ProcessResult ending = raywatt({"trace", "replay", "sgrt-2016", file, "--set", set, "-o", out.string()});
  EXPECT_EQ(ending.exit, 0) << ending.err;
  const ProcessResult info = raywatt({"trace", "info", file});
  EXPECT_EQ(info.exit, 0) << info.err;
  EXPECT_SAYS(info.out, "three triangles");
  EXPECT_SAYS(info.out, "raywatt-trace/3");
  return read_json(out / "report.json");
}

TEST(HandMadeTrace, PlaysWithWalksAsWordsAndAsBits) {
  const TempFolder folder;
  const nlohmann::json words = played(folder, "words", trace(kWords)), as_bits = played(folder, "bits", trace(bits()));
  const nlohmann::json& totals = words["totals"];
  EXPECT_EQ(totals["rays"]["primary"], 8);
  EXPECT_EQ(totals["rays"]["total"], 8);
  EXPECT_EQ(totals["traversal_steps"], 2 * (3 * 2 + 3)) << "visits and tests";
  EXPECT_EQ(totals["kernels"]["shade_surface"]["items"], 8);
  EXPECT_EQ(totals["dram_bytes_by_client"]["frame_buffer"], 128) << "a line a tile";
  EXPECT_EQ(words["scene"]["name"], "three triangles");
  EXPECT_EQ(words["resolution"], nlohmann::json({4, 2}));
  EXPECT_EQ(words["units"], as_bits["units"]);
}

TEST(HandMadeTrace, OfAnotherBuildMustHaveAllKeysThatAreNotTheirDefaults) {
  const TempFolder folder;
  const auto replay = [&](const OrderedJson& made_by) {
    const auto change = [&](OrderedJson& header, OrderedJson&) { header["made_by"] = made_by; };
    const std::string file = folder.write("a.trace", trace(bits(), false, change)).string();
    return raywatt({"trace", "replay", "sgrt-2016", file, "-o", (folder.path() / "out").string()});
  };
  // render.height and render.width are in `given`, not in `function`.
  expect_refusal(replay({{"model_id", "of last year"}}),
                 {"a.trace", "was recorded by another build", "without the key render.height", "2 is asked for",
                  "allowed: the default, 512"});
  EXPECT_EQ(replay({{"program", "another renderer"}}).exit, 0) << "who has no model keeps no list";
  const ProcessResult version = raywatt({"run", "--resolution", "8x8", "-o", (folder.path() / "run").string()});
  EXPECT_EQ(version.exit, 0) << version.err;
  const auto id = read_json(folder.path() / "run" / "report.json")["provenance"]["model_id"].get<std::string>();
  EXPECT_EQ(replay({{"model_id", id}}).exit, 0) << "this build left out what it knew of";
}

TEST(HandMadeTrace, OfManyStepsGetsAHintOfItsDuration) {
  const TempFolder folder;
  const std::string content = trace(bits(), false, [](OrderedJson&, OrderedJson& contents) {
    if (contents.contains("parts")) contents["parts"][0]["result"]["traversal_steps"] = 12'000'000'000;
  });
  const std::string file = folder.write("a.trace", content).string(), out = (folder.path() / "out").string();
  const auto said = [&](const Words& more) {
    Words words = {"trace", "replay", "sgrt-2016", file, "-o", out, "--force"};
    words.insert(words.end(), more.begin(), more.end());
    const ProcessResult ending = raywatt(words);
    EXPECT_EQ(ending.exit, 0) << ending.err;
    return ending.err;
  };
  const std::string hint = said({});
  EXPECT_TRUE(hint.starts_with("raywatt: this may take about ") && hint.ends_with(" min on this host\n")) << hint;
  EXPECT_EQ(said({"--quiet"}), "");
  EXPECT_EQ(said({"--progress", "none"}), "");
  EXPECT_EQ(said({"--progress", "json"}).find("may take"), std::string::npos);
}

TEST(HandMadeTrace, PlaysRaysThatEnterInstances) {
  const TempFolder folder;
  const std::string content = trace(bits_of_levels(), true);
  const nlohmann::json report = played(folder, "levels", content, "bvh.instances=two_level");
  EXPECT_EQ(report["totals"]["traversal_steps"], 8 * (2 + 1));
  std::uint64_t transforms = 0;
  for (const auto& [name, unit] : report["units"]["core0"]["tni"].items()) {
    if (name.starts_with("trv")) transforms += unit["counters"]["transforms"].get<std::uint64_t>();
  }
  EXPECT_GE(transforms, 4U) << "a tile's rays at least";
  const std::string file = folder.write("flat.trace", content).string();
  expect_refusal(raywatt({"trace", "replay", "sgrt-2016", file, "-o", (folder.path() / "out").string()}),
                 {"flat.trace", "two levels", "bvh.instances is flatten", "allowed: two_level"});
}

// The smallest trace: one ray that hits one triangle.
TEST(HandMadeTrace, PlaysTheSmallestFile) {
  const OrderedJson header = OrderedJson::parse(R"({
    "program": "full:1", "reference": "", "resolution": [1, 1],
    "scene": {"name": "a triangle", "triangles": 1, "instances": 1, "lights": 0, "sha256": "", "bvh_hash": ""},
    "kernels": ["generate_rays"],
    "function": {}, "given": {"render.width": "1", "render.height": "1"}, "config": ""})");
  const OrderedJson tree = OrderedJson::parse(R"({
    "nodes": 1, "counts": {"triangles": 1, "attributes": 0, "vertices": 0, "materials": 0, "details": 0,
                           "textures": [], "instances": 0, "trees": 0}})");
  const OrderedJson part = OrderedJson::parse(R"({
    "frame": 0, "program": "program", "tree": 0,
    "demands": {"tile_samples": 1, "attribute_bytes": 0, "region_bytes": [0, 0, 0]},
    "result": {"rays": [1, 0, 0, 0], "traversal_steps": 2, "sampling": {"wanted": 1, "traced": 1}}})");
  const std::string tile = bytes({0, 0, 1, /*after all, imports*/ 0, 0, /*nodes*/ 3}) +
                           bytes({/*launch*/ 0, 1, /*kernel, idle, accesses, inputs*/ 0, 0, 0, 0}) +
                           bytes({/*rays*/ 1, 1, /*primary, no sources*/ 0, 0, /*each, one back*/ 1, 3}) +
                           bytes({/*launch*/ 0, 1, /*kernel, idle, accesses*/ 0, 0, 0, /*each, one back*/ 1, 3}) +
                           bytes({/*rays*/ 1, /*words*/ 4, /*as words*/ 1}) + number(0x08000000, 4) +
                           number(0x44000000, 4) + number(0x00000003, 4) + number(0xc0000001, 4);
  const std::string content = file_of(header, bytes({1, 0}), tree, {tile}, part);
  const TempFolder folder;
  const std::string file = folder.write("smallest.trace", content).string();
  const std::filesystem::path out = folder.path() / "out";
  const ProcessResult ending = raywatt({"trace", "replay", "sgrt-2016", file, "-o", out.string()});
  EXPECT_EQ(ending.exit, 0) << ending.err;
  const nlohmann::json totals = read_json(out / "report.json")["totals"];
  EXPECT_EQ(totals["rays"]["total"], 1);
  EXPECT_EQ(totals["traversal_steps"], 2);
}

TEST(HandMadeTrace, OfFormerBuildsPlaysWithKeysThatNothingReads) {
  const TempFolder folder;
  played(folder, "former", trace(kWords, false, [](OrderedJson& header, OrderedJson&) {
           header["function"] = {{"limits.memory", "7 GiB"}, {"limits.gone", "1"}, {"supersample.colour", "0.9"}};
         }));
}

// Tests of invalid traces that are written byte by byte.

class BadHandMadeTrace : public ::testing::Test {
 protected:
  ProcessResult replay(const std::string& content, const Words& config = {"sgrt-2016"}) const {
    Words words = {"trace", "replay"};
    words.insert(words.end(), config.begin(), config.end());
    words.insert(words.end(), {folder_.write("a.trace", content).string(), "-o", (folder_.path() / "out").string()});
    return raywatt(words);
  }
  /// Expects an error for a header with a changed or removed key.
  static std::string with(const std::string& pointer, const OrderedJson& value) {
    return trace(kWords, false, [&](OrderedJson& header, OrderedJson&) {
      const OrderedJson::json_pointer key(pointer);
      if (value.is_null()) {
        header.at(key.parent_pointer()).erase(key.back());
      } else {
        header[key] = value;
      }
    });
  }

  TempFolder folder_;
};

TEST_F(BadHandMadeTrace, WithoutAKeyOfTheHeaderIsRefusedAndTheKeyNamed) {
  for (const std::string key : {"program", "reference", "resolution", "kernels", "function", "given", "config"}) {
    expect_refusal(replay(with("/" + key, nullptr)), {"a.trace: the header has no '" + key + "'"});
    expect_refusal(replay(with("/" + key, 7)), {"a.trace: '" + key + "' of the header is wrong; allowed: "});
  }
  for (const std::string key : {"name", "triangles", "instances", "lights", "sha256", "bvh_hash"}) {
    expect_refusal(replay(with("/scene/" + key, nullptr)), {"a.trace: the header has no 'scene." + key + "'"});
  }
  expect_refusal(replay(with("/scene", nullptr)), {"a.trace: the header has no 'scene.name'"});
  EXPECT_EQ(replay(with("/made_by", nullptr)).exit, 0) << "for people";
}

TEST_F(BadHandMadeTrace, WithoutAKeyOfTheContentsIsRefusedAndTheKeyNamed) {
  const auto without = [](const std::string& pointer) {
    return trace(kWords, false, [&](OrderedJson&, OrderedJson& contents) {
      const OrderedJson::json_pointer key(pointer);
      if (contents.contains(key)) contents.at(key.parent_pointer()).erase(key.back());
    });
  };
  for (const std::string pointer : {"/trees", "/trees/0/counts", "/parts/0/demands", "/parts/0/result", "/frames"}) {
    const std::string key = pointer.substr(pointer.rfind('/') + 1);
    expect_refusal(replay(without(pointer)), {"a.trace: has no key '" + key + "'"});
  }
}

TEST_F(BadHandMadeTrace, OfTwoResolutionsIsRefused) {
  expect_refusal(replay(with("/resolution", {2, 2})), {"a.trace: its resolution is 2x2", "render.width", "4x2"});
  expect_refusal(replay(with("/given/render.width", "8")), {"a.trace: its resolution is 4x2", "8x2"});
}

TEST_F(BadHandMadeTrace, WithoutAConfigurationNeedsOne) {
  expect_refusal(replay(trace(kWords), {}),
                 {"a.trace: has no configuration; give one: raywatt trace replay CONFIG ", "a.trace"});
}

TEST_F(BadHandMadeTrace, OfBlocksWithoutTheirContentSizeIsRefused) {
  expect_refusal(replay(trace(kWords, false, {}, {.checksum = false})), {"a.trace: has a block without a checksum"});
  expect_refusal(replay(trace(kWords, false, {}, {.size = false})), {"a.trace: has a block without a size"});
}

/// Returns a tile of `rays` rays with equal traversals.
std::string tile_of_equals(std::uint64_t rays) {
  const std::string count = varint(rays), each = bytes({1, 1 << 1 | 1});
  std::string all = bytes({0, 0, 4, 0, 0, /*nodes*/ 3, /*launch*/ 0}) + count + bytes({0, 0, 0, 0, /*rays*/ 1}) +
                    count + bytes({0, 0}) + each + bytes({/*launch*/ 0}) + count + bytes({1, 0, 0}) + each + count +
                    varint(4 * rays) + bytes({/*bits*/ 0});
  const std::string one = /*visit, the first box*/ "100" /*hit*/ "11" /*the end: a hit*/ "1";
  const std::string four = as_walks(one + one + one + one, 0).substr(2);
  for (std::uint64_t ray = 0; ray < rays; ray += 4) all += four;
  return all;
}

TEST_F(BadHandMadeTrace, OfFewBytesThatWouldTakeMuchMemoryIsRefused) {
  const std::string small = trace(kWords, false, {}, {}, {tile_of_equals(1U << 24)});
  EXPECT_LT(small.size(), 8192U);
  expect_refusal(replay(small), {"a.trace: frame 0, tile 0 of the list: has a block of ", " bytes that holds 125829",
                                 "; allowed: 262144"});
  const auto with_list = [](const std::string& of) {
    return trace(kWords, false, [&](OrderedJson& header, OrderedJson& contents) {
      (of == "header" ? header : contents)["more"] = std::vector<int>(1 << 20);
    });
  };
  for (const char* of : {"header", "contents"}) {
    expect_refusal(replay(with_list(of)), {"a.trace: has a block of ", " bytes that holds 209", "; allowed: 262144"});
  }
}

TEST_F(BadHandMadeTrace, WithRepeatedTilesOrImportsFromLaterOnesIsRefused) {
  expect_refusal(replay(trace(kWords, false, {}, {}, {tile(0, kWords), tile(0, kWords)})),
                 {"a.trace: tile 0 is there twice"});
  std::string importing = tile(0, kWords);
  constexpr std::size_t kImports = 4;
  ASSERT_EQ(importing.substr(kImports, 2), bytes({/*imports*/ 0, /*nodes*/ 4}));
  importing.replace(kImports, 2,
                    bytes({/*imports*/ 1, /*tile*/ 1, /*border*/ 0, /*nodes*/ 5, /*transfer*/ 2, 16, /*picture*/ 0,
                           /*from memory*/ 0, 0, /*border*/ 1, /*inputs*/ 0}));
  expect_refusal(replay(trace(kWords, false, {}, {}, {importing, tile(1, kWords)})),
                 {"a.trace: tile 0 imports from one that does not come before it"});
}

TEST_F(BadHandMadeTrace, WhoseTilesExceedTheTileBufferSendsItsRaysThroughMemory) {
  const auto demanding = [](const std::string& key, const OrderedJson& value) {
    return trace(kWords, false, [&](OrderedJson&, OrderedJson& contents) {
      if (contents.contains("parts")) contents["parts"][0]["demands"][key] = value;
    });
  };
  const auto spilled = [&](const std::string& content) {
    const ProcessResult ending = replay(content);
    EXPECT_EQ(ending.exit, 0) << ending.err;
    const nlohmann::json units = read_json(folder_.path() / "out" / "report.json")["units"];
    std::uint64_t slots = 0;
    for (const auto& [name, core] : units.items()) {
      if (!name.starts_with("core")) continue;
      slots += core["tile_buffer"]["counters"]["spilled_slots"].get<std::uint64_t>();
    }
    return slots;
  };
  EXPECT_EQ(spilled(trace(kWords)), 0U);
  EXPECT_GT(spilled(demanding("tile_samples", 1U << 26)), 0U);
  EXPECT_GT(spilled(demanding("attribute_bytes", 0xffffffffU)), 0U);
  EXPECT_EQ(spilled(demanding("region_bytes", {1ULL << 40, 0, 0})), 0U);
  expect_refusal(replay(demanding("tile_samples", (1U << 26) + 1)), {"a.trace: tile_samples is out of range"});
  expect_refusal(replay(demanding("attribute_bytes", 1ULL << 32)), {"a.trace: attribute_bytes is out of range"});
  expect_refusal(replay(demanding("region_bytes", {(1ULL << 40) + 1, 0, 0})),
                 {"a.trace: region_bytes is out of range"});
  expect_refusal(replay(demanding("region_bytes", {31, 0, 0})), {"a.trace", "bytes of a transfer is out of range"});
}

}  // namespace
}  // namespace test
