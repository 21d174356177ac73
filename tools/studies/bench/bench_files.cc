#include <algorithm>
#include <sstream>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "sim/error.h"
#include "sim/io/file.h"
#include "sim/io/json.h"
#include "sim/io/printable.h"
#include "sim/report/table.h"
#include "tools/studies/bench/bench.h"

namespace tools {

using sim::Json;

namespace {

constexpr std::uint64_t kLargestFile = 16 << 20;

/// The entry of the scene of that name, or null.
const Json* find_scene(const Json& bench, const Json& name) {
  const auto found = std::ranges::find(bench["scenes"], name, [](const Json& scene) { return scene["scene"]; });
  return found != bench["scenes"].end() ? &*found : nullptr;
}

/// Renames the figures of a build from before there was one for all threads.
void read_as_version_2(Json& bench) {
  for (Json& scene : bench["scenes"]) {
    for (const auto& [was, is] : {std::pair{"functional_rays_per_s", "recording_rays_per_s"},
                                  std::pair{"simulated_rays_per_s", "one_thread_rays_per_s"}}) {
      if (!scene.contains(was)) continue;
      scene[is] = scene[was];
      scene.erase(was);
    }
    scene.erase("peak_rss_mb");  // the peak of all scenes before it, too
  }
  bench["schema"] = "raywatt-bench/2";
}

/// Its fault; empty if there is none.
std::string fault(const Json& bench) {
  if (!bench.is_object() || !bench.contains("schema") || !bench["schema"].is_string()) return "has no 'schema'";
  const std::string schema = bench["schema"].get<std::string>();
  if (schema != "raywatt-bench/1" && schema != "raywatt-bench/2") {
    return fmt::format("has schema '{}'", sim::printable(schema));
  }
  if (!bench.contains("scenes") || !bench["scenes"].is_array()) return "has no 'scenes'";
  for (const Json& scene : bench["scenes"]) {
    if (!scene.is_object() || !scene.contains("scene") || !scene["scene"].is_string()) {
      return "has a scene without a name";
    }
    for (const BenchFigure& figure : bench_figures()) {
      if (scene.contains(figure.name) && !scene[figure.name].is_number()) {
        return fmt::format("has a '{}' that is no number", figure.name);
      }
    }
  }
  return {};
}

/// Differences of a scene that two results have: "resolution [64,32] instead of [32,32]".
std::vector<std::string> differences(const Json& a, const Json& b, const Json& scene_a, const Json& scene_b) {
  std::vector<std::string> found;
  const auto differs = [](const Json& x, const Json& y, const char* key) {
    return x.contains(key) && y.contains(key) && x[key] != y[key];
  };
  const auto compare = [&](const Json& x, const Json& y, const char* key) {
    if (!differs(x, y, key)) return;
    found.push_back(fmt::format("{} {} instead of {}", key, sim::printable(sim::json_line(y[key])),
                                sim::printable(sim::json_line(x[key]))));
  };
  compare(scene_a, scene_b, "resolution");
  compare(a, b, "program");
  compare(a, b, "threads");
  if (!found.empty() || !differs(scene_a, scene_b, "config_hash")) return found;
  compare(a, b, "config");
  compare(a, b, "set");
  // Another build may have made it from other keys.
  if (found.empty() && !differs(a, b, "git")) compare(scene_a, scene_b, "config_hash");
  return found;
}

/// Medians of the figures of equal scenes.
Json merged(const std::vector<Json>& results) {
  Json out = results.front();
  for (Json& scene : out["scenes"]) {
    for (const BenchFigure& figure : bench_figures()) {
      std::vector<double> values;
      for (const Json& result : results) {
        const Json* same = find_scene(result, scene["scene"]);
        if (same != nullptr && same->contains(figure.name)) values.push_back((*same)[figure.name].get<double>());
      }
      if (!values.empty()) scene[figure.name] = median(values);
    }
  }
  return out;
}

std::string cell(const BenchFigure& figure, const Json& scene) {
  if (!scene.contains(figure.name)) return "-";
  const auto value = scene[figure.name].get<double>();
  if (figure.name == "sampling_cycles_inside") return value >= 0.5 ? "yes" : "no";
  return figure.kind == BenchFigure::Kind::kRate ? sim::si_text(value) : fmt::format("{:.2f}", value);
}

/// One table and an empty line; nothing if no scene has what it shows.
std::string table_of(const Json& bench, bool of_part, bool compares) {
  std::vector<BenchFigure> columns;
  for (const BenchFigure& figure : bench_figures()) {
    const bool is_compared = figure.kind != BenchFigure::Kind::kFact;
    if (figure.of_part == of_part && (is_compared || !compares)) columns.push_back(figure);
  }
  std::vector<std::string> header = {compares ? "times as good" : "scene"};
  for (const BenchFigure& figure : columns) header.push_back(figure.header);
  sim::Table table(header);
  bool shows = false;
  for (const Json& scene : bench["scenes"]) {
    if (compares && !scene.contains("against")) continue;
    std::vector<std::string> row = {scene["scene"].get<std::string>()};
    for (const BenchFigure& figure : columns) {
      const Json& from = compares ? scene["against"] : scene;
      shows = shows || from.contains(figure.name);
      const bool has = compares && from.contains(figure.name);
      row.push_back(has        ? fmt::format("x{:.2f}", from[figure.name].get<double>())
                    : compares ? "-"
                               : cell(figure, scene));
    }
    table.add_row(row);
  }
  return shows ? table.text() + "\n" : "";
}

}  // namespace

Json load_bench(const std::filesystem::path& file) {
  const std::string name = sim::printable(file.string());
  const auto refuse = [&](const std::string& why) {
    return sim::InputError(
        fmt::format("{}: {}; wanted is what 'raywatt bench --json' prints, once or more often", name, why));
  };
  std::string bytes = sim::read_file(file, kLargestFile);
  if (sim::is_nested_deeper(bytes, sim::kDeepestJson))
    throw refuse(fmt::format("is nested too deeply, allowed are {} levels", sim::kDeepestJson));
  std::istringstream text(std::move(bytes));
  std::vector<Json> results;
  try {
    while (text >> std::ws && text.peek() != std::char_traits<char>::eof()) {
      Json& result = results.emplace_back();
      result = sim::parse_json(text);
      if (const std::string why = fault(result); !why.empty()) throw refuse(why);
      if (result["schema"] == "raywatt-bench/1") read_as_version_2(result);
      for (const Json& scene : result["scenes"]) {
        const Json* same = find_scene(results.front(), scene["scene"]);
        if (same == nullptr) continue;
        const std::vector<std::string> all = differences(results.front(), result, *same, scene);
        if (!all.empty()) throw refuse(fmt::format("has results of different kinds: {}", fmt::join(all, ", ")));
      }
    }
  } catch (const sim::JsonError&) {
    throw refuse(text.eof() ? "ends early" : "is no JSON");
  }
  if (results.empty()) throw refuse("is empty");
  return merged(results);
}

void check_comparable(const Json& bench, const Json& other, const std::filesystem::path& file, bool need_one) {
  const std::string name = sim::printable(file.string());
  bool have_one = false;
  for (const Json& scene : bench["scenes"]) {
    const Json* same = find_scene(other, scene["scene"]);
    if (same == nullptr) continue;
    have_one = true;
    const std::vector<std::string> all = differences(bench, other, scene, *same);
    if (all.empty()) continue;
    throw sim::InputError(
        fmt::format("{}: cannot be compared with these figures: {} has {}; allowed: the same frame on "
                    "the same machine",
                    name, scene["scene"].get<std::string>(), fmt::join(all, ", ")));
  }
  if (have_one || !need_one) return;
  std::vector<std::string> there;
  for (const Json& scene : other["scenes"]) there.push_back(sim::printable(scene["scene"].get<std::string>()));
  throw sim::InputError(
      fmt::format("{}: has no scene in common with these figures; there are: {}", name, fmt::join(there, ", ")));
}

void compare_bench(Json& bench, const Json& other) {
  for (Json& scene : bench["scenes"]) {
    const Json* same = find_scene(other, scene["scene"]);
    if (same == nullptr) continue;
    Json ratios = Json::object();
    for (const BenchFigure& figure : bench_figures()) {
      if (figure.kind == BenchFigure::Kind::kFact) continue;
      if (!scene.contains(figure.name) || !same->contains(figure.name)) continue;
      const double ratio = scene[figure.name].get<double>() / (*same)[figure.name].get<double>();
      ratios[figure.name] = figure.kind == BenchFigure::Kind::kCost ? 1 / ratio : ratio;
    }
    scene["against"] = std::move(ratios);
  }
}

std::string bench_table(const Json& bench) {
  std::string text;
  for (const bool compares : {false, true}) {
    for (const bool of_part : {false, true}) text += table_of(bench, of_part, compares);
  }
  return text.substr(0, text.size() - 1);  // without the empty line behind the last
}

}  // namespace tools
