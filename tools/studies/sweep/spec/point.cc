#include "tools/studies/sweep/spec/point.h"

#include <fmt/format.h>

#include "sim/error.h"
#include "sim/io/json.h"
#include "sim/io/printable.h"
#include "sim/sha256.h"

namespace tools::sweep {
namespace {

using sim::Json;

/// The members that are plain texts, with their names in a line and as options of a run.
struct Text {
  const char* name;
  const char* option;
  std::string Point::*member;
};
constexpr Text kTexts[] = {{"scene", "--scene", &Point::scene},
                           {"camera", "--camera", &Point::camera},
                           {"frames", "--frames", &Point::frames},
                           {"resolution", "--resolution", &Point::resolution},
                           {"program", "--program", &Point::program},
                           {"reference", "--reference", &Point::reference},
                           {"tile_sampling", "--tile-sampling", &Point::tile_sampling}};

}  // namespace

JobOptions Point::options() const {
  JobOptions o;
  o.config = config;
  o.scene = scene;
  o.camera = camera;
  o.frames = frames;
  o.resolution = resolution;
  o.program = program;
  o.reference = reference;
  o.tile_sampling = tile_sampling;
  o.image = tile_sampling.empty() || image ? "full" : "none";
  o.replicates = replicates;
  if (slices != 0) o.slices = std::to_string(slices);
  o.sets = sets;
  o.argv = {"raywatt", "run", config};
  for (const Text& t : kTexts) {
    if (!(this->*t.member).empty()) o.argv.insert(o.argv.end(), {t.option, this->*t.member});
  }
  if (o.image == "none") o.argv.insert(o.argv.end(), {"--image", "none"});
  if (replicates != 1) o.argv.insert(o.argv.end(), {"--replicates", std::to_string(replicates)});
  if (slices != 0) o.argv.insert(o.argv.end(), {"--slices", o.slices});
  for (const std::string& set : sets) o.argv.insert(o.argv.end(), {"--set", set});
  return o;
}

std::vector<Point> slices_of(const Point& point) {
  std::vector<Point> slices;
  if (!point.is_cut()) return slices;
  for (std::uint32_t slice = 1; slice <= point.slices; ++slice) {
    slices.push_back(point);
    slices.back().slice = slice;
    slices.back().whole = point.id;
    slices.back().id = sim::sha256_hex(sim::json_line(made_of(slices.back())));
  }
  return slices;
}

Point whole_of(const Point& slice) {
  Point whole = slice;
  whole.id = slice.whole;
  whole.slice = 0;
  whole.whole.clear();
  return whole;
}

Json made_of(const Point& slice) {
  return {{"schema", "raywatt-slice/1"}, {"whole", slice.whole}, {"slice", slice.slice}, {"slices", slice.slices}};
}

std::string to_line(const Point& point) {
  Json json = {{"n", point.n}, {"id", point.id}, {"axes", Json::object()}, {"config", point.config}};
  for (const auto& [name, value] : point.axes) json["axes"][name] = value;
  for (const Text& t : kTexts) {
    if (!(point.*t.member).empty()) json[t.name] = point.*t.member;
  }
  if (point.image) json["image"] = true;
  if (point.replicates != 1) json["replicates"] = point.replicates;
  if (point.slices != 0) json["slices"] = point.slices;
  if (point.slice != 0) json.update({{"slice", point.slice}, {"whole", point.whole}});
  json["sets"] = point.sets;
  if (!point.stream.empty()) json["stream"] = point.stream;
  if (!point.error.empty()) json["error"] = point.error;
  return sim::json_line(json);
}

namespace {

bool is_key(const std::string& text) {
  return text.size() == 64 && text.find_first_not_of("0123456789abcdef") == std::string::npos;
}

}  // namespace

Point read_line(const std::string& line, const std::string& where) {
  try {
    if (sim::is_nested_deeper(line, sim::kDeepestJson)) throw sim::InputError(where + ": is nested too deeply");
    const Json json = sim::parse_json(line);
    Point point;
    point.n = sim::whole_number<std::uint64_t>(json.at("n"), where + ": its number 'n'");
    point.id = json.at("id").get<std::string>();
    point.stream = json.value("stream", "");
    if (!is_key(point.id) || !(point.stream.empty() || is_key(point.stream))) {
      throw sim::InputError(fmt::format("{}: the id or the stream is not 64 hexadecimal digits", where));
    }
    for (const auto& [name, value] : json.at("axes").items()) point.axes.emplace_back(name, value.get<std::string>());
    point.config = json.at("config").get<std::string>();
    for (const Text& t : kTexts) point.*t.member = json.value(t.name, "");
    point.image = json.value("image", false);
    const auto number = [&](const char* name, std::uint32_t otherwise) {
      return json.contains(name) ? sim::whole_number<std::uint32_t>(json[name], where + ": the number '" + name + "'")
                                 : otherwise;
    };
    point.replicates = number("replicates", 1);
    point.slices = number("slices", 0);
    point.slice = number("slice", 0);
    point.whole = json.value("whole", "");
    if (point.slice > point.slices || is_key(point.whole) != (point.slice != 0)) {
      throw sim::InputError(fmt::format("{}: is no slice of a point", where));
    }
    point.sets = json.at("sets").get<std::vector<std::string>>();
    point.error = json.value("error", "");
    return point;
  } catch (const sim::JsonError& error) {
    throw sim::InputError(fmt::format("{}: is no point of a sweep: {}", where, sim::printable(error.what())));
  }
}

}  // namespace tools::sweep
