#include "traces/scenes/builtin.h"

#include <algorithm>

#include <fmt/format.h>

#include "sim/error.h"
#include "sim/io/printable.h"
#include "traces/scene/did_you_mean.h"

namespace traces {
namespace {

struct Entry {
  const char* name;
  const char* description;
  std::uint32_t triangles;
  Scene (*build)(const BuiltinOptions&);
};

constexpr Entry kEntries[] = {
    {"atrium", "A court with arcades on two storeys, banners and a polished floor under the sun", 66'000, build_atrium},
    {"bathroom", "A bathroom: mirrors, chrome, a glass screen, and much that is thinner than a pixel", 270'000,
     build_bathroom},
    {"car", "A red coupe that drives through a hall of concrete and light", 55'000, build_car},
    {"chess", "A game of chess by a window, lacquered pieces on a wooden board", 42'000, build_chess},
    {"conference", "A conference room: long table, fourteen chairs, panelling; five views of it", 190'000,
     build_conference},
    {"cornell", "Cornell box, twice as wide as high, with a mirror sphere and a glass sphere", 10'000, build_cornell},
    {"crowd", "200 skinned figures that walk across a square", 200'000, build_crowd},
    {"forest", "A clearing with a deer, a bench and toadstools; fine textures everywhere", 174'000, build_forest},
    {"hairball", "A ball of thin strands above a mirror floor, beside a mirror wall, in three lights", 2'880'000,
     build_hairball},
    {"laboratory", "A chemist's bench full of glass and coloured liquids", 98'000, build_laboratory},
    {"teapot", "Newell's teapot, glazed, on a checkered floor", 15'000, build_teapot},
    {"village", "Houses, church and windmill among trees and fields, with a fly-through", 600'000, build_village},
};

}  // namespace

std::vector<BuiltinInfo> builtin_scenes() {
  std::vector<BuiltinInfo> list;
  for (const Entry& entry : kEntries) list.push_back({entry.name, entry.description, entry.triangles});
  return list;
}

void check_builtin_name(std::string_view name) {
  std::vector<std::string> names;
  for (const Entry& entry : kEntries) names.emplace_back(entry.name);
  if (std::ranges::find(names, name) != names.end()) return;
  throw sim::InputError(
      fmt::format("no scene is called '{}'{}; built in: {}; a file is given with its extension (.glb, .gltf)",
                  sim::printable(name), did_you_mean(name, names), fmt::join(names, ", ")));
}

Scene build_scene(std::string_view name, const BuiltinOptions& options) {
  check_builtin_name(name);
  return std::ranges::find(kEntries, name, &Entry::name)->build(options);
}

}  // namespace traces
