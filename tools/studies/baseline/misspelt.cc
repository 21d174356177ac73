#include "tools/studies/baseline/misspelt.h"

#include <algorithm>
#include <cctype>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "sim/edit_distance.h"
#include "sim/error.h"
#include "sim/io/printable.h"
#include "tools/analysis/report_paths.h"
#include "tools/studies/baseline/measure.h"

namespace tools {
namespace {

/// Small runs of another scene, one of each program with and without a reference.
Suite probes_of(const Suite& suite) {
  Suite probes;
  for (const SuiteRun& run : suite.runs) {
    const auto is_like = [&](const SuiteRun& other) {
      return other.options.program == run.options.program && other.options.reference == run.options.reference;
    };
    if (std::ranges::any_of(probes.runs, is_like)) continue;
    SuiteRun probe = run;
    probe.options.scene = "cornell";
    probe.options.camera = probe.options.frames = "";
    probe.options.resolution = "16x16";
    probe.options.replicates = 1;
    std::erase_if(probe.options.sets, [](const std::string& set) { return set.starts_with("scene."); });
    probes.runs.push_back(std::move(probe));
  }
  return probes;
}

/// "units.core0.srp" and "units.core3.srp" are paths of one kind.
std::string without_numbers(std::string path) {
  std::erase_if(path, [](unsigned char c) { return std::isdigit(c) != 0; });
  return path;
}

/// Last parts of a path, as many as `text` has.
std::string end_like(const std::string& path, std::string_view text) {
  std::size_t begin = path.size();
  for (auto parts = std::ranges::count(text, '.') + 1; parts > 0 && begin != std::string::npos; --parts) {
    begin = begin == 0 ? std::string::npos : path.rfind('.', begin - 1);
  }
  return begin == std::string::npos ? path : path.substr(begin + 1);
}

/// The nearest end of the paths that reports of all scenes have; empty if all are far off.
std::string nearest_end_like(const std::string& text, const std::vector<std::string>& paths) {
  constexpr std::string_view kNominal = ".nominal";
  std::set<std::string> known;
  for (const std::string& path : paths) {
    if (path.starts_with("units.") || path.find(".kernels.") != std::string::npos) continue;
    known.insert(end_like(path, text));
    if (path.ends_with(kNominal)) known.insert(end_like(path.substr(0, path.size() - kNominal.size()), text));
  }
  const std::string_view start = sim::comparable_start(text);
  const auto found = sim::find_nearest(start, known, std::max<std::size_t>(1, start.size() / 4));
  return found == known.end() ? std::string() : *found;
}

/// Is there something that `text` means, or may mean?
bool is_known(const std::string& text, const std::vector<std::string>& kinds) {
  try {
    return !report_path_group(without_numbers(text), kinds).empty();
  } catch (const sim::InputError&) {  // several
    return true;
  }
}

}  // namespace

void refuse_misspelt(const Suite& suite, std::uint32_t jobs) {
  std::vector<std::string> paths;
  try {
    measure(probes_of(suite), jobs, [&](const SuiteRun&, const Measured& probe) {
      for (const auto& [path, value] : probe.all) paths.push_back(path);
    });
  } catch (const sim::InputError&) {  // the run itself will say it, with its own scene
    return;
  }
  std::set<std::string> kinds;
  for (const std::string& path : paths) kinds.insert(without_numbers(path));
  const std::vector<std::string> known(kinds.begin(), kinds.end());
  for (const Kept& kept : suite.kept) {
    if (is_known(kept.text, known)) continue;
    if (const std::string nearest = nearest_end_like(kept.text, paths); !nearest.empty()) {
      throw sim::InputError(fmt::format("{}: keep: there is no report path '{}', did you mean '{}'?", kept.at,
                                        sim::printable(kept.text), nearest));
    }
  }
}

}  // namespace tools
