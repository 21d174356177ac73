#pragma once
#include <optional>
#include <string>
#include <vector>

#include "sim/io/json.h"
#include "tools/studies/optimise/search_run.h"
#include "tools/studies/optimise/trade.h"

namespace tools::optimise {

/// The result of a search, with trades and probabilities computed from it.
struct Answer {
  const SearchRun& search;
  std::vector<Trade> trades{};  ///< trades of the best machine; only with one objective
  std::optional<LimitProbabilities>
      odds{};                   ///< probabilities that the best machine meets its limits; nothing if unknown
  std::string not_priced{};     ///< reason that there are no probabilities
  double seconds = 0;           ///< host time of the search
  bool is_checked = false;      ///< the option --check simulated whole frames of the front's machines
  std::string check_command{};  ///< command that simulates whole frames of the front; empty if the search
                                ///< has no file

  const Trial* best() const;
};

/// Returns the command that runs a machine on a workload again.
std::string command_of(const WorkloadRun& run);
/// Returns the number of a machine: the index of its line in history.jsonl, from 0.
std::size_t number_of(const SearchRun& search, const Trial& trial);

/// Describes the Pareto front (or the best machine) and how near it is to its limits, or why no machine is feasible.
std::string answer_text(const Answer& answer);
/// Returns a summary of the search: the numbers of machines and simulations.
std::string summary_text(const Answer& answer);
/// Returns the Pareto front as CSV with all digits: axes, metrics, commands.
std::string front_csv(const SearchRun& search);
/// Returns the simulated machines as a line of JSON each, in the order of the search.
std::string history_jsonl(const SearchRun& search);
/// Returns the data for the HTML page of a search (schema raywatt-search/1).
sim::Json search_json(const Answer& answer);
/// Returns the result of a search in a sentence: "Machine 7 with ... has the least area_mm2 of 90 machines: 29.7."
std::string answer_sentence(const Answer& answer);

/// Returns the indices of the goals that tables show as columns: the first goal on each metric.
std::vector<std::size_t> shown_goals(const SearchRun& search);
/// Returns feasible machines that are not on the Pareto front, but within noise of it.
std::vector<const Trial*> near_front(const SearchRun& search);
/// Names the source of the noise of the objectives; empty without noise.
std::string noise_text(const SearchRun& search);

}  // namespace tools::optimise
