#include <cstdint>
#include <fstream>

#include <gtest/gtest.h>
#include <zstd.h>

#include "tests/tools/program.h"

// A trace written by hand, byte by byte as docs/trace-format.md says, by somebody who has nothing else of ours.

namespace test {
namespace {

using Json = nlohmann::ordered_json;

std::string block(const std::string& content) {
  ZSTD_CCtx* context = ZSTD_createCCtx();
  ZSTD_CCtx_setParameter(context, ZSTD_c_checksumFlag, 1);
  std::string packed(ZSTD_compressBound(content.size()), '\0');
  packed.resize(ZSTD_compress2(context, packed.data(), packed.size(), content.data(), content.size()));
  ZSTD_freeCCtx(context);
  return packed;
}

std::string number(std::uint64_t value, int bytes) {
  std::string out;
  for (; bytes > 0; --bytes, value >>= 8) out += static_cast<char>(value & 0xff);
  return out;
}

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

// Of the four rays three go to the first leaf and hit there; the last goes to the second leaf, first to hit of two
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

std::string trace(const std::string& walks, bool levels = false, const Json& made_by = nullptr) {
  Json header = {{"program", "full:1"},
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
  if (!made_by.is_null()) header["made_by"] = made_by;
  std::string file = "raywatt-trace/2\n";
  const std::string packed = block(header.dump());
  file += number(packed.size(), 4) + packed;
  Json contents;
  const auto put = [&](const std::string& content) {
    const std::string all = block(content);
    const Json place = {{"offset", file.size()}, {"bytes", all.size()}};
    file += all;
    return place;
  };
  Json tree = put(levels ? kLevels : kTree);
  tree["nodes"] = levels ? 2 : 1;
  tree["counts"] = {{"triangles", 3},
                    {"attributes", 3},
                    {"vertices", 0},
                    {"materials", 1},
                    {"details", 0},
                    {"textures", Json::array()},
                    {"instances", levels ? 2 : 0},
                    {"trees", levels ? 1 : 0}};
  contents["trees"].push_back(tree);
  const std::string tiles[] = {block(tile(0, walks)), block(tile(1, walks))};
  const std::size_t first = file.size();
  std::string sizes;
  for (const std::string& t : tiles) {
    file += t;
    sizes += number(t.size(), 4);
  }
  contents["parts"].push_back({{"frame", 0},
                               {"program", "program"},
                               {"tree", 0},
                               {"demands", {{"tile_samples", 4}, {"attribute_bytes", 0}, {"region_bytes", {32, 0, 0}}}},
                               {"tiles", 2},
                               {"offset", first},
                               {"sizes", put(sizes)},
                               {"result",
                                {{"rays", {8, 0, 0, 0}},
                                 {"traversal_steps", 18},
                                 {"continued", 0},
                                 {"sampling", {{"wanted", 8}, {"traced", 8}}}}}});
  contents["frames"].push_back({{"frame", 0}, {"squared_error", 0.0}});
  const Json place = put(contents.dump());
  return file + number(place["offset"], 8) + number(place["bytes"], 4) + "end\n";
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
    const std::string file = folder.write("a.trace", trace(bits(), false, made_by)).string();
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

}  // namespace
}  // namespace test
