#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "tools/host/process.h"
#include "tools/host/standard_streams.h"
#include "tools/studies/optimise/answer.h"
#include "tools/studies/sweep/results/results.h"

namespace tools::optimise {

using sim::Json;

namespace {

/// Returns a machine's results as JSON, per workload: {workload, status, whole, command, values, errors, met}.
Json runs_json(const SearchRun& search, const std::vector<WorkloadRun>& runs) {
  Json all = Json::array();
  for (std::size_t w = 0; w < runs.size(); ++w) {
    const WorkloadRun& run = runs[w];
    Json json = {
        {"workload", search.workloads()[w]}, {"status", std::string(name_of(run.status))}, {"id", run.point.id}};
    if (run.status != PointStatus::kMissing) json["command"] = command_of(run);
    json["whole"] = run.point.tile_sampling.empty();
    if (run.is_done()) {
      for (std::size_t g = 0; g < search.goals().size(); ++g) {
        const bool has_value = std::isfinite(run.seen[g].value);
        json["values"].push_back(has_value ? Json(run.seen[g].value) : Json());
        json["half_widths"].push_back(has_value ? Json(run.seen[g].half_width()) : Json());
      }
    }
    all.push_back(std::move(json));
  }
  return all;
}

Json trial_json(const SearchRun& search, const Trial& trial) {
  Json json = {{"n", number_of(search, trial)},
               {"status", std::string(name_of(trial.status))},
               {"feasible", trial.is_feasible},
               {"error", trial.error},
               {"axes", Json::array()},
               {"values", Json::array()},
               {"half_widths", Json::array()},
               {"whole", !trial.is_sampled()},
               {"runs", runs_json(search, trial.best_runs())}};
  for (const auto& [name, value] : trial.axes) json["axes"].push_back(value);
  for (std::size_t g = 0; g < search.goals().size(); ++g) {
    const bool has_value = g < trial.seen.size() && trial.seen[g];
    json["values"].push_back(has_value ? Json(trial.value(g)) : Json());
    json["half_widths"].push_back(has_value ? Json(trial.seen[g]->half_width()) : Json());
  }
  if (trial.ruled_out_by) json["ruled_out_by"] = search.workloads()[*trial.ruled_out_by];
  return json;
}

Json trades_json(const Answer& answer) {
  Json all = Json::array();
  for (const Trade& trade : answer.trades) {
    Json json = {{"axis", trade.neighbour.axis},
                 {"from", trade.neighbour.from},
                 {"to", trade.neighbour.to},
                 {"gain", trade.gain},
                 {"simulated", trade.is_simulated},
                 {"feasible", trade.is_feasible},
                 {"breaks", Json()},
                 {"on", trade.broken_on},
                 {"values", Json::array()}};
    if (trade.breaks) json["breaks"] = *trade.breaks;
    for (const auto& value : trade.values) json["values"].push_back(value ? Json(*value) : Json());
    all.push_back(std::move(json));
  }
  return all;
}

}  // namespace

const Trial* Answer::best() const {
  if (std::ranges::count_if(search.goals(), &Goal::is_objective) != 1) return nullptr;
  const std::vector<const Trial*> front = search.pareto_front();
  return front.empty() ? nullptr : front.front();
}

std::string command_of(const WorkloadRun& run) { return command_text(run.point.run_options().argv); }

std::size_t number_of(const SearchRun& search, const Trial& trial) {
  return static_cast<std::size_t>(&trial - search.trials().data());
}

std::vector<std::size_t> shown_goals(const SearchRun& search) {
  std::vector<std::size_t> shown;
  for (std::size_t g = 0; g < search.goals().size(); ++g) {
    const auto is_same = [&](std::size_t s) {
      return search.goals()[s].metric_text() == search.goals()[g].metric_text();
    };
    if (std::ranges::none_of(shown, is_same)) shown.push_back(g);
  }
  return shown;
}

std::string front_csv(const SearchRun& search) {
  std::vector<std::string> names = {"n", "id"};
  const std::vector<const Trial*> front = search.pareto_front();
  const bool is_set = search.workloads().size() > 1;
  if (!front.empty()) {
    for (const auto& [name, value] : front.front()->axes) names.push_back(name);
  }
  for (const std::size_t g : shown_goals(search)) {
    const Goal& goal = search.goals()[g];
    names.push_back(goal.fold == sweep::SetMetric::Kind::kEach ? goal.metric : goal.metric_text());
  }
  for (const std::string& workload : search.workloads()) names.push_back(is_set ? "command on " + workload : "command");
  std::string text = results::csv_line(names);
  for (const Trial* trial : front) {
    std::vector<std::string> cells = {std::to_string(number_of(search, *trial)), trial->id};
    for (const auto& [name, value] : trial->axes) cells.push_back(value);
    for (const std::size_t g : shown_goals(search)) cells.push_back(fmt::format("{}", trial->value(g)));
    for (const WorkloadRun& run : trial->best_runs()) cells.push_back(command_of(run));
    text += results::csv_line(cells);
  }
  return text;
}

std::string history_jsonl(const SearchRun& search) {
  std::string text;
  for (const Trial& trial : search.trials()) {
    Json line = {
        {"n", number_of(search, trial)}, {"batch", trial.batch}, {"id", trial.id}, {"state", name_of(trial.status)}};
    if (trial.is_first_look) line["look"] = true;
    line["axes"] = Json::object();
    for (const auto& [name, value] : trial.axes) line["axes"][name] = value;
    if (trial.status == PointStatus::kDone) {
      line["feasible"] = trial.is_feasible;
      for (const std::size_t g : shown_goals(search)) {
        const Goal& goal = search.goals()[g];
        const std::string name = goal.fold == sweep::SetMetric::Kind::kEach ? goal.metric : goal.metric_text();
        if (trial.seen[g]) line["figures"][name] = trial.value(g);
      }
    }
    if (search.workloads().size() > 1 && trial.status != PointStatus::kImpossible) {
      for (std::size_t w = 0; w < trial.runs.size(); ++w) {
        line["workloads"][search.workloads()[w]] = name_of(trial.runs[w].status);
      }
      if (trial.ruled_out_by) line["ruled_out_by"] = search.workloads()[*trial.ruled_out_by];
    }
    if (!trial.whole.empty()) line["whole"] = true;
    if (!trial.error.empty()) line["error"] = trial.error;
    text += sim::json_line(line) + "\n";
  }
  return text;
}

Json search_json(const Answer& answer) {
  const SearchRun& search = answer.search;
  Json json = {{"schema", "raywatt-search/1"},
               {"question", search.task().space.question},
               {"sentence", answer_sentence(answer)},
               {"fidelity", search.fidelity_text()},
               {"confidence", search.task().confidence},
               {"workloads", search.workloads()},
               {"goals", Json::array()},
               {"axes", Json::array()},
               {"trials", Json::array()},
               {"front", Json::array()},
               {"best", Json()},
               {"has_point_per_machine", search.workloads().size() == 1 && !search.is_tiled()},
               {"checked", answer.is_checked},
               {"check_command", answer.check_command},
               {"not_priced", answer.not_priced},
               {"probabilities", Json::array()},
               {"bands", Json::array()},
               {"trades", trades_json(answer)},
               {"trade_sentences", Json::array()},
               {"extrapolations", Json::array()},
               {"simulated", search.simulated_count()}};
  if (answer.odds) {
    json["probabilities"] = answer.odds->met;
    json["probabilities"].push_back(answer.odds->all);
    for (const auto& [low, high] : answer.odds->bands) json["bands"].push_back(Json::array({low, high}));
  }
  for (const Goal& goal : search.goals()) {
    json["goals"].push_back({{"text", goal.text()},
                             {"metric", goal.metric_text()},
                             {"path", goal.metric},
                             {"objective", goal.is_objective()},
                             {"less", goal.is_less_better()},
                             {"limit", goal.is_objective() ? Json() : Json(goal.limit)}});
  }
  for (const sweep::Axis& axis : search.task().machine_axes()) {
    Json values = Json::array();
    for (const sweep::Axis::Value& value : axis.values) values.push_back(value.label);
    json["axes"].push_back({{"name", axis.name}, {"values", std::move(values)}});
  }
  for (const Trial& trial : search.trials()) {
    if (!trial.is_first_look && trial.status != PointStatus::kImpossible)
      json["trials"].push_back(trial_json(search, trial));
  }
  for (const Trial* trial : search.pareto_front()) json["front"].push_back(number_of(search, *trial));
  if (const Trial* best = answer.best()) {
    json["best"] = number_of(search, *best);
    for (const std::string& line : best->extrapolations()) json["extrapolations"].push_back(line);
    for (const std::string& sentence : trade_sentences(search, *best, answer.trades)) {
      json["trade_sentences"].push_back(sentence);
    }
    if (const auto binding = binding_limit(search, *best)) json["binding"] = *binding;
  }
  return json;
}

}  // namespace tools::optimise
