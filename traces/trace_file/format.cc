#include "traces/trace_file/format.h"

#include <algorithm>
#include <vector>

#include "sim/io/json.h"
#include "traces/trace_file/bytes.h"
#include "traces/walk.h"

namespace traces {
namespace {

constexpr std::uint64_t kMaxRegionBytes = std::uint64_t{1} << 40;
constexpr std::uint64_t kMaxAttributeBytes = 0xffffffffU;
constexpr std::uint64_t kMaxRecords = std::uint64_t{1} << 28;
constexpr std::uint64_t kMaxRasterRecords = std::uint64_t{1} << 30;
constexpr std::size_t kFirstBuildRegion = static_cast<std::size_t>(Region::kBuild);
constexpr std::uint32_t kMaxTextureSide = 1U << 16;

}  // namespace

std::uint64_t number_of(const Json& json, std::uint64_t most, const char* what) {
  if (!json.is_number_unsigned() || json.get<std::uint64_t>() > most) ByteReader::throw_out_of_range(what);
  return json.get<std::uint64_t>();
}

std::uint64_t number_at(const Json& json, const char* key, std::uint64_t most) {
  return number_of(json.at(key), most, key);
}

Json to_json(const ImageCounts& c) {
  return {
      {"triangles", c.triangles}, {"attributes", c.attributes}, {"vertices", c.vertices},   {"materials", c.materials},
      {"details", c.details},     {"textures", c.textures},     {"instances", c.instances}, {"trees", c.trees}};
}

Json to_json(const FrameRequirements& d) {
  // Regions for building trees are left out if they are empty.
  std::vector<std::uint64_t> regions(d.region_bytes.begin(), d.region_bytes.end());
  while (regions.size() > kFirstBuildRegion && regions.back() == 0) regions.pop_back();
  Json json{{"tile_samples", d.tile_samples}, {"attribute_bytes", d.attribute_bytes}, {"region_bytes", regions}};
  if (d.wave_samples != 0) json["wave_samples"] = d.wave_samples;
  if (d.pass_attribute_bytes != 0) json["pass_attribute_bytes"] = d.pass_attribute_bytes;
  if (d.raster) {
    json["raster"] = {
        {"vertices", d.raster->vertices}, {"triangles", d.raster->triangles}, {"entries", d.raster->entries}};
  }
  if (d.build) {
    json["build"] = {{"vertices", d.build->vertices},
                     {"triangles", d.build->triangles},
                     {"instances", d.build->instances},
                     {"shadow_bytes", d.build->shadow_bytes}};
  }
  return json;
}

ImageCounts counts_of_json(const Json& json) {
  ImageCounts c{number_at(json, "triangles", kMaxTriangles), number_at(json, "attributes", kMaxTriangles),
                number_at(json, "vertices", kMaxTriangles),  number_at(json, "materials", kMaxRecords),
                number_at(json, "details", kMaxRecords),     {},
                number_at(json, "instances", kMaxInstances), number_at(json, "trees", kMaxInstances)};
  for (const Json& sides : json.at("textures")) {
    std::array<std::uint32_t, 2> texture{};
    for (std::size_t i = 0; i < 2; ++i) {
      texture[i] = static_cast<std::uint32_t>(number_of(sides.at(i), kMaxTextureSide, "textures"));
      if (texture[i] == 0) ByteReader::throw_out_of_range("textures");
    }
    c.textures.push_back(texture);
  }
  return c;
}

FrameRequirements requirements_of_json(const Json& json) {
  // Fields that are absent in traces of a frame with one pass and one wave.
  const auto optional_at = [&](const char* key, std::uint64_t most) {
    return json.contains(key) ? static_cast<std::uint32_t>(number_at(json, key, most)) : 0;
  };
  FrameRequirements d{static_cast<std::uint32_t>(number_at(json, "tile_samples", 1U << 26)),
                      optional_at("wave_samples", 1U << 26),
                      static_cast<std::uint32_t>(number_at(json, "attribute_bytes", kMaxAttributeBytes)),
                      optional_at("pass_attribute_bytes", kMaxAttributeBytes),
                      {}};
  const std::size_t regions = std::clamp(json.at("region_bytes").size(), kFirstBuildRegion, kRegionCount);
  for (std::size_t i = 0; i < regions; ++i) {
    d.region_bytes[i] = number_of(json.at("region_bytes").at(i), kMaxRegionBytes, "region_bytes");
  }
  if (json.contains("raster")) {
    const auto count = [&](const char* key) {
      return static_cast<std::uint32_t>(number_at(json.at("raster"), key, kMaxRasterRecords));
    };
    d.raster = RasterArraySizes{count("vertices"), count("triangles"), count("entries")};
  }
  if (json.contains("build")) {
    const Json& build = json.at("build");
    d.build = BuildArraySizes{static_cast<std::uint32_t>(number_at(build, "vertices", kMaxRasterRecords)),
                              static_cast<std::uint32_t>(number_at(build, "triangles", kMaxTriangles)),
                              static_cast<std::uint32_t>(number_at(build, "instances", kMaxInstances)),
                              number_at(build, "shadow_bytes", kMaxRegionBytes)};
  }
  return d;
}

}  // namespace traces
