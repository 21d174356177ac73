#include <algorithm>
#include <sstream>

#include <fmt/format.h>

#include "sim/error.h"
#include "sim/io/file.h"
#include "sim/report/table.h"
#include "tools/bench.h"
#include "tools/median.h"

namespace tools {

using Json = nlohmann::ordered_json;

namespace {

constexpr std::uint64_t kLargestFile = 16 << 20;

/// Of the scene of that name, or null.
const Json* find_scene(const Json& bench, const Json& name) {
  const auto found = std::ranges::find(bench["scenes"], name, [](const Json& scene) { return scene["scene"]; });
  return found != bench["scenes"].end() ? &*found : nullptr;
}

/// Of a build of before there was a figure for all threads.
void read_as_version_2(Json& bench) {
  for (Json& scene : bench["scenes"]) {
    for (const auto& [was, is] : {std::pair{"functional_rays_per_s", "recording_rays_per_s"},
                                  std::pair{"simulated_rays_per_s", "one_thread_rays_per_s"}}) {
      if (!scene.contains(was)) continue;
      scene[is] = scene[was];
      scene.erase(was);
    }
    scene.erase("peak_rss_mb");  // of all scenes before it, too
  }
  bench["schema"] = "raywatt-bench/2";
}

void check(const Json& bench) {
  for (const Json& scene : bench.at("scenes")) {
    scene.at("scene").get<std::string>();
    for (const BenchFigure& figure : bench_figures()) {
      if (scene.contains(figure.name)) scene[figure.name].get<double>();
    }
  }
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
    table.row(row);
  }
  return shows ? table.text() + "\n" : "";
}

}  // namespace

Json load_bench(const std::filesystem::path& file) {
  const auto refuse = [&](const std::string& why) {
    return sim::InputError(
        fmt::format("{}: {}; wanted is what 'raywatt bench --json' prints, once or more often", file.string(), why));
  };
  std::istringstream text(sim::read_file(file, kLargestFile));
  std::vector<Json> results;
  try {
    while (text >> std::ws && text.peek() != std::char_traits<char>::eof()) {
      Json& result = results.emplace_back();
      text >> result;
      const std::string schema = result.at("schema").get<std::string>();
      if (schema != "raywatt-bench/1" && schema != "raywatt-bench/2") throw refuse("schema is '" + schema + "'");
      check(result);
      if (schema == "raywatt-bench/1") read_as_version_2(result);
    }
  } catch (const nlohmann::json::exception& error) {
    throw refuse(error.what());
  }
  if (results.empty()) throw refuse("is empty");
  return merged(results);
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
