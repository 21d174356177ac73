#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "sim/io/json.h"
#include "tools/studies/reproduce/runner.h"

namespace tools::reproduce {

/// Runs the experiments of a paper, compares measured with published values, and prints a table of both.
///   1. After each experiment the files in the output folder are updated: reproduce.md, reproduce.json and pictures.
///      The results are marked as partial until all experiments are done.
///   2. After an interruption the same call continues with the missing experiments.
///   3. If a scene is missing or broken, only the rows of this scene have no values.
/// Throws InputError for an unknown paper or an invalid configuration, before anything runs.
void reproduce(const Options& options);

/// A published value: a number or a range.
struct Range {
  double low = 0, high = 0;
  friend bool operator==(const Range&, const Range&) = default;
};

/// Identifies a published or measured value, e.g. "table 1", "teapot", "super", "psnr_db".
struct MetricKey {
  std::string experiment, scene, setting, metric;
  friend auto operator<=>(const MetricKey&, const MetricKey&) = default;
};

using PublishedValues = std::map<MetricKey, Range>;

/// Reads the published values of a paper from tests/validation/published/PAPER.yaml or from published/PAPER.yaml in one
/// of search_folders(). Throws InputError with line and column.
PublishedValues load_published_values(const std::string& paper);

/// Parses published values in YAML: nested mappings of experiment, scene, setting and metric. A value is a number or
/// {low: number, high: number}.
PublishedValues parse_published_values(const std::string& text, const std::string& name);

/// A row of the results of a paper: a metric with its measured and its published value.
struct Row {
  MetricKey key;
  std::string stand_in;
  std::uint32_t width = 0, height = 0;
  std::string program, reference;
  std::optional<double> measured;
  std::string why_not;  ///< reason that there is no measured value
  std::optional<Range> published;
};

struct Results {
  std::string paper, title, note;
  bool quick = false, partial = false;
  std::uint32_t shrink = 1;
  std::vector<Row> rows;  ///< in the order of measurement
};

/// Formats the results of a paper as a table for the terminal, or as Markdown with a table per experiment.
std::string results_text(const Results& results);
std::string results_markdown(const Results& results, const std::vector<std::string>& pictures);

}  // namespace tools::reproduce
