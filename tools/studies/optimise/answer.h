#pragma once
#include <optional>
#include <string>
#include <vector>

#include "sim/io/json.h"
#include "tools/studies/optimise/search_run.h"
#include "tools/studies/optimise/trade.h"

namespace tools::optimise {

/// The result of a search, and what was found out about it.
struct Answer {
  const SearchRun& search;
  std::vector<Trade> trades{};  ///< of the best machine, with one objective
  std::optional<Odds> odds{};   ///< of the best machine; nothing if unknown
  std::string not_priced{};     ///< reason that there are no probabilities
  double seconds = 0;           ///< host time of the search
  bool is_checked = false;      ///< whole frames of the front were simulated on request
  std::string check_command{};  ///< simulates whole frames of the front; empty if there is no file for it

  const Trial* best() const;
};

/// Returns the command that runs a machine on a workload again.
std::string command_of(const WorkloadRun& run);
/// Returns the number of a machine: the index of its line in history.jsonl, from 0.
std::size_t number_of(const SearchRun& search, const Trial& trial);

/// Returns the front, or the best machine, with tables of what limits it; or why no machine is feasible.
std::string answer_text(const Answer& answer);
/// Returns the counts of machines and simulations.
std::string summary_text(const Answer& answer);
/// Returns the front with all digits: axes, metrics, commands.
std::string front_csv(const SearchRun& search);
/// Returns a line of JSON per machine in the order of the search.
std::string history_jsonl(const SearchRun& search);
/// Returns what the page of a search shows (schema raywatt-search/1).
sim::Json search_json(const Answer& answer);
/// Returns the answer of a search in a sentence: "Machine 7 with ... has the least area_mm2 of 90 machines: 29.7."
std::string answer_sentence(const Answer& answer);

/// Returns the indices of the goals to show as columns: one goal for each metric.
std::vector<std::size_t> shown_goals(const SearchRun& search);
/// Returns feasible machines off the front that equal it within the noise.
std::vector<const Trial*> near_front(const SearchRun& search);
/// Names the source of the noise of the objectives; empty without noise.
std::string noise_text(const SearchRun& search);

}  // namespace tools::optimise
