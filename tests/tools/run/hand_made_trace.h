#pragma once
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "tests/tools/run/trace_bytes.h"

// A trace file written byte by byte, following docs/trace-format.md and not the program's code.

namespace test {

using OrderedJson = nlohmann::ordered_json;

inline std::string bytes(std::initializer_list<int> values) {
  std::string out;
  for (const int value : values) out += static_cast<char>(value);
  return out;
}

/// Encoding of a tree whose root has two leaves: triangle 0, and triangles 1 and 2.
inline const std::string kTree = bytes({0b0000'000'1, 0b0000'001'1});

/// Encoding of a two-level tree, with two instances of a tree over all three triangles: nodes, then the tree of each
/// instance.
inline const std::string kLevels = bytes({0b0000'000'1, 0b0000'000'1, 0b0000'010'1, 0, 1, 1});

/// Encoding of a tile of four pixels. One kernel makes their rays, another reads the hits, and 16 bytes go to the
/// picture.
inline std::string tile(int index, const std::string& walks) {
  return bytes({0,
                index,
                4,
                /*after all*/ 0,
                /*imports*/ 0,
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
                /*border*/ 0,
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

/// Traversal words of four rays. Three enter the first leaf and hit. The last enters the second leaf first, misses a
/// triangle by distance and hits the next; the entry on its stack is then farther than the hit.
inline const std::string kWords = bytes({17, /*words*/ 1}) + [] {
  std::string out;
  for (int ray = 0; ray < 3; ++ray) {
    out += number(1U << 27, 4) + number(1U << 30 | 1U << 26 | 0, 4) + number(3, 4) + number(3U << 30 | 1, 4);
  }
  return out + number(1U << 29 | 3U << 27, 4) + number(1U << 30 | 2U << 26 | 1, 4) + number(0x31, 4) +
         number(2U << 30 | 1, 4) + number(3U << 30 | 1, 4) + std::string();
}();

/// Encodes bits as the traversals of a tile, which decode to `words` words. `all`: bits as '0' and '1', lowest first.
inline std::string as_walks(const std::string& all, int words) {
  std::string out((all.size() + 7) / 8, '\0');
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (all[i] == '1') out[i / 8] = static_cast<char>(out[i / 8] | (1 << (i % 8)));
  }
  return bytes({words, /*bits*/ 0}) + out;
}

/// Returns the traversals of kWords in the trace format's bit encoding.
inline std::string bits() {
  std::string all;
  for (int ray = 0; ray < 3; ++ray) all += /*visit, the first box*/ "100" /*hit*/ "11" /*the end: a hit*/ "1";
  all +=    /*visit, both boxes, the second first*/
      "111" /*distance, hit*/
      "10"
      "11" /*cull all*/
      "10" /*a hit*/ "1";
  return as_walks(all, 17);
}

/// Returns the encoded traversals of four rays in kLevels, which enter the second instance and hit the first triangle.
inline std::string bits_of_levels() {
  std::string all;
  for (int ray = 0; ray < 4; ++ray) all += /*the second box*/ "010" /*the only box*/ "100" /*hit*/ "110000" /*end*/ "1";
  return as_walks(all, 4 * 6);
}

/// Function by which a test changes header and contents of a trace before they are written.
using Change = std::function<void(OrderedJson& header, OrderedJson& contents)>;

/// Returns a trace file of one tree and one frame. `tree`, `part`: entries of the tree and the frame in the file's
/// contents, without block offsets.
inline std::string file_of(OrderedJson header, const std::string& links, OrderedJson tree,
                           const std::vector<std::string>& tiles, OrderedJson part, const Change& change = {},
                           const Form& form = {}) {
  OrderedJson contents;
  if (change) change(header, contents);
  std::string file = "raywatt-trace/3\n";
  const std::string packed = block(header.dump());
  file += number(packed.size(), 4) + packed;
  const auto put = [&](const std::string& content) {
    const std::string all = block(content, form);
    const OrderedJson block = {{"offset", file.size()}, {"bytes", all.size()}};
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
  const OrderedJson block = put(contents.dump());
  return file + number(block["offset"], 8) + number(block["bytes"], 4) + "end\n";
}

inline std::string trace(const std::string& walks, bool levels = false, const Change& change = {},
                         const Form& form = {}, std::vector<std::string> tiles = {}) {
  if (tiles.empty()) tiles = {tile(0, walks), tile(1, walks)};
  const OrderedJson header = {{"program", "full:1"},
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
                              {"function", OrderedJson::object()},
                              {"given", {{"render.width", "4"}, {"render.height", "2"}}},
                              {"config", ""}};
  const OrderedJson tree = {{"nodes", levels ? 2 : 1},
                            {"counts",
                             {{"triangles", 3},
                              {"attributes", 3},
                              {"vertices", 0},
                              {"materials", 1},
                              {"details", 0},
                              {"textures", OrderedJson::array()},
                              {"instances", levels ? 2 : 0},
                              {"trees", levels ? 1 : 0}}}};
  const OrderedJson part = {{"frame", 0},
                            {"program", "program"},
                            {"tree", 0},
                            {"demands", {{"tile_samples", 4}, {"attribute_bytes", 0}, {"region_bytes", {32, 0, 0}}}},
                            {"result",
                             {{"rays", {8, 0, 0, 0}},
                              {"traversal_steps", 18},
                              {"continued", 0},
                              {"sampling", {{"wanted", 8}, {"traced", 8}}}}}};
  return file_of(header, levels ? kLevels : kTree, tree, tiles, part, change, form);
}

}  // namespace test
