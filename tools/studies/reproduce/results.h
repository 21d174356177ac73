#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sim/io/json.h"
#include "tools/studies/reproduce/metrics.h"
#include "tools/studies/reproduce/published.h"

namespace tools::reproduce {

/// One figure, measured beside published.
struct Row {
  FigureKey figure;
  std::string stand_in;
  std::uint32_t width = 0, height = 0;
  std::string program, reference;
  std::optional<double> measured;
  std::string why_not;  ///< there is no measured figure
  std::optional<Range> published;
};

struct Results {
  std::string paper, title, note;
  bool quick = false, partial = false;
  std::uint32_t shrink = 1;
  std::vector<Row> rows;  ///< in the order measured
};

/// Rows of an experiment together, experiments in the order in which they first occur.
std::vector<Row> by_experiment(std::vector<Row> rows);

sim::Json rows_json(const Results& results);
/// A table for the terminal, and one per experiment for Markdown.
std::string results_text(const Results& results);
std::string results_markdown(const Results& results, const std::vector<std::string>& pictures);

}  // namespace tools::reproduce
