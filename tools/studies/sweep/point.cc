#include "tools/studies/sweep/point.h"

#include <algorithm>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "shader_kernels/programs/program_spec.h"
#include "sim/config/config.h"
#include "sim/error.h"
#include "sim/io/json.h"
#include "sim/io/printable.h"
#include "sim/sha256.h"
#include "tools/host/build_info.h"
#include "tools/simulation/load_config.h"
#include "traces/scene/did_you_mean.h"
#include "traces/scene/gltf/budget.h"
#include "traces/scene/gltf/source.h"
#include "traces/scenes/library.h"

namespace tools::sweep {

namespace {

using Json = nlohmann::ordered_json;

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

std::string text(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

void check_builtin(const std::string& name) {
  std::vector<std::string> known;
  for (const traces::BuiltinInfo& scene : traces::builtin_scenes()) known.push_back(scene.name);
  if (std::ranges::find(known, name) != known.end()) return;
  throw sim::InputError(fmt::format("no scene or workload is called '{}'{}; known: {}; or give a .glb or .gltf file",
                                    sim::printable(name), traces::did_you_mean(name, known), fmt::join(known, ", ")));
}

/// Pictures and estimates are no streams.
bool can_share(const Point& point) { return point.tile_sampling.empty() && !point.image; }

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
  o.sets = sets;
  o.argv = {"raywatt", "run", config};
  for (const Text& t : kTexts) {
    if (!(this->*t.member).empty()) o.argv.insert(o.argv.end(), {t.option, this->*t.member});
  }
  if (o.image == "none") o.argv.insert(o.argv.end(), {"--image", "none"});
  for (const std::string& set : sets) o.argv.insert(o.argv.end(), {"--set", set});
  return o;
}

std::string to_line(const Point& point) {
  Json json = {{"n", point.n}, {"id", point.id}, {"axes", Json::object()}, {"config", point.config}};
  for (const auto& [name, value] : point.axes) json["axes"][name] = value;
  for (const Text& t : kTexts) {
    if (!(point.*t.member).empty()) json[t.name] = point.*t.member;
  }
  if (point.image) json["image"] = true;
  json["sets"] = point.sets;
  if (!point.stream.empty()) json["stream"] = point.stream;
  if (!point.error.empty()) json["error"] = point.error;
  return text(json);
}

namespace {

bool is_key(const std::string& text) {
  return text.size() == 64 && text.find_first_not_of("0123456789abcdef") == std::string::npos;
}

}  // namespace

Point read_line(const std::string& line, const std::string& where) {
  try {
    const Json json = sim::parse_json<Json>(line);
    Point point;
    point.n = json.at("n").get<std::uint64_t>();
    point.id = json.at("id").get<std::string>();
    point.stream = json.value("stream", "");
    if (!is_key(point.id) || !(point.stream.empty() || is_key(point.stream))) {
      throw sim::InputError(fmt::format("{}: the id or the stream is not 64 hexadecimal digits", where));
    }
    for (const auto& [name, value] : json.at("axes").items()) point.axes.emplace_back(name, value.get<std::string>());
    point.config = json.at("config").get<std::string>();
    for (const Text& t : kTexts) point.*t.member = json.value(t.name, "");
    point.image = json.value("image", false);
    point.sets = json.at("sets").get<std::vector<std::string>>();
    point.error = json.value("error", "");
    return point;
  } catch (const Json::exception& error) {
    throw sim::InputError(fmt::format("{}: is no point of a sweep: {}", where, sim::printable(error.what())));
  }
}

RunConfig PointKeys::config_of(const Point& point) {
  auto base = bases_.find({point.config, point.scene});
  if (base == bases_.end()) {
    base = bases_.emplace(std::pair{point.config, point.scene}, load_base_config(point.config, point.scene)).first;
  }
  return apply_options(base->second, point.options());
}

std::string PointKeys::scene_digest(const RunConfig& config) {
  const std::filesystem::path file = traces::scene_file(config.scene.name);
  if (file.empty()) {
    check_builtin(config.scene.name);
    return std::string(kBuiltIn);  // made of the model's sources and of keys
  }
  auto digest = digests_.find(file.string());
  if (digest == digests_.end()) {
    traces::gltf::Budget budget(sim::printable(file.string()), config.limits.memory.bytes);
    digest = digests_.emplace(file.string(), traces::gltf::read_source(file, config.limits, budget).sha256).first;
  }
  return digest->second;
}

PointKeys::Key PointKeys::key_of(const Point& point, const RunConfig& config) {
  const BuildInfo build = build_info();
  const std::string program = kernels::parse_program(point.program).name();
  const std::string reference = point.reference.empty() ? "" : kernels::parse_program(point.reference).name();
  Json work = {{"model_id", build.model_id},
               {"scene_sha256", scene_digest(config)},
               {"program", program},
               {"reference", reference}};
  Key key;
  key.made_of = {{"schema", "raywatt-point/1"},
                 {"report_id", build.report_id},
                 {"config_hash", sim::config_hash(config)},
                 {"tile_sampling", point.tile_sampling},
                 {"image", point.image}};
  key.made_of.update(work);
  key.id = sim::sha256_hex(text(key.made_of));
  if (can_share(point)) {
    work["function_hash"] = sim::config_hash(config, sim::Affects::kFunction);
    key.stream = sim::sha256_hex(text(work));
  }
  return key;
}

void PointKeys::set_key(Point& point) {
  point.stream.clear();
  point.error.clear();
  std::optional<RunConfig> config;
  try {
    config = config_of(point);
  } catch (const sim::InputError& error) {
    point.error = error.what();
    point.id.clear();
    const std::uint64_t n = std::exchange(point.n, 0);
    point.id = sim::sha256_hex(to_line(point) + std::string(build_info().model_id));
    point.n = n;
    return;
  }
  Key key = key_of(point, *config);
  point.id = std::move(key.id);
  point.stream = std::move(key.stream);
}

}  // namespace tools::sweep
