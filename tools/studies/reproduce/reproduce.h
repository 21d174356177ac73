#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "sim/io/json.h"
#include "tools/studies/reproduce/runner.h"

namespace tools::reproduce {

/// Runs the experiments of a paper and compares measured with published values.
///   1. After each setting the output folder has reproduce.md, reproduce.json and pictures, marked partial until all
///      are done. At the end the table is printed.
///   2. If it is stopped, the same call continues with the missing settings.
///   3. A missing or broken scene loses only its own rows.
/// Throws InputError for an unknown paper or an invalid configuration, before anything runs.
void reproduce(const Options& options);

/// A published value: a number or a range.
struct Range {
  double low = 0, high = 0;
  friend bool operator==(const Range&, const Range&) = default;
};

/// Identifies a published or measured value: "table 1", "teapot", "super", "psnr_db".
struct MetricKey {
  std::string experiment, scene, setting, metric;
  friend auto operator<=>(const MetricKey&, const MetricKey&) = default;
};

using Published = std::map<MetricKey, Range>;

/// Reads the published values of a paper from tests/validation/published/PAPER.yaml or from published/PAPER.yaml in one
/// of search_folders(). Throws InputError with line and column.
Published load_published(const std::string& paper);

/// Parses the text: experiment: scene: setting: {metric: number, metric: {low: number, high: number}}.
Published parse_published(const std::string& text, const std::string& name);

/// A row of the results: a metric with its measured and its published value.
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

/// Returns a table for the terminal, and Markdown with a table per experiment.
std::string results_text(const Results& results);
std::string results_markdown(const Results& results, const std::vector<std::string>& pictures);

}  // namespace tools::reproduce
