#pragma once
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "sim/io/json.h"
#include "tools/studies/reproduce/metrics.h"

namespace tools::reproduce {

/// A published value: a number or a range.
struct Range {
  double low = 0, high = 0;
  friend bool operator==(const Range&, const Range&) = default;
};

/// Identifies a value: "table 1", "teapot", "super", "psnr_db".
struct MetricKey {
  std::string experiment, scene, setting, metric;
  friend auto operator<=>(const MetricKey&, const MetricKey&) = default;
};

using Published = std::map<MetricKey, Range>;

/// Reads the published values of a paper from tests/validation/published/PAPER.yaml or from published/PAPER.yaml in one
/// of search_folders(). InputError with line and column.
Published load_published(const std::string& paper);

/// Parses the text: experiment: scene: setting: {metric: number, metric: {low: number, high: number}}.
Published parse_published(const std::string& text, const std::string& name);

/// A measured and a published value.
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

/// Groups rows by experiment, in the order in which experiments first occur.
std::vector<Row> by_experiment(std::vector<Row> rows);

sim::Json rows_json(const Results& results);
/// Returns a table for the terminal, and Markdown with a table per experiment.
std::string results_text(const Results& results);
std::string results_markdown(const Results& results, const std::vector<std::string>& pictures);

/// Results in the output folder of an earlier run.
struct Former {
  std::size_t rows = 0;       ///< number of rows; fewer rows do not replace them
  std::vector<Row> finished;  ///< rows of an interrupted run of the same experiments, which are reused
};

/// Reads reproduce.json in the folder, if it exists. A row is finished if paper, sizes, program and configuration equal
/// those of `head`, the header of this run, and its scene file has not changed.
Former load_former(const std::filesystem::path& folder, const sim::Json& head);

/// Returns the SHA-256 of a scene file; empty for a built-in scene.
std::string digest_of_file(const std::filesystem::path& scene);

}  // namespace tools::reproduce
