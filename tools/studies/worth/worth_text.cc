#include <algorithm>
#include <cctype>
#include <cmath>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "sim/report/report_json.h"
#include "sim/report/table.h"
#include "tools/studies/worth/worth.h"

namespace tools::worth {
namespace {

using optimise::Goal;
using sim::Band;
using sim::Json;

constexpr double kNothing = 5e-4;  ///< share below which a difference counts as none

const Goal& objective_of(const Answer& answer) { return answer.file.sides.front().task.goals.front(); }
bool minimises(const Answer& answer) { return objective_of(answer).kind == Goal::Kind::kMin; }

/// Returns (b - a) / a under low, nominal and high tables.
Band relative_change(const Band& a, const Band& b) {
  const auto change = [](double from, double to) { return from == 0 ? 0 : (to - from) / from; };
  return {change(a.low, b.low), change(a.nominal, b.nominal), change(a.high, b.high)};
}

/// Returns a number with three digits: "8.1", "29.7", "1.23 M".
std::string three_digits(double value) {
  return std::abs(value) < 1000 ? fmt::format("{:.3g}", value) : sim::si_text(value);
}

std::string percent_text(double share) {
  const double percent = 100 * share;
  return fmt::format("{:.{}f}", percent, std::abs(percent) < 9.95 ? 1 : 0);
}

/// Returns the smallest and the largest value of a band of shares as text: "22 to 31 %".
std::string share_range(const Band& share) {
  const auto [least, most] = std::minmax({share.low, share.nominal, share.high});
  return fmt::format("{} to {} %", percent_text(least), percent_text(most));
}

bool is_band(const Band& band) { return band.low != band.nominal || band.high != band.nominal; }

/// Splits the name of a metric into its unit and its words: "area_mm2" is "mm2" and "area".
struct MetricWords {
  explicit MetricWords(std::string metric) : words(std::move(metric)) {
    if (words.ends_with("area_mm2")) {
      words = "die area";
      unit = " mm2";
    }
  }
  std::string words, unit;
};

/// Returns target rate and workloads as text: " at 60 frames/s on chess (512x256), cornell (512x256)".
std::string context_text(const Machine& machine) {
  std::vector<std::string> names;
  for (const WorkloadResult& workload : machine.workloads)
    names.push_back(fmt::format("{} ({})", workload.name, workload.resolution));
  const double fps = machine.workloads.front().target_fps;
  return fmt::format("{} on {}", fps > 0 ? fmt::format(" at {:.4g} frames/s", fps) : "", fmt::join(names, ", "));
}

std::string capital(std::string text) {
  if (!text.empty()) text[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[0])));
  return text;
}

std::string constraints_text(const Answer& answer) {
  std::vector<std::string> texts;
  for (const SideSearch& side : answer.file.sides) {
    for (const Goal& goal : side.task.goals) {
      if (!goal.is_objective() && std::ranges::find(texts, goal.text()) == texts.end()) texts.push_back(goal.text());
    }
  }
  return fmt::format("{}", fmt::join(texts, ", "));
}

/// Builds the table that compares the best machines of both sides. If a side has no machine, its cells are empty.
class SideBySide {
 public:
  explicit SideBySide(const Answer& answer) : answer_(answer), table_({"", "without", "with", "difference", "band"}) {}

  std::string text() {
    add_axes();
    const auto objective = [](const Machine& m) { return m.objective_band; };
    add_band(objective_of(answer_).metric_text(), objective);
    const Machine& any = *(answer_[Side::kWith].best ? answer_[Side::kWith] : answer_[Side::kWithout]).best;
    for (std::size_t w = 0; w < any.workloads.size(); ++w) add_workload(w, any);
    add_rooms("", [](const Machine& m) -> const std::vector<LimitRoom>& { return m.rooms; });
    return table_.text();
  }

 private:
  const Machine* machine(Side side) const { return answer_[side].best ? &*answer_[side].best : nullptr; }

  void add_axes() {
    std::vector<std::string> names;
    for (const Side side : kSides) {
      if (machine(side) == nullptr) continue;
      for (const auto& [name, value] : machine(side)->axes) {
        if (std::ranges::find(names, name) == names.end()) names.push_back(name);
      }
    }
    for (const std::string& name : names) {
      std::vector<std::string> cells = {name};
      for (const Side side : kSides) cells.push_back(axis_value(side, name));
      table_.add_row(std::move(cells));
    }
  }

  std::string axis_value(Side side, const std::string& name) const {
    if (machine(side) == nullptr) return "";
    const auto& axes = machine(side)->axes;
    const auto found = std::ranges::find(axes, name, &std::pair<std::string, std::string>::first);
    return found == axes.end() ? "" : found->second;
  }

  /// Adds a row for a value that has a low-to-high band.
  template <class F>
  void add_band(const std::string& name, F&& value_of) {
    std::vector<std::string> cells = {name};
    std::vector<Band> values;
    for (const Side side : kSides) {
      if (machine(side) != nullptr) values.push_back(value_of(*machine(side)));
      cells.push_back(machine(side) != nullptr ? sim::four_digit_text(values.back().nominal) : "");
    }
    if (values.size() == 2) {
      const Band change = relative_change(values[0], values[1]);
      cells.push_back(fmt::format("{:+.1f} %", 100 * change.nominal));
      if (is_band(values[0])) cells.push_back(share_range(change));
    }
    table_.add_row(std::move(cells));
  }

  void add_workload(std::size_t w, const Machine& any) {
    const WorkloadResult& one = any.workloads[w];
    const std::string prefix = any.workloads.size() > 1 ? one.name + ": " : "";
    add_band(prefix + "frames/s", [w](const Machine& m) {
      const double fps = m.workloads[w].fps;
      return Band{fps, fps, fps};
    });
    add_band(prefix + "mJ per frame", [w](const Machine& m) { return m.workloads[w].energy_mj; });
    const std::string at = one.target_fps > 0 ? fmt::format("W at {:.4g} frames/s", one.target_fps) : "W";
    add_band(prefix + at, [w](const Machine& m) { return m.workloads[w].power_w; });
    add_texts(prefix + "PSNR, dB", [w](const Machine& m) {
      const std::optional<double>& psnr = m.workloads[w].psnr_db;
      return psnr ? sim::four_digit_text(*psnr) : std::string();
    });
    add_rooms(prefix, [w](const Machine& m) -> const std::vector<LimitRoom>& { return m.workloads[w].rooms; });
  }

  /// Adds a row with the distance to the limit for each constraint.
  template <class F>
  void add_rooms(const std::string& prefix, F&& rooms_of) {
    std::vector<std::string> constraints;
    for (const Side side : kSides) {
      if (machine(side) == nullptr) continue;
      for (const LimitRoom& room : rooms_of(*machine(side))) {
        if (std::ranges::find(constraints, room.constraint) == constraints.end())
          constraints.push_back(room.constraint);
      }
    }
    for (const std::string& constraint : constraints) {
      add_texts(prefix + "room to " + constraint, [&](const Machine& m) {
        const std::vector<LimitRoom>& rooms = rooms_of(m);
        const auto found = std::ranges::find(rooms, constraint, &LimitRoom::constraint);
        return found == rooms.end() ? std::string() : found->text;
      });
    }
  }

  /// Adds a row of texts, unless both are empty.
  template <class F>
  void add_texts(const std::string& name, F&& text_of) {
    std::vector<std::string> cells = {name};
    for (const Side side : kSides) cells.push_back(machine(side) != nullptr ? text_of(*machine(side)) : "");
    if (!cells[1].empty() || !cells[2].empty()) table_.add_row(std::move(cells));
  }

  const Answer& answer_;
  sim::Table table_;
};

std::string check_text(const Answer& answer, Side side) {
  const SideAnswer& found = answer[side];
  const auto value = [](const std::optional<double>& objective) {
    return objective ? sim::four_digit_text(*objective) : std::string("none");
  };
  const std::optional<double> error = search_error(found);
  return fmt::format(
      "check, {}: the best of all machines has {} {} ({} simulated), the search found {}{}\n",
      names_of(side).at(static_cast<std::size_t>(side)), objective_of(answer).metric_text(),
      value(found.all->objective), found.all->machines,
      value(found.best ? std::optional(found.best->objective) : std::nullopt),
      error ? fmt::format(" ({:+.1f} %; accepted: {:.0f} %)", 100 * *error, 100 * kSearchTolerance) : "");
}

Json machine_json(const Machine& machine, const std::string& objective) {
  Json out = {{"axes", Json::object()}, {objective, sim::band_json(machine.objective_band)}};
  for (const auto& [name, value] : machine.axes) out["axes"][name] = value;
  for (const WorkloadResult& workload : machine.workloads) {
    Json entry = {{"name", workload.name}, {"resolution", workload.resolution},
                  {"id", workload.id},     {"command", workload.command},
                  {"fps", workload.fps},   {"energy_mj", sim::band_json(workload.energy_mj)},
                  {"room", Json::object()}};
    entry[workload.target_fps > 0 ? "power_at_fps_w" : "power_w"] = sim::band_json(workload.power_w);
    if (workload.target_fps > 0) entry["target_fps"] = workload.target_fps;
    if (workload.psnr_db) entry["psnr_db"] = *workload.psnr_db;
    for (const LimitRoom& room : workload.rooms) entry["room"][room.constraint] = room.room;
    out["workloads"].push_back(std::move(entry));
  }
  for (const LimitRoom& room : machine.rooms) out["room"][room.constraint] = room.room;
  return out;
}

}  // namespace

Band saved_share(const Machine& without, const Machine& with, bool is_minimised) {
  const Band change = relative_change(without.objective_band, with.objective_band);
  const double sign = is_minimised ? -1 : 1;
  return {sign * change.low, sign * change.nominal, sign * change.high};
}

std::optional<double> search_error(const SideAnswer& side) {
  if (!side.all || !side.all->objective || !side.best || *side.all->objective == 0) return {};
  return side.best->objective / *side.all->objective - 1;
}

bool is_confirmed(const SideAnswer& side) {
  if (!side.all) return true;
  if (side.best.has_value() != side.all->objective.has_value()) return false;
  return !side.best || std::abs(search_error(side).value_or(0)) <= kSearchTolerance;
}

std::string worth_sentence(const Answer& answer) {
  const std::string& feature = answer.file.feature;
  const std::optional<Machine>&without = answer[Side::kWithout].best, &with = answer[Side::kWith].best;
  const MetricWords metric(objective_of(answer).metric_text());
  const auto value = [&](const Machine& machine) { return three_digits(machine.objective) + metric.unit; };
  if (!without && !with)
    return fmt::format("No machine of either space meets the constraints, with or without {}.", feature);
  if (!without) {
    return fmt::format("Only with {} does a machine meet the constraints{}: the best has {} of {}.", feature,
                       context_text(*with), value(*with), metric.words);
  }
  if (!with) {
    return fmt::format("With {} no machine meets the constraints{}; without it the best has {} of {}.", feature,
                       context_text(*without), value(*without), metric.words);
  }
  const Band share = saved_share(*without, *with, minimises(answer));
  const std::string context = context_text(*with);
  if (std::abs(share.nominal) < kNothing) {
    return fmt::format("{} saves nothing in this space{}: {} of {} with and without it.", capital(feature), context, value(*with),
                       metric.words);
  }
  const bool is_good = share.nominal > 0;
  const char* const verb = minimises(answer) ? (is_good ? "saves" : "costs") : (is_good ? "gains" : "loses");
  const double sign = is_good ? 1 : -1;
  const Band shown{sign * share.low, sign * share.nominal, sign * share.high};
  return fmt::format("{} {} {}{} of {} ({} %{}){}: {} with it, {} without.", capital(feature), verb,
                     three_digits(std::abs(with->objective - without->objective)), metric.unit, metric.words,
                     percent_text(shown.nominal),
                     is_band(without->objective_band) ? ", band " + share_range(shown) : "", context, value(*with),
                     value(*without));
}

std::string worth_text(const Answer& answer) {
  std::string text = worth_sentence(answer) + "\n";
  if (const std::string constraints = constraints_text(answer); !constraints.empty())
    text += fmt::format("constraints: {}\n", constraints);
  if (answer[Side::kWith].best || answer[Side::kWithout].best) text += "\n" + SideBySide(answer).text();
  text += "\n";
  for (const Side side : kSides) {
    const SideAnswer& found = answer[side];
    text += fmt::format("{}: {} machines simulated{}; raywatt report {} -o FILE.html shows them\n",
                        names_of(side).at(static_cast<std::size_t>(side)), found.machines,
                        found.failed != 0 ? fmt::format(", {} failed (history.jsonl)", found.failed) : "",
                        found.folder.string());
    if (found.all) text += check_text(answer, side);
  }
  text += "\ncommands:\n";
  for (const Side side : kSides) {
    if (!answer[side].best) continue;
    for (const WorkloadResult& workload : answer[side].best->workloads)
      text += fmt::format("  {:<8} {}\n", names_of(side).at(static_cast<std::size_t>(side)), workload.command);
  }
  return text;
}

Json worth_json(const Answer& answer) {
  const Goal& objective = objective_of(answer);
  const std::string name = objective.metric_text();
  Json out = {{"schema", "raywatt-worth-result/1"}, {"feature", answer.file.feature},
              {"question", answer.file.question},   {"answer", worth_sentence(answer)},
              {"objective", objective.text()},      {"constraints", Json::array()}};
  std::set<std::string> seen;
  for (const SideSearch& side : answer.file.sides) {
    for (const Goal& goal : side.task.goals) {
      if (!goal.is_objective() && seen.insert(goal.text()).second) out["constraints"].push_back(goal.text());
    }
  }
  for (const Side side : kSides) {
    const SideAnswer& found = answer[side];
    Json& entry = out[std::string(names_of(side).at(static_cast<std::size_t>(side)))];
    entry = {{"machines", found.machines},
             {"failed", found.failed},
             {"folder", found.folder.string()},
             {"best", found.best ? machine_json(*found.best, name) : Json()}};
    if (!found.all) continue;
    entry["all"] = {{"machines", found.all->machines},
                    {name, found.all->objective ? Json(*found.all->objective) : Json()}};
    if (const std::optional<double> error = search_error(found)) entry["all"]["search_error"] = *error;
    entry["all"]["confirmed"] = is_confirmed(found);
  }
  const std::optional<Machine>&without = answer[Side::kWithout].best, &with = answer[Side::kWith].best;
  if (without && with) {
    out["difference"] = with->objective - without->objective;
    out["saved_share"] = sim::band_json(saved_share(*without, *with, minimises(answer)));
  }
  return out;
}

}  // namespace tools::worth
