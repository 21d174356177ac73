#include "tools/studies/report/search_data.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "sim/error.h"
#include "sim/io/file.h"
#include "sim/io/printable.h"
#include "sim/report/table.h"
#include "tools/studies/optimise/task.h"

namespace tools::pages {
namespace {

namespace fs = std::filesystem;
using sim::Json;

constexpr std::size_t kLongestWords = 4000, kMostTrials = 10'000;
constexpr std::uint64_t kLargestSearch = 256 << 20;

struct Goal {
  std::string text, metric, path;
  bool is_objective = false, is_less_better = false;
  double limit = 0;

  std::string room_text(double value) const {
    const double room = is_less_better ? limit - value : value - limit;
    return limit == 0 ? fmt::format("{:.3g}", room) : fmt::format("{:.2f} %", 100 * room / std::abs(limit));
  }
  /// True if the value meets the limit. A value equal to the limit meets it, even for < and >.
  bool is_met(double value) const { return is_less_better ? value <= limit : value >= limit; }
};

/// Reader of search.json that makes all texts printable. All members throw JsonError for a file of another form.
class SearchFile {
 public:
  explicit SearchFile(const Json& json) : json_(json) {
    if (json.at("schema") != "raywatt-search/1") throw sim::InputError("is no raywatt-search/1");
    for (const Json& goal : json.at("goals")) {
      const Json& limit = goal.at("limit");
      goals_.push_back({text(goal, "text"), text(goal, "metric"), text(goal, "path"), goal.at("objective").get<bool>(),
                        goal.at("less").get<bool>(), limit.is_null() ? 0 : limit.get<double>()});
    }
    if (goals_.empty() || !goals_.front().is_objective) throw sim::InputError("has no objective");
    for (const Json& workload : json.at("workloads")) workloads_.push_back(printable(workload.get<std::string>()));
    for (const Json& trial : json.at("trials")) trials_.push_back(&trial);
    if (trials_.size() > kMostTrials) throw sim::InputError("has too many machines");
    if (!json.at("best").is_null()) {
      const auto best = json.at("best").get<std::uint64_t>();
      for (const Json* trial : trials_) {
        if (trial->at("n") == best) best_ = trial;
      }
    }
  }

  bool has_point_per_machine() const { return json_.at("has_point_per_machine").get<bool>(); }

  /// Returns the JSON member `search` of the page's data.
  Json member() const {
    Json out = {{"sentence", text(json_, "sentence")},
                {"fidelity", text(json_, "fidelity")},
                {"checked", json_.at("checked").get<bool>()},
                {"objective", goals_.front().metric},
                {"limits", Json::array()},
                {"shares", Json::array()},
                {"scatter", scatter_json()},
                {"trades", trades_json()},
                {"trade_sentences", texts(json_.at("trade_sentences"))},
                {"commands", Json::array()},
                {"probability", Json()}};
    if (!json_.at("probabilities").empty()) out["probability"] = json_.at("probabilities").back().get<double>();
    if (best_ == nullptr) return out;
    for (const Json& run : best_->at("runs")) {
      const std::string workload = text(run, "workload");
      out["commands"].push_back(Json::array({workload, run.contains("command") ? text(run, "command") : ""}));
      if (!run.contains("values")) continue;
      for (std::size_t g = 0; g < goals_.size(); ++g) {
        const Goal& goal = goals_[g];
        if (goal.is_objective || (goal.path.starts_with("totals.area") && !out["limits"].empty())) continue;
        const double value = run.at("values").at(g).get<double>();
        out["limits"].push_back(Json::array({workload, run.at("whole").get<bool>() ? "whole" : "sampled", goal.text,
                                             value, run.at("half_widths").at(g).get<double>(), goal.room_text(value),
                                             goal.is_met(value) ? "yes" : "no", probability_text(g)}));
        if (goal.limit != 0) {
          out["shares"].push_back(Json::array({fmt::format("{}: {}", workload, goal.metric), value / goal.limit,
                                               fmt::format("{} of {}", sim::four_digit_text(value), goal.limit)}));
        }
      }
    }
    const std::string check = json_.contains("check_command") ? text(json_, "check_command") : "";
    if (!check.empty()) out["commands"].push_back(Json::array({"check of the front", check}));
    return out;
  }

  /// Returns the page's data for a search on several workloads, in the form of sweep_data() with a point per machine.
  Json page_data(const std::string& name) const {
    Json axes = Json::array(), metrics = Json::array(), points = Json::array(), best = Json::object(),
         texts_of = Json::array();
    for (const Json& axis : json_.at("axes"))
      axes.push_back({{"field", text(axis, "name")}, {"levels", texts(axis.at("values"))}});
    const std::vector<std::size_t> shown = shown_goals();
    for (const std::size_t g : shown) {
      metrics.push_back({{"field", goals_[g].metric},
                         {"name", goals_[g].metric},
                         {"show", "number"},
                         {"unit", ""},
                         {"more", !goals_[g].is_less_better}});
    }
    std::uint64_t done = 0;
    Json front = Json::array(), headlines = Json::array({goals_.front().metric});
    for (std::size_t row = 0; row < trials_.size(); ++row) {
      const Json& trial = *trials_[row];
      const auto n = trial.at("n").get<std::uint64_t>();
      Json cells = Json::array({n, text(trial, "status")});
      for (const Json& value : trial.at("axes")) cells.push_back(printable(value.get<std::string>()));
      for (const std::size_t g : shown) {
        const Json& value = trial.at("values").at(g);
        cells.push_back(value.is_null() ? Json() : Json(value.get<double>()));
      }
      const bool is_feasible = trial.at("feasible").get<bool>();
      cells.push_back(is_feasible);
      cells.push_back(trial.contains("ruled_out_by") ? "ruled out by " + text(trial, "ruled_out_by")
                                                     : text(trial, "error"));
      std::vector<std::string> commands;
      for (const Json& run : trial.at("runs")) {
        if (run.contains("command")) commands.push_back(text(run, "command"));
      }
      cells.push_back(fmt::format("{}", fmt::join(commands, "; ")));
      points.push_back(std::move(cells));
      done += trial.at("status") == "done" ? 1 : 0;
      if (std::ranges::any_of(json_.at("front"), [&](const Json& f) { return f == n; })) front.push_back(row);
      if (&trial == best_) best[goals_.front().metric] = row;
    }
    for (const Goal& goal : goals_) texts_of.push_back(goal.text);
    const std::size_t y = shown.front(), x = shown.size() > 1 ? shown[1] : y;
    return {{"name", name},
            {"question", text(json_, "question")},
            {"goals", std::move(texts_of)},
            {"axes", std::move(axes)},
            {"metrics", std::move(metrics)},
            {"points", std::move(points)},
            {"has_constraints", std::ranges::any_of(goals_, [](const Goal& g) { return !g.is_objective; })},
            {"limits", limits_json()},
            {"headlines", std::move(headlines)},
            {"best", std::move(best)},
            {"noun", "machine"},
            {"workloads", nullptr},
            {"ties", ""},
            {"start",
             {{"x", goals_[x].metric}, {"y", goals_[y].metric}, {"front", std::move(front)}, {"near", Json::array()}}},
            {"sensitivities", Json::array()},
            {"notices", notices_json()}};
  }

 private:
  static std::string printable(const std::string& words) { return sim::printable(words, kLongestWords); }
  static std::string text(const Json& node, const char* key) { return printable(node.at(key).get<std::string>()); }
  static Json texts(const Json& list) {
    Json out = Json::array();
    for (const Json& each : list) out.push_back(printable(each.get<std::string>()));
    return out;
  }

  std::vector<std::size_t> shown_goals() const {
    std::vector<std::size_t> shown;
    for (std::size_t g = 0; g < goals_.size(); ++g) {
      const auto is_same = [&](std::size_t s) { return goals_[s].metric == goals_[g].metric; };
      if (std::ranges::none_of(shown, is_same)) shown.push_back(g);
    }
    return shown;
  }
  std::string probability_text(std::size_t goal) const {
    const Json& all = json_.at("probabilities");
    return all.empty() ? "" : fmt::format("{:.0f} %", 100 * all.at(goal).get<double>());
  }
  Json notices_json() const {
    Json out = Json::array();
    for (const Json& line : json_.at("extrapolations")) {
      out.push_back(printable("Best machine: " + line.get<std::string>()));
    }
    return out;
  }
  /// Returns per constraint how many machines meet it, and the best machine's value, 95 % interval and distance to it.
  Json limits_json() const {
    Json out = Json::array();
    for (std::size_t g = 0; g < goals_.size(); ++g) {
      const Goal& goal = goals_[g];
      if (goal.is_objective) continue;
      std::uint64_t met = 0;
      for (const Json* trial : trials_) {
        const Json& value = trial->at("values").at(g);
        met += !value.is_null() && goal.is_met(value.get<double>()) ? 1 : 0;
      }
      Json cells = Json::array({goal.text, met, nullptr, "", ""});
      if (best_ != nullptr && !best_->at("values").at(g).is_null()) {
        const double value = best_->at("values").at(g).get<double>();
        const double half = best_->at("half_widths").at(g).get<double>();
        cells = Json::array({goal.text, met, value,
                             value == 0 ? "" : fmt::format("± {:.2g} %", 100 * half / std::abs(value)),
                             goal.room_text(value)});
      }
      out.push_back(std::move(cells));
    }
    return out;
  }
  /// Returns a scatter plot of the objective over the metric of a constraint, power if any; null without constraints.
  Json scatter_json() const {
    std::optional<std::size_t> x;
    for (std::size_t g = 0; g < goals_.size(); ++g) {
      const bool is_other = !goals_[g].is_objective && goals_[g].metric != goals_.front().metric;
      if (is_other && (!x || (goals_[g].path.find("power") != std::string::npos &&
                              goals_[*x].path.find("power") == std::string::npos)))
        x = g;
    }
    if (!x) return {};
    Json rows = Json::array();
    for (const Json* trial : trials_) {
      const Json &values = trial->at("values"), &halves = trial->at("half_widths");
      if (values.at(*x).is_null() || values.at(0).is_null()) continue;
      const double h = values.at(*x).get<double>(), v = values.at(0).get<double>();
      const double dh = halves.at(*x).get<double>(), dv = halves.at(0).get<double>();
      std::vector<std::string> axes;
      for (const Json& value : trial->at("axes")) axes.push_back(printable(value.get<std::string>()));
      rows.push_back(Json::array({trial->at("n").get<std::uint64_t>(), h, v, h - dh, h + dh, v - dv, v + dv,
                                  trial == best_                      ? "best"
                                  : trial->at("feasible").get<bool>() ? "meets all limits"
                                                                      : "breaks a limit",
                                  fmt::format("{}", fmt::join(axes, ", ")), Json(), Json()}));
      const Json& bands = json_.at("bands");
      if (trial != best_ || bands.empty()) continue;
      Json& cells = rows.back();
      cells[cells.size() - 2] = bands.at(*x).at(0).get<double>();
      cells[cells.size() - 1] = bands.at(*x).at(1).get<double>();
    }
    return {
        {"x", goals_[*x].metric}, {"y", goals_.front().metric}, {"limit", goals_[*x].limit}, {"rows", std::move(rows)}};
  }
  Json trades_json() const {
    Json out = {{"metrics", Json::array()}, {"rows", Json::array()}};
    const std::vector<std::size_t> shown = shown_goals();
    for (const std::size_t g : shown) out["metrics"].push_back(goals_[g].metric);
    for (const Json& trade : json_.at("trades")) {
      Json cells =
          Json::array({text(trade, "axis"), text(trade, "from"), text(trade, "to"), trade.at("gain").get<double>()});
      for (const std::size_t g : shown) {
        const Json& value = trade.at("values").at(g);
        cells.push_back(value.is_null() ? Json() : Json(value.get<double>()));
      }
      std::string breaks;
      if (!trade.at("breaks").is_null()) breaks = goals_.at(trade.at("breaks").get<std::size_t>()).text;
      if (const std::string on = text(trade, "on"); !on.empty()) breaks += " on " + on;
      cells.push_back(breaks);
      cells.push_back(trade.at("simulated").get<bool>() ? "simulated" : "estimated");
      out["rows"].push_back(std::move(cells));
    }
    return out;
  }

  const Json& json_;
  std::vector<Goal> goals_;
  std::vector<std::string> workloads_;
  std::vector<const Json*> trials_;
  const Json* best_ = nullptr;
};

}  // namespace

void add_search_page_data(const fs::path& folder, Json& page) {
  const fs::path file = folder / optimise::kSearchFile;
  std::error_code ignored;
  if (!fs::is_regular_file(file, ignored)) return;
  try {
    const std::string bytes = sim::read_file(file, kLargestSearch);
    if (sim::is_nested_deeper(bytes, sim::kDeepestJson)) throw sim::InputError("is nested too deeply");
    const Json json = sim::parse_json(bytes);
    const SearchFile search(json);
    Json member = search.member();
    if (!search.has_point_per_machine()) page = search.page_data(page.at("name").get<std::string>());
    page["search"] = std::move(member);
  } catch (const sim::JsonError& error) {
    page["notices"].push_back(fmt::format("search.json is damaged: {}", sim::printable(error.what())));
  } catch (const sim::InputError& error) {
    page["notices"].push_back(fmt::format("search.json {}", sim::printable(error.what())));
  }
}

}  // namespace tools::pages
