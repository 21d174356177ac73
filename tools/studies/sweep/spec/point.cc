#include "tools/studies/sweep/spec/point.h"

#include <algorithm>
#include <iterator>

#include <fmt/format.h>

#include "shader_kernels/programs/program_spec.h"
#include "sim/config/config.h"
#include "sim/error.h"
#include "sim/io/json.h"
#include "sim/io/printable.h"
#include "sim/sha256.h"
#include "tools/host/build_info.h"
#include "tools/sampling/slices.h"
#include "traces/scene/gltf/budget.h"
#include "traces/scene/gltf/source.h"
#include "traces/scenes/library.h"

namespace tools::sweep {

using sim::Json;

JobOptions Point::run_options() const {
  JobOptions o;
  o.config = config;
  o.image = tile_sampling.empty() || image ? "full" : "none";
  o.replicates = replicates;
  if (slices != 0) o.slices = std::to_string(slices);
  o.sets = sets;
  o.argv = {"raywatt", "run", config};
  for (const PointText& t : kPointTexts) {
    o.*t.job = this->*t.member;
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
    slices.back().id = sim::sha256_hex(sim::json_line(slice_identity(slices.back())));
  }
  return slices;
}

Point whole_point_of(const Point& slice) {
  Point whole = slice;
  whole.id = slice.whole;
  whole.slice = 0;
  whole.whole.clear();
  return whole;
}

Json slice_identity(const Point& slice) {
  return {{"schema", "raywatt-slice/1"}, {"whole", slice.whole}, {"slice", slice.slice}, {"slices", slice.slices}};
}

std::string format_point_line(const Point& point) {
  Json json = {{"n", point.n}, {"id", point.id}, {"axes", Json::object()}, {"config", point.config}};
  for (const auto& [name, value] : point.axes) json["axes"][name] = value;
  for (const PointText& t : kPointTexts) {
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

Point parse_point_line(const std::string& line, const std::string& where) {
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
    for (const PointText& t : kPointTexts) point.*t.member = json.value(t.name, "");
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

namespace {

/// True if points that differ only in the machine can share the recorded work: no picture, slices or representative
/// frames, which each machine chooses.
bool can_share(const Point& point, const RunConfig& config) {
  const bool sorts = config.gpu->tni.dispatcher.is_sorting();  // a record has no keys of rays
  return !point.image && point.slices == 0 && point.representative.empty() && !sorts;
}

}  // namespace

const ConfigVariants& PointKeys::apply_point(const Point& point) {
  const JobOptions options = point.run_options();
  std::vector<std::string> key = {point.config, point.scene};
  std::ranges::copy_if(options.sets, std::back_inserter(key),
                       [](const std::string& set) { return set.starts_with("process="); });
  auto base = bases_.find(key);
  if (base == bases_.end()) {
    RunConfig config = load_base_config(point.config, point.scene, options.sets);
    base = bases_.try_emplace(key, std::move(config), sim::find_config(point.config).string()).first;
  }
  base->second.apply(options);
  return base->second;
}

const RunConfig& PointKeys::config_of(const Point& point) { return apply_point(point).config(); }

PointKeys::Key PointKeys::key_of(const Point& point) { return make_key(point, apply_point(point)); }

std::string PointKeys::scene_digest(const RunConfig& config) {
  const std::filesystem::path file = traces::scene_file(config.scene.name);
  if (file.empty()) {
    traces::check_builtin_name(config.scene.name);
    return std::string(kBuiltIn);  // a built-in scene follows from the program's sources and the keys
  }
  auto digest = digests_.find(file.string());
  if (digest == digests_.end()) {
    traces::gltf::Budget budget(sim::printable(file.string()), config.limits.memory.bytes);
    digest = digests_.emplace(file.string(), traces::gltf::read_source(file, config.limits, budget).sha256).first;
  }
  return digest->second;
}

PointKeys::Key PointKeys::make_key(const Point& point, const ConfigVariants& applied) {
  const BuildInfo build = build_info();
  const std::string program = kernels::parse_program(point.program).name();
  const std::string reference = point.reference.empty() ? "" : kernels::parse_program(point.reference).name();
  Json work = {{"model_id", build.model_id},
               {"scene_sha256", scene_digest(applied.config())},
               {"program", program},
               {"reference", reference}};
  Key key;
  key.made_of = {{"schema", "raywatt-point/1"},
                 {"report_id", build.report_id},
                 {"config_hash", applied.hash({})},
                 {"tile_sampling", point.tile_sampling},
                 {"image", point.image},
                 {"replicates", point.replicates},
                 {"slices", point.slices}};
  if (!point.representative.empty()) key.made_of["representative"] = point.representative;
  key.made_of.update(work);
  key.id = sim::sha256_hex(sim::json_line(key.made_of));
  if (can_share(point, applied.config())) {
    work["function_hash"] = applied.hash(sim::Affects::kFunction);
    if (!point.tile_sampling.empty()) work["pilot"] = true;  // a record for sampling also has pilots
    key.stream = sim::sha256_hex(sim::json_line(work));
  }
  return key;
}

void PointKeys::set_key(Point& point) {
  point.stream.clear();
  point.error.clear();
  const ConfigVariants* applied = nullptr;
  try {
    applied = &apply_point(point);
    if (point.slices != 0) tools::slice_count(applied->config(), kernels::parse_program(point.program), point.slices);
  } catch (const sim::InputError& error) {
    point.error = error.what();
    point.id.clear();
    const std::uint64_t n = std::exchange(point.n, 0);
    point.id = sim::sha256_hex(format_point_line(point) + std::string(build_info().model_id));
    point.n = n;
    return;
  }
  Key key = make_key(point, *applied);
  point.id = std::move(key.id);
  point.stream = std::move(key.stream);
}

}  // namespace tools::sweep
