#include "tools/studies/baseline/check.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "sim/config/config.h"
#include "sim/error.h"
#include "tools/analysis/report_paths.h"
#include "tools/run/frame/load_config.h"
#include "tools/studies/baseline/misspelt.h"
#include "traces/accel/embree_tracer.h"

namespace tools {
namespace {

/// The suite's choice of the numbers of reports.
class Choice {
 public:
  explicit Choice(const Suite& suite) : suite_(suite) {}

  struct Chosen {
    std::string path;
    double percent = 0;
  };
  /// In the order of `keep`; what is named twice stands where it is first, with its last tolerance.
  std::vector<Chosen> of(const Values& all) {
    std::vector<std::string> paths;
    for (const auto& [path, value] : all) paths.push_back(path);
    std::vector<Chosen> out;
    std::map<std::string, std::size_t> index_of;
    for (const Kept& kept : suite_.kept) {
      for (std::string& path : group(kept, paths)) {
        found_.insert(kept.text);
        const auto [at, is_new] = index_of.emplace(path, out.size());
        if (is_new) out.push_back({std::move(path), 0});
        out[at->second].percent = kept.percent;
      }
    }
    return out;
  }
  void refuse_what_no_run_has(const Values& all) const {
    std::vector<std::string> paths;
    for (const auto& [path, value] : all) paths.push_back(path);
    for (const Kept& kept : suite_.kept) {
      if (found_.contains(kept.text)) continue;
      refused(kept, [&] { resolve_report_path(kept.text, paths); });
    }
  }

 private:
  static std::vector<std::string> group(const Kept& kept, const std::vector<std::string>& paths) {
    std::vector<std::string> out;
    refused(kept, [&] { out = report_path_group(kept.text, paths); });
    return out;
  }
  static void refused(const Kept& kept, const std::function<void()>& call) {
    try {
      call();
    } catch (const sim::InputError& error) {
      throw sim::InputError(fmt::format("{}: keep: {}", kept.at, error.what()));
    }
  }
  const Suite& suite_;
  std::set<std::string> found_;
};

/// Keys that say what work is done, rather than how fast.
const std::set<std::string>& function_keys() {
  static const std::set<std::string> keys = [] {
    std::set<std::string> out;
    for (const sim::FieldInfo& field : sim::list_fields(RunConfig{})) {
      if (field.affects == sim::Affects::kFunction) out.insert(field.path);
    }
    return out;
  }();
  return keys;
}

/// Removes the keys that change the recorded work from `keys` and adds a refusal for each.
void refuse_other_work(std::vector<KeyPair>& keys, std::vector<std::string>& refusals) {
  for (const KeyPair& key : keys) {
    if (!function_keys().contains(key.key)) continue;
    refusals.push_back(fmt::format("stored of other work: {} was {}, is {}", key.key, key.a, key.b));
  }
  std::erase_if(keys, [](const KeyPair& key) { return function_keys().contains(key.key); });
}

/// The reasons why values made from `was` with that Embree cannot be compared with values made from `is`; all other
/// keys that differ go to `keys`.
std::vector<std::string> refusals(const Facts& was, const std::string& embree, const Facts& is, ChangedKeys& keys) {
  std::vector<std::string> out;
  if (was.program != is.program) out.push_back(fmt::format("stored of program {}, now {}", was.program, is.program));
  keys = changed_keys(was.config, is.config);
  refuse_other_work(keys.changed, out);
  refuse_other_work(keys.of_one, out);
  if (was.scene_sha256 != is.scene_sha256) out.emplace_back("stored of another scene (scene_sha256 differs)");
  if (out.empty() && was.bvh_hash != is.bvh_hash) {
    std::string causes;
    if (embree != traces::embree_version()) {
      causes += fmt::format("; stored with Embree {}, this program has {}", embree, traces::embree_version());
    }
    for (const std::vector<KeyPair>* list : {&keys.changed, &keys.of_one}) {
      for (const KeyPair& key : *list) {
        if (key.key.starts_with("bvh.")) causes += fmt::format("; {} was {}, is {}", key.key, key.a, key.b);
      }
    }
    out.push_back(fmt::format("stored of another tree: bvh_hash was {:.12}..., is {:.12}...{}", was.bvh_hash,
                              is.bvh_hash, causes));
  }
  return out;
}

/// The unit whose counters moved most clearly: among the units of the changed keys, if these have counters that moved.
std::optional<LocatedRegression> locate(const ChangedKeys& keys, const Values& was, const Values& is) {
  std::optional<LocatedRegression> best;
  for (const KeyPair& key : keys.changed) {
    const auto found = largest_move_in(unit_of_key(key.key), was, is);
    if (found && (!best || found->clarity > best->clarity)) best = found;
  }
  return best ? best : locate_regression(was, is);
}

bool same(double was, double is, double percent) {
  return was == is || std::abs(is - was) <= percent / 100 * std::abs(was);
}

/// A figure that noise moves: means of replicates, now and as stored. Of stored values without replicates the value is
/// one draw, taken to deviate as those of now do.
Moved replicated(const std::string& path, const StoredRun& stored, const Draws& now) {
  const auto was = stored.draws.find(path);
  if (was != stored.draws.end()) {
    return {path, was->second.mean, now.mean, difference_of(was->second, now).half_width()};
  }
  const auto plays = static_cast<double>(now.count);
  const MeanDifference d{0, now.deviation * std::sqrt(1 + 1 / plays), plays - 1};
  return {path, stored.values.at(path), now.mean, d.half_width()};
}

void find_moved(const StoredRun& stored, const std::vector<Choice::Chosen>& chosen, const Measured& now,
                RunCheck& run) {
  std::set<std::string> known;
  for (const Choice::Chosen& c : chosen) {
    known.insert(c.path);
    const auto draws = now.draws.find(c.path);
    if (draws != now.draws.end() && stored.values.contains(c.path)) {
      Moved moved = replicated(c.path, stored, draws->second);
      const bool outside = std::abs(*moved.is - *moved.was) > *moved.noise;
      if (outside && !same(*moved.was, *moved.is, c.percent)) run.moved.push_back(std::move(moved));
      continue;
    }
    const double is = now.all.at(c.path);
    const auto was = stored.values.find(c.path);
    if (was == stored.values.end() && is != 0) {
      run.moved.push_back({c.path, std::nullopt, is, {}});
    } else if (was != stored.values.end() && !same(was->second, is, c.percent)) {
      run.moved.push_back({c.path, was->second, is, {}});
    }
  }
  for (const auto& [path, was] : stored.values) {
    if (!known.contains(path)) run.moved.push_back({path, was, std::nullopt, {}});
  }
}

}  // namespace

std::size_t Checked::count(bool (*of)(const RunCheck&)) const {
  return static_cast<std::size_t>(std::ranges::count_if(runs, of));
}

Checked check_suite(const Suite& suite, const Baseline* stored, std::uint32_t jobs,
                    const std::function<void(const RunCheck&)>& tell) {
  refuse_misspelt(suite, jobs);
  Checked out;
  out.now.embree = traces::embree_version();
  Choice choice(suite);
  Values one_of_them;
  measure(suite, jobs, [&](const SuiteRun& named, Measured measured) {
    RunCheck run;
    run.name = named.name;
    run.seconds = measured.seconds;
    run.error = measured.error;
    if (run.error.empty()) {
      const std::vector<Choice::Chosen> chosen = choice.of(measured.all);
      run.values = chosen.size();
      StoredRun& now = out.now.runs[named.name];
      now.facts = measured.facts;
      for (const Choice::Chosen& c : chosen) {
        if (const auto draws = measured.draws.find(c.path); draws != measured.draws.end()) now.draws.insert(*draws);
        if (const double value = measured.all.at(c.path); value != 0) now.values[c.path] = value;
      }
      const auto was = stored != nullptr ? stored->runs.find(named.name) : decltype(stored->runs.find(""))();
      if (stored != nullptr && was == stored->runs.end()) {
        run.refused.emplace_back("nothing is stored of it");
      } else if (stored != nullptr) {
        run.refused = refusals(was->second.facts, stored->embree, measured.facts, run.keys);
        find_moved(was->second, chosen, measured, run);
        if (run.refused.empty() && !run.moved.empty()) run.located = locate(run.keys, was->second.values, measured.all);
      }
      one_of_them = std::move(measured.all);
    }
    tell(run);
    out.runs.push_back(std::move(run));
  });
  if (!one_of_them.empty()) choice.refuse_what_no_run_has(one_of_them);
  return out;
}

}  // namespace tools
