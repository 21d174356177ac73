#include <cstdint>
#include <fstream>
#include <functional>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/tools/jobs/trace_bytes.h"
#include "tests/tools/program.h"

// A trace written by hand, byte by byte as docs/trace-format.md says, by somebody who has nothing else of ours.

namespace test {
namespace {

using Json = nlohmann::ordered_json;

std::string bytes(std::initializer_list<int> values) {
  std::string out;
  for (const int value : values) out += static_cast<char>(value);
  return out;
}

// The root has two leaves: triangle 0; triangles 1 and 2.
const std::string kTree = bytes({0b0000'000'1, 0b0000'001'1});

// Two instances of a tree over all three triangles; behind the nodes, the tree of each.
const std::string kLevels = bytes({0b0000'000'1, 0b0000'000'1, 0b0000'010'1, 0, 1, 1});

// Four pixels: a kernel makes their rays, another looks at what they hit, 16 bytes go to the picture.
std::string tile(int index, const std::string& walks) {
  return bytes({0,
                index,
                4,
                /*after all*/ 0,
                /*after*/ 0,
                /*nodes*/ 4,
                /*launch*/ 0,
                4,
                /*kernel*/ 0,
                /*idle*/ 0,
                /*accesses*/ 0,
                /*inputs*/ 0,
                /*rays*/ 1,
                4,
                /*primary*/ 0,
                /*sources*/ 0,
                /*inputs*/ 1,
                /*each, one back*/ 1 << 1 | 1,
                /*launch*/ 0,
                4,
                /*kernel*/ 1,
                /*idle*/ 0,
                /*accesses*/ 1,
                /*inputs*/ 1,
                1 << 1 | 1,
                /*transfer*/ 2,
                16,
                /*picture*/ 0,
                /*to memory*/ 1,
                16 * index,
                /*inputs*/ 1,
                1 << 1,
                /*shapes: an item reads the attributes of its triangle*/ 1,
                1,
                0,
                /*triangles 0, 2, 2, 1*/ 0,
                4,
                0,
                1,
                /*rays*/ 4}) +
         walks;
}

// Three of the four rays go to the first leaf and hit there; the last goes to the second leaf, first to hit of two
// boxes, misses a triangle by its distance, hits the next, and what is on its stack lies behind that.
const std::string kWords = bytes({17, /*words*/ 1}) + [] {
  std::string out;
  for (int ray = 0; ray < 3; ++ray) {
    out += number(1U << 27, 4) + number(1U << 30 | 1U << 26 | 0, 4) + number(3, 4) + number(3U << 30 | 1, 4);
  }
  return out + number(1U << 29 | 3U << 27, 4) + number(1U << 30 | 2U << 26 | 1, 4) + number(0x31, 4) +
         number(2U << 30 | 1, 4) + number(3U << 30 | 1, 4) + std::string();
}();

/// Bits, given as '0' and '1', lowest first, as walks of so many words.
std::string as_walks(const std::string& all, int words) {
  std::string out((all.size() + 7) / 8, '\0');
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (all[i] == '1') out[i / 8] = static_cast<char>(out[i / 8] | (1 << (i % 8)));
  }
  return bytes({words, /*bits*/ 0}) + out;
}

/// The same as bits.
std::string bits() {
  std::string all;
  for (int ray = 0; ray < 3; ++ray) all += /*visit, the first box*/ "100" /*hit*/ "11" /*the end: a hit*/ "1";
  all +=    /*visit, both boxes, the second first*/
      "111" /*distance, hit*/
      "10"
      "11" /*cull all*/
      "10" /*a hit*/ "1";
  return as_walks(all, 17);
}

/// All rays hit the second instance's box and enter it, test the first triangle and hit it.
std::string bits_of_levels() {
  std::string all;
  for (int ray = 0; ray < 4; ++ray) all += /*the second box*/ "010" /*the only box*/ "100" /*hit*/ "110000" /*end*/ "1";
  return as_walks(all, 4 * 6);
}

/// A test's change to the contents of a file.
using Change = std::function<void(Json& header, Json& contents)>;

/// A file of one tree and one frame. `tree` and `part` are entries of the contents, without the offsets of blocks.
std::string file_of(Json header, const std::string& links, Json tree, const std::vector<std::string>& tiles, Json part,
                    const Change& change = {}, const Form& form = {}) {
  Json contents;
  if (change) change(header, contents);
  std::string file = "raywatt-trace/2\n";
  const std::string packed = block(header.dump());
  file += number(packed.size(), 4) + packed;
  const auto put = [&](const std::string& content) {
    const std::string all = block(content, form);
    const Json block = {{"offset", file.size()}, {"bytes", all.size()}};
    file += all;
    return block;
  };
  tree.update(put(links));
  contents["trees"].push_back(tree);
  part["offset"] = file.size();
  std::string sizes;
  for (const std::string& tile : tiles) sizes += number(put(tile)["bytes"], 4);
  part["tiles"] = tiles.size();
  part["sizes"] = put(sizes);
  contents["parts"].push_back(part);
  contents["frames"].push_back({{"frame", 0}, {"squared_error", 0.0}});
  if (change) change(header, contents);
  const Json block = put(contents.dump());
  return file + number(block["offset"], 8) + number(block["bytes"], 4) + "end\n";
}

std::string trace(const std::string& walks, bool levels = false, const Change& change = {}, const Form& form = {}) {
  const Json header = {{"program", "full:1"},
                       {"reference", ""},
                       {"resolution", {4, 2}},
                       {"scene",
                        {{"name", "three triangles"},
                         {"triangles", 3},
                         {"instances", 1},
                         {"lights", 0},
                         {"sha256", ""},
                         {"bvh_hash", ""}}},
                       {"kernels", {"generate_rays", "shade_surface"}},
                       {"function", Json::object()},
                       {"given", {{"render.width", "4"}, {"render.height", "2"}}},
                       {"config", ""}};
  const Json tree = {{"nodes", levels ? 2 : 1},
                     {"counts",
                      {{"triangles", 3},
                       {"attributes", 3},
                       {"vertices", 0},
                       {"materials", 1},
                       {"details", 0},
                       {"textures", Json::array()},
                       {"instances", levels ? 2 : 0},
                       {"trees", levels ? 1 : 0}}}};
  const Json part = {{"frame", 0},
                     {"program", "program"},
                     {"tree", 0},
                     {"demands", {{"tile_samples", 4}, {"attribute_bytes", 0}, {"region_bytes", {32, 0, 0}}}},
                     {"result",
                      {{"rays", {8, 0, 0, 0}},
                       {"traversal_steps", 18},
                       {"continued", 0},
                       {"sampling", {{"wanted", 8}, {"traced", 8}}}}}};
  return file_of(header, levels ? kLevels : kTree, tree, {tile(0, walks), tile(1, walks)}, part, change, form);
}

nlohmann::json played(const TempFolder& folder, const std::string& name, const std::string& content,
                      const std::string& set = "cores=4") {
  const std::string file = folder.write(name + ".trace", content).string();
  const std::filesystem::path out = folder.path() / name;
  const Ending ending = raywatt({"trace", "replay", "sgrt-2016", file, "--set", set, "-o", out.string()});
  EXPECT_EQ(ending.exit, 0) << ending.err;
  const Ending info = raywatt({"trace", "info", file});
  EXPECT_EQ(info.exit, 0) << info.err;
  EXPECT_SAYS(info.out, "three triangles");
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
  const auto replay = [&](const Json& made_by) {
    const auto change = [&](Json& header, Json&) { header["made_by"] = made_by; };
    const std::string file = folder.write("a.trace", trace(bits(), false, change)).string();
    return raywatt({"trace", "replay", "sgrt-2016", file, "-o", (folder.path() / "out").string()});
  };
  // render.height and render.width are given and are not among the keys of its `function`.
  expect_refusal(replay({{"model_id", "of last year"}}),
                 {"a.trace", "was recorded by another build", "without the key render.height", "2 is asked for",
                  "allowed: the default, 512"});
  EXPECT_EQ(replay({{"program", "another renderer"}}).exit, 0) << "who has no model keeps no list";
  const Ending version = raywatt({"run", "--resolution", "8x8", "-o", (folder.path() / "run").string()});
  EXPECT_EQ(version.exit, 0) << version.err;
  const auto id = read_json(folder.path() / "run" / "report.json")["provenance"]["model_id"].get<std::string>();
  EXPECT_EQ(replay({{"model_id", id}}).exit, 0) << "this build left out what it knew of";
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

// The example of docs/trace-format.md: one ray that hits one triangle.
TEST(HandMadeTrace, PlaysTheSmallestFile) {
  const Json header = Json::parse(R"({
    "program": "full:1", "reference": "", "resolution": [1, 1],
    "scene": {"name": "a triangle", "triangles": 1, "instances": 1, "lights": 0, "sha256": "", "bvh_hash": ""},
    "kernels": ["generate_rays"],
    "function": {}, "given": {"render.width": "1", "render.height": "1"}, "config": ""})");
  const Json tree = Json::parse(R"({
    "nodes": 1, "counts": {"triangles": 1, "attributes": 0, "vertices": 0, "materials": 0, "details": 0,
                           "textures": [], "instances": 0, "trees": 0}})");
  const Json part = Json::parse(R"({
    "frame": 0, "program": "program", "tree": 0,
    "demands": {"tile_samples": 1, "attribute_bytes": 0, "region_bytes": [0, 0, 0]},
    "result": {"rays": [1, 0, 0, 0], "traversal_steps": 2, "sampling": {"wanted": 1, "traced": 1}}})");
  const std::string tile = bytes({0, 0, 1, /*after*/ 0, 0, /*nodes*/ 3}) +
                           bytes({/*launch*/ 0, 1, /*kernel, idle, accesses, inputs*/ 0, 0, 0, 0}) +
                           bytes({/*rays*/ 1, 1, /*primary, no sources*/ 0, 0, /*each, one back*/ 1, 3}) +
                           bytes({/*launch*/ 0, 1, /*kernel, idle, accesses*/ 0, 0, 0, /*each, one back*/ 1, 3}) +
                           bytes({/*rays*/ 1, /*words*/ 4, /*as words*/ 1}) + number(0x08000000, 4) +
                           number(0x44000000, 4) + number(0x00000003, 4) + number(0xc0000001, 4);
  const std::string content = file_of(header, bytes({1, 0}), tree, {tile}, part);
  const TempFolder folder;
  const std::string file = folder.write("smallest.trace", content).string();
  const std::filesystem::path out = folder.path() / "out";
  const Ending ending = raywatt({"trace", "replay", "sgrt-2016", file, "-o", out.string()});
  EXPECT_EQ(ending.exit, 0) << ending.err;
  const nlohmann::json totals = read_json(out / "report.json")["totals"];
  EXPECT_EQ(totals["rays"]["total"], 1);
  EXPECT_EQ(totals["traversal_steps"], 2);
}

class BadHandMadeTrace : public ::testing::Test {
 protected:
  Ending replay(const std::string& content, const Words& config = {"sgrt-2016"}) const {
    Words words = {"trace", "replay"};
    words.insert(words.end(), config.begin(), config.end());
    words.insert(words.end(), {folder_.write("a.trace", content).string(), "-o", (folder_.path() / "out").string()});
    return raywatt(words);
  }
  /// With a header of which a key is another, or none.
  static std::string with(const std::string& pointer, const Json& value) {
    return trace(kWords, false, [&](Json& header, Json&) {
      const Json::json_pointer key(pointer);
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
    return trace(kWords, false, [&](Json&, Json& contents) {
      const Json::json_pointer key(pointer);
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

TEST_F(BadHandMadeTrace, WithoutAConfigurationAsksForOne) {
  expect_refusal(replay(trace(kWords), {}),
                 {"a.trace: has no configuration; give one: raywatt trace replay CONFIG ", "a.trace"});
}

TEST_F(BadHandMadeTrace, OfBlocksThatSayNothingOfTheirContentIsRefused) {
  expect_refusal(replay(trace(kWords, false, {}, {.checksum = false})), {"a.trace: has a block without a checksum"});
  expect_refusal(replay(trace(kWords, false, {}, {.size = false})), {"a.trace: has a block without a size"});
}

TEST_F(BadHandMadeTrace, WhoseTilesDemandMoreThanTheTileBufferSendsItsRaysThroughMemory) {
  const auto demanding = [](const std::string& key, const Json& value) {
    return trace(kWords, false, [&](Json&, Json& contents) {
      if (contents.contains("parts")) contents["parts"][0]["demands"][key] = value;
    });
  };
  const auto spilled = [&](const std::string& content) {
    const Ending ending = replay(content);
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

TEST(HandMadeTrace, OfFormerBuildsPlaysWithKeysThatNothingReads) {
  const TempFolder folder;
  played(folder, "former", trace(kWords, false, [](Json& header, Json&) {
           header["function"] = {{"limits.memory", "7 GiB"}, {"limits.gone", "1"}, {"supersample.colour", "0.9"}};
         }));
}

}  // namespace
}  // namespace test
