#include "tools/run/frame/trace_header.h"

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <vector>

#include <fmt/format.h>

#include "hw_models/machines/gpu_config.h"
#include "shader_kernels/catalogue.h"
#include "sim/config/config.h"
#include "sim/error.h"
#include "sim/io/json.h"
#include "sim/io/printable.h"
#include "tools/host/build_info.h"
#include "tools/host/paths.h"

namespace tools {
namespace {

using traces::Json;

/// Returns all fields of a configuration by key.
std::map<std::string, sim::FieldInfo> fields_by_key(const RunConfig& config) {
  std::map<std::string, sim::FieldInfo> all;
  for (sim::FieldInfo& field : sim::list_fields(config)) all.emplace(field.path, std::move(field));
  return all;
}

/// Returns the keys that command-line options other than --set changed: --scene, --camera, --frames, --resolution.
Json fields_given_by_options(const RunConfig& effective, const JobOptions& options) {
  JobOptions plain;
  plain.config = options.config;
  plain.sets = options.sets;
  plain.ideal = options.ideal;
  const auto without = fields_by_key(load_run_config(plain));
  Json out = Json::object();
  for (const sim::FieldInfo& field : sim::list_fields(effective)) {
    if (field.value != without.at(field.path).value) out[field.path] = field.value;
  }
  return out;
}

/// True if a key with Affects::kFunction changes the work in a trace. Loading limits do not, nor do keys of frame
/// programs that neither the run nor its reference uses.
bool changes_work(std::string_view key, std::string_view program, std::string_view reference) {
  const std::string_view group = key.substr(0, key.find('.'));
  if (group == "limits") return false;
  constexpr std::array<std::string_view, 4> kPrograms = {"multirate", "undersample", "supersample", "reconstruct"};
  if (std::ranges::find(kPrograms, group) == kPrograms.end()) return true;
  return program.starts_with(group) || reference.starts_with(group);
}

Json function_fields(const RunConfig& config, const std::string& program, const std::string& reference) {
  Json out = Json::object();
  for (const sim::FieldInfo& field : sim::list_fields(config)) {
    if (field.affects == sim::Affects::kFunction && changes_work(field.path, program, reference))
      out[field.path] = field.value;
  }
  return out;
}

bool is_text(const Json& json) { return json.is_string(); }
bool is_count(const Json& json) { return json.is_number_unsigned(); }
bool is_list_of_texts(const Json& json) { return json.is_array() && std::ranges::all_of(json, is_text); }
bool is_object_of_texts(const Json& json) { return json.is_object() && std::ranges::all_of(json, is_text); }
bool is_pair(const Json& json) { return json.is_array() && json.size() == 2 && std::ranges::all_of(json, is_count); }

/// A required key of a trace's header.
struct HeaderKey {
  const char* pointer;  ///< JSON pointer to the key
  bool (*fits)(const Json&);
  const char* kind;
};
constexpr std::array<HeaderKey, 13> kHeaderKeys = {{
    {"/program", is_text, "a frame program as text"},
    {"/reference", is_text, "a frame program as text, \"\" if there is none"},
    {"/resolution", is_pair, "[width, height]"},
    {"/scene/name", is_text, "text"},
    {"/scene/triangles", is_count, "a whole number"},
    {"/scene/instances", is_count, "a whole number"},
    {"/scene/lights", is_count, "a whole number"},
    {"/scene/sha256", is_text, "text"},
    {"/scene/bvh_hash", is_text, "text"},
    {"/kernels", is_list_of_texts, "a list of names"},
    {"/function", is_object_of_texts, "an object of keys and their values as text"},
    {"/given", is_object_of_texts, "an object of keys and their values as text"},
    {"/config", is_text, "YAML as text, \"\" if there is none"},
}};

/// Throws InputError if the resolutions of trace and configuration differ.
void check_resolution(const Json& header, const std::string& file, const RunConfig& config) {
  const auto sides = header.at("resolution").get<std::vector<std::uint64_t>>();
  if (sides[0] == config.render.width && sides[1] == config.render.height) return;
  throw sim::InputError(
      fmt::format("{}: its resolution is {}x{}, and that of the configuration (render.width, render.height) {}x{}; "
                  "allowed: the same",
                  file, sides[0], sides[1], config.render.width, config.render.height));
}

/// Reads a count, or an array of counts, into `number`; an absent key means 0.
template <class Number>
void read_count(const Json& json, const char* key, Number& number) {
  if (!json.contains(key)) return;
  if constexpr (requires { number.size(); }) {
    for (std::size_t i = 0; i < number.size(); ++i) {
      number[i] = traces::number_of(json.at(key).at(i), std::numeric_limits<std::uint64_t>::max(), key);
    }
  } else {
    number = static_cast<Number>(traces::number_at(json, key, std::numeric_limits<Number>::max()));
  }
}

/// Reorders counts of similarity checks from their order in memory to that in trace files, or back.
template <class Counts>
Counts reorder_checks(const Counts& counts, bool is_from_file) {
  using enum kernels::Check;
  constexpr std::array kInFile{kObject, kNormal,          kShadow,          kPosition,        kConvexity, kTexture,
                               kColour, kSecondaryObject, kSecondaryNormal, kSecondaryShadow, kDetail,    kBorder};
  static_assert(kInFile.size() == std::tuple_size_v<Counts>);
  Counts out{};
  for (std::size_t i = 0; i < out.size(); ++i) {
    const auto check = static_cast<std::size_t>(kInFile[i]);
    is_from_file ? out[check] = counts[i] : out[i] = counts[check];
  }
  return out;
}

/// Throws InputError if a key is not at its default although the program that recorded the trace did not have this key.
/// Only the default describes the recorded work.
void check_not_recorded(const Json& header, const std::string& file,
                        const std::map<std::string, sim::FieldInfo>& asked) {
  const sim::JsonPointer id("/made_by/model_id");
  if (!header.contains(id) || header.at(id) == build_info().model_id) return;
  const auto program = header.at("program").get<std::string>(), reference = header.at("reference").get<std::string>();
  const auto defaults = fields_by_key(RunConfig{});
  for (const auto& [path, field] : asked) {
    if (field.affects != sim::Affects::kFunction || !changes_work(path, program, reference)) continue;
    if (header.at("function").contains(path)) continue;
    const std::string& value = defaults.at(path).value;
    if (field.value == value) continue;
    throw sim::InputError(fmt::format(
        "{}: was recorded by another build, without the key {}, and {} is asked for; allowed: the default, {}, as this "
        "key changes the work",
        file, path, field.value, value));
  }
}

}  // namespace

Json trace_header(const Inputs& inputs, const JobOptions& options) {
  Json kernels = Json::array();
  for (const kernels::KernelInfo& kernel : kernels::kernel_catalogue()) kernels.push_back(kernel.name);
  const BuildInfo build = build_info();
  const std::string program = kernels::parse_program(options.program).name();
  const std::string reference = options.reference.empty() ? "" : kernels::parse_program(options.reference).name();
  return {{"program", program},
          {"reference", reference},
          {"resolution", {inputs.config.render.width, inputs.config.render.height}},
          {"scene",
           {{"name", inputs.scene.name},
            {"triangles", inputs.scene.triangles},
            {"instances", inputs.scene.instances},
            {"lights", inputs.scene.lights},
            {"sha256", inputs.scene_sha256},
            {"bvh_hash", inputs.bvh_hash}}},
          {"made_by", {{"version", build.version}, {"git", build.git}, {"model_id", build.model_id}}},
          {"kernels", std::move(kernels)},
          {"function", function_fields(inputs.config, program, reference)},
          {"given", fields_given_by_options(inputs.config, options)},
          {"config", sim::dump_config(inputs.config)}};
}

Json recorded_frame(std::uint32_t number, const RecordedError& error) {
  Json frame = {{"frame", number}, {"squared_error", error.squared}};
  if (error.change) frame["squared_change_error"] = *error.change;
  if (error.flip) frame["flip"] = *error.flip;
  if (error.flicker) frame["flicker"] = *error.flicker;
  return frame;
}

Json recorded_result(const RenderResult& result) {
  kernels::Sampling s = result.sampling;
  s.failed = reorder_checks(s.failed, false);
  s.first_failed = reorder_checks(s.first_failed, false);
  Json sampling;
  kernels::Sampling::describe([&](const char* name, const auto& count) { sampling[name] = count; }, s);
  sampling["similar"] = s.similar;
  sampling["blocks"] = s.blocks;
  sampling["tile_side"] = s.tile_side;
  sampling["has_rates"] = s.has_rates;
  return {{"rays", std::span(result.rays)},
          {"traversal_steps", result.traversal_steps},
          {"continued", result.continued},
          {"sampling", std::move(sampling)}};
}

RenderResult parse_recorded_result(const Json& json) {
  RenderResult result;
  read_count(json, "continued", result.continued);
  const Json& from = json.at("sampling");
  kernels::Sampling& s = result.sampling;
  kernels::Sampling::describe([&](const char* name, auto& count) { read_count(from, name, count); }, s);
  if (s.wanted == 0) throw sim::InputError("sampling.wanted is not there or 0");
  s.failed = reorder_checks(s.failed, true);
  s.first_failed = reorder_checks(s.first_failed, true);
  for (const Json& share : from.value("similar", Json::array())) s.similar.push_back(share.get<float>());
  for (const Json& side : from.value("blocks", Json::array())) {
    s.blocks.push_back(static_cast<std::uint8_t>(traces::number_of(side, 255, "blocks")));
  }
  read_count(from, "tile_side", s.tile_side);
  s.has_rates = from.value("has_rates", false);
  return result;
}

void check_header(const Json& header) {
  for (const HeaderKey& key : kHeaderKeys) {
    const sim::JsonPointer pointer(key.pointer);
    std::string name = key.pointer + 1;
    std::ranges::replace(name, '/', '.');
    if (!header.contains(pointer)) throw sim::InputError(fmt::format("the header has no '{}'", name));
    if (!key.fits(header.at(pointer))) {
      throw sim::InputError(fmt::format("'{}' of the header is wrong; allowed: {}", name, key.kind));
    }
  }
}

void refuse_sorting(const RunConfig& config, std::string_view where) {
  if (!config.gpu->tni.dispatcher.is_sorting()) return;
  throw sim::InputError(
      fmt::format("{}: recorded work has no keys by which rays are sorted; allowed: tni.dispatcher.sort=none", where));
}

void check_recorded(const Json& header, const std::string& file, const RunConfig& config) {
  const auto program = header.at("program").get<std::string>(), reference = header.at("reference").get<std::string>();
  const auto asked = fields_by_key(config);
  for (const auto& [path, value] : header.at("function").items()) {
    if (!changes_work(path, program, reference)) continue;
    const auto field = asked.find(path);
    if (field == asked.end() || field->second.affects != sim::Affects::kFunction) {
      throw sim::InputError(fmt::format("{}: was recorded with a key '{}', which changes no work in this program", file,
                                        sim::printable(path)));
    }
    const std::string recorded = value.get<std::string>();
    if (recorded == field->second.value) continue;
    throw sim::InputError(fmt::format(
        "{}: {} was recorded as {}, and {} is asked for; allowed: the recorded value, as this key changes the work",
        file, path, sim::printable(recorded), field->second.value));
  }
  check_not_recorded(header, file, asked);
  check_resolution(header, file, config);
  refuse_sorting(config, file);
}

RunConfig replay_config(const Json& header, const std::string& file, const JobOptions& options) {
  sim::set_config_search_path(config_folders());
  RunConfig config;
  sim::ConfigNode tree = sim::config_tree(config);
  sim::ConfigLoader loader(tree);
  std::string origin = file;
  if (options.config.empty()) {
    const std::string recorded = header.at("config").get<std::string>();
    if (recorded.empty()) {
      throw sim::InputError(
          fmt::format("{}: has no configuration; give one: raywatt trace replay CONFIG {}", file, file));
    }
    loader.apply_text(recorded, file);
  } else {
    const std::filesystem::path found = find_config(options.config);
    origin = found.string();
    loader.apply_file(found);
    for (const auto& [path, value] : header.at("given").items()) {
      loader.apply_set(path + "=" + value.get<std::string>());
    }
  }
  for (const std::string& argument : options.sets) loader.apply_set(argument);
  apply_ideal(config, options.ideal);
  check_run_config(config, origin);
  check_recorded(header, file, config);
  return config;
}

}  // namespace tools
