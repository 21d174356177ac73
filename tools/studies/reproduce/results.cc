#include "tools/studies/reproduce/results.h"

#include <algorithm>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "sim/io/json.h"
#include "sim/io/printable.h"
#include "sim/report/table.h"

namespace tools::reproduce {
namespace {

std::string measured_text(const Row& row) {
  if (!row.measured) return row.why_not;
  return metric_text(find_metric(row.figure.metric), *row.measured);
}

std::string published_text(const Row& row) {
  if (!row.published) return "";
  const Metric& metric = find_metric(row.figure.metric);
  const std::string low = metric_text(metric, row.published->low);
  return row.published->low == row.published->high ? low : low + " to " + metric_text(metric, row.published->high);
}

/// How far the measured figure is from the published one: dB, or a share of it.
std::string difference_text(const Row& row) {
  if (!row.measured || !row.published) return "";
  const double value = *row.measured;
  const double nearest = std::clamp(value, row.published->low, row.published->high);
  if (row.published->low != row.published->high && value == nearest) return "within";
  if (find_metric(row.figure.metric).shown == Metric::Shown::kDecibel)
    return fmt::format("{:+.1f} dB", value - nearest);
  return fmt::format("{:+.0f} %", 100 * (value / nearest - 1));
}

std::string size_text(const Row& row) { return fmt::format("{}x{}", row.width, row.height); }

std::string heading(const Results& results) {
  std::string out = results.title;
  if (results.quick) out += ", quick: few pixels, so the figures only show that it runs";
  if (results.shrink > 1) out += fmt::format(", sides of pictures divided by {}", results.shrink);
  if (results.partial) out += "; PARTIAL: settings are left to be run";
  return out;
}

}  // namespace

std::vector<Row> by_experiment(std::vector<Row> rows) {
  std::vector<std::string> order;
  for (const Row& row : rows) {
    if (std::ranges::find(order, row.figure.experiment) == order.end()) order.push_back(row.figure.experiment);
  }
  std::ranges::stable_sort(rows, {}, [&](const Row& r) { return std::ranges::find(order, r.figure.experiment); });
  return rows;
}

sim::Json rows_json(const Results& results) {
  sim::Json out = sim::Json::array();
  for (const Row& row : results.rows) {
    sim::Json entry = {{"experiment", row.figure.experiment},
                       {"scene", row.figure.scene},
                       {"stand_in", sim::printable(row.stand_in, 4096)},
                       {"resolution", {row.width, row.height}},
                       {"setting", row.figure.setting},
                       {"program", row.program},
                       {"reference", row.reference},
                       {"figure", row.figure.metric}};
    entry["measured"] = row.measured ? sim::Json(*row.measured) : sim::Json(nullptr);
    if (!row.measured) entry["why_not"] = sim::printable(row.why_not, 4096);
    if (row.published && row.published->low == row.published->high) {
      entry["published"] = row.published->low;
    } else if (row.published) {
      entry["published"] = {row.published->low, row.published->high};
    } else {
      entry["published"] = nullptr;
    }
    out.push_back(std::move(entry));
  }
  return out;
}

std::string results_text(const Results& results) {
  sim::Table table({"experiment", "scene", "setting", "figure", "measured", "published", "difference"});
  for (const Row& row : by_experiment(results.rows)) {
    table.add_row({row.figure.experiment, row.figure.scene, row.figure.setting, row.figure.metric,
                   row.measured ? measured_text(row) : "-", published_text(row), difference_text(row)});
  }
  std::string out = heading(results) + "\n\n" + table.text();
  std::string before;
  for (const Row& row : results.rows) {
    const std::string line = fmt::format("{}, {}: {}\n", row.figure.scene, row.figure.setting, row.why_not);
    if (row.measured || line == before) continue;
    out += (before.empty() ? "\nnot measured\n" : "") + line;
    before = line;
  }
  if (!results.note.empty()) out += fmt::format("\n{}\n", results.note);
  return out;
}

namespace {

/// Programs that were run for each setting of an experiment, and their references.
std::string programs_markdown(std::span<const Row> rows) {
  std::string out = "\n| setting | run | held against |\n|---|---|---|\n";
  std::vector<std::string> listed;
  for (const Row& row : rows) {
    std::string line = fmt::format("| {} | `{}` | `{}` |\n", row.figure.setting, row.program, row.reference);
    if (std::ranges::find(listed, line) != listed.end()) continue;
    out += line;
    listed.push_back(std::move(line));
  }
  return out;
}

/// Each figure of an experiment over its scenes: median and range.
std::string scenes_markdown(std::span<const Row> rows) {
  std::string out;
  std::vector<std::pair<std::string, std::string>> listed;
  for (const Row& row : rows) {
    const std::pair figure{row.figure.setting, row.figure.metric};
    if (std::ranges::find(listed, figure) != listed.end()) continue;
    listed.push_back(figure);
    std::vector<double> values;
    for (const Row& other : rows) {
      const bool same = other.figure.setting == figure.first && other.figure.metric == figure.second;
      if (same && other.measured) values.push_back(*other.measured);
    }
    if (values.size() < 2) continue;
    std::ranges::sort(values);
    const double median = (values[(values.size() - 1) / 2] + values[values.size() / 2]) / 2;
    const auto text = [&](double value) { return metric_text(find_metric(figure.second), value); };
    out += fmt::format("| {} | {} | {} | {} | {} to {} | {} |\n", figure.first, figure.second, values.size(),
                       text(median), text(values.front()), text(values.back()), published_text(row));
  }
  if (out.empty()) return out;
  return "\n| setting | figure | scenes | median | range | published |\n|---|---|---|---|---|---|\n" + out;
}

std::string experiment_markdown(std::span<const Row> rows) {
  std::string out = fmt::format("\n## {}\n", rows.front().figure.experiment);
  out += programs_markdown(rows) + scenes_markdown(rows);
  out +=
      "\n| scene | stand-in | pixels | setting | figure | measured | published | difference |\n"
      "|---|---|---|---|---|---|---|---|\n";
  for (const Row& row : rows) {
    const std::string stand_in = std::filesystem::path(row.stand_in).filename().string();
    out += fmt::format("| {} | {} | {} | {} | {} | {} | {} | {} |\n", row.figure.scene, stand_in, size_text(row),
                       row.figure.setting, row.figure.metric, measured_text(row), published_text(row),
                       difference_text(row));
  }
  return out;
}

}  // namespace

std::string results_markdown(const Results& results, const std::vector<std::string>& pictures) {
  std::string out = fmt::format("# {}\n", heading(results));
  if (!results.note.empty()) out += fmt::format("\n{}\n", results.note);
  const std::vector<Row> rows = by_experiment(results.rows);
  for (auto first = rows.begin(); first != rows.end();) {
    const auto last = std::find_if(first, rows.end(),
                                   [&](const Row& row) { return row.figure.experiment != first->figure.experiment; });
    out += experiment_markdown({first, last});
    first = last;
  }
  if (!pictures.empty()) out += "\n## Pictures\n";
  for (const std::string& picture : pictures) out += fmt::format("\n{}\n\n![{}]({})\n", picture, picture, picture);
  return out;
}

}  // namespace tools::reproduce
