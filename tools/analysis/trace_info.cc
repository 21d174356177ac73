#include "tools/analysis/trace_info.h"

#include <fmt/format.h>

#include "sim/io/printable.h"
#include "sim/report/table.h"
#include "tools/run/frame/trace_header.h"

namespace tools {

using sim::Json;

namespace {

std::string text_at(const Json& json, const char* key) { return sim::printable(json.at(key).get<std::string>()); }

}  // namespace

Json trace_info(const traces::TraceReader& trace) {
  return trace.naming_file([&] {
    const Json& header = trace.header();
    check_header(header);
    constexpr std::uint64_t kMost = std::uint64_t{1} << 48;
    std::uint64_t tiles = 0, rays = 0, steps = 0, bytes = 0;
    for (const traces::TraceReader::Part& part : trace.parts()) {
      tiles += part.tiles;
      for (const Json& kind : part.result.at("rays")) rays += traces::number_of(kind, kMost, "rays");
      steps += traces::number_at(part.result, "traversal_steps", kMost);
      for (const traces::TraceReader::FileRange& tile : trace.tiles(part)) bytes += tile.bytes;
    }
    const Json& scene = header.at("scene");
    const auto side = [&](std::size_t i) {
      return traces::number_of(header.at("resolution").at(i), 1U << 16, "resolution");
    };
    Json info = {{"schema", "raywatt-trace-info/1"},
                 {"version", trace.file_version()},
                 {"program", text_at(header, "program")},
                 {"reference", text_at(header, "reference")},
                 {"resolution", {side(0), side(1)}},
                 {"scene",
                  {{"name", text_at(scene, "name")},
                   {"triangles", traces::number_at(scene, "triangles", kMost)},
                   {"sha256", text_at(scene, "sha256")},
                   {"bvh_hash", text_at(scene, "bvh_hash")}}},
                 {"frames", trace.frames().size()},
                 {"trees", trace.tree_count()},
                 {"tiles", tiles},
                 {"rays", rays},
                 {"traversal_steps", steps},
                 {"bytes", trace.file_bytes()},
                 {"tile_bytes", bytes}};
    const double per_ray = rays == 0 ? 0 : static_cast<double>(trace.file_bytes()) / static_cast<double>(rays);
    info["bytes_per_ray"] = per_ray;
    info["function"] = Json::object();
    for (const auto& [key, value] : header.at("function").items()) {
      info["function"][sim::printable(key)] = sim::printable(value.get<std::string>());
    }
    return info;
  });
}

std::string trace_info_text(const Json& info) {
  const auto count = [&](const char* key) { return sim::si_text(info[key].get<double>()); };
  std::string program = info["program"].get<std::string>();
  if (info["reference"] != "") program += ", compared with " + info["reference"].get<std::string>();
  const Json& scene = info["scene"];
  std::string out;
  const auto line = [&](const char* name, const std::string& value) {
    out += fmt::format("  {:<22}{}\n", name, value);
  };
  line("format", fmt::format("raywatt-trace/{}", info["version"].get<int>()));
  line("program", program);
  line("resolution", fmt::format("{}x{}", info["resolution"].at(0).get<int>(), info["resolution"].at(1).get<int>()));
  line("scene", fmt::format("{} ({} triangles)", scene["name"].get<std::string>(),
                            sim::si_text(scene["triangles"].get<double>())));
  line("frames", std::to_string(info["frames"].get<std::size_t>()));
  line("tiles", count("tiles"));
  line("rays", count("rays"));
  line("traversal steps", count("traversal_steps"));
  line("bytes", fmt::format("{}B = {:.1f} per ray", count("bytes"), info["bytes_per_ray"].get<double>()));
  line("keys of the work", fmt::format("{}; raywatt trace info --json lists them", info["function"].size()));
  return out;
}

}  // namespace tools
