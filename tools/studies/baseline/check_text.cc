#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include <fmt/format.h>

#include "tools/studies/baseline/check.h"

namespace tools {
namespace {

/// The first moved value with this beginning, or null.
const Moved* find_moved(const RunCheck& run, std::string_view path) {
  const auto found = std::ranges::find_if(run.moved, [&](const Moved& m) { return m.path.starts_with(path); });
  return found == run.moved.end() ? nullptr : &*found;
}

/// Counts as they are, others with six digits: small moves are to be seen.
std::string number_text(double number) {
  return number == std::trunc(number) && std::abs(number) < 1e15 ? fmt::format("{:.0f}", number)
                                                                 : fmt::format("{:.6g}", number);
}

bool is_clear(const RunCheck& run) { return run.located && run.located->is_clear(); }

std::string details(const RunCheck& run) {
  constexpr std::size_t kMost = 6;
  if (!run.error.empty()) return fmt::format("\n{}: {}\n", run.name, run.error);
  std::string out = fmt::format("\n{}\n", run.name);
  for (const std::string& why : run.refused) out += fmt::format("  {}\n", why);
  std::size_t shown = 0;
  const auto show = [&](bool of_units, std::string_view prefix) {
    for (const Moved& moved : run.moved) {
      if (moved.path.starts_with("units.") != of_units || !moved.path.starts_with(prefix)) continue;
      if (shown == kMost) return;
      out += fmt::format("  {}: {}\n", moved.path, moved_text(moved));
      shown += 1;
    }
  };
  show(false, "");
  const std::size_t figures = std::exchange(shown, 0);
  show(true, is_clear(run) ? fmt::format("units.{}.", run.located->unit) : "units.");
  if (figures + shown < run.moved.size()) {
    out += fmt::format("  and {} more values\n", run.moved.size() - figures - shown);
  }
  if (is_clear(run)) out += fmt::format("  most likely in {}: {}\n", run.located->unit, run.located->moved);
  return out;
}

}  // namespace

const RunCheck* clearest(const Checked& checked) {
  const RunCheck* best = nullptr;
  for (const RunCheck& run : checked.runs) {
    if (run.located && (best == nullptr || run.located->clarity > best->located->clarity)) best = &run;
  }
  return best;
}

std::string moved_text(const Moved& moved) {
  if (!moved.was) return fmt::format("{}, nothing stored", number_text(*moved.is));
  if (!moved.is) return fmt::format("was {}, is gone", number_text(*moved.was));
  const double difference = *moved.is - *moved.was;
  const std::string relative =
      *moved.was == 0 ? "" : fmt::format(", {:+.2g} %", 100 * difference / std::abs(*moved.was));
  const std::string noise = !moved.noise || *moved.was == 0
                                ? ""
                                : fmt::format(", noise ± {:.2g} %", 100 * *moved.noise / std::abs(*moved.was));
  return fmt::format("{} -> {} ({:+.4g}{}{})", number_text(*moved.was), number_text(*moved.is), difference, relative,
                     noise);
}

std::string check_line(const RunCheck& run) {
  if (!run.error.empty()) return fmt::format("FAILED   {}: {}", run.name, run.error.substr(0, run.error.find('\n')));
  if (!run.refused.empty()) return fmt::format("REFUSED  {}: {}", run.name, run.refused.front());
  if (run.moved.empty()) return fmt::format("ok       {}", run.name);
  const Moved* cycles = find_moved(run, "totals.cycles");
  const Moved& shown = cycles != nullptr ? *cycles : run.moved.front();
  return fmt::format("MOVED    {}: {} of {} values, {} {}", run.name, run.moved.size(), run.values, shown.path,
                     moved_text(shown));
}

std::string check_details(const Checked& checked) {
  constexpr std::size_t kMost = 6;
  std::vector<const RunCheck*> bad;
  for (const RunCheck& run : checked.runs) {
    if (!run.good()) bad.push_back(&run);
  }
  std::ranges::stable_sort(bad, std::greater<>(), [](const RunCheck* run) {
    return !run->error.empty() || !run->refused.empty() ? 2 : run->located ? run->located->clarity : 0;
  });
  std::string out;
  for (std::size_t i = 0; i < std::min(bad.size(), kMost); ++i) out += details(*bad[i]);
  if (bad.size() > kMost) out += fmt::format("\nand {} more runs; --junit writes all\n", bad.size() - kMost);
  if (const RunCheck* run = clearest(checked); run != nullptr) {
    out +=
        fmt::format("\n{} in {}, told most clearly by {}: {}\n", run->located->is_clear() ? "Most likely" : "Perhaps",
                    run->located->unit, run->name, run->located->moved);
  }
  std::vector<KeyPair> keys;
  for (const RunCheck* run : bad) {
    for (const KeyPair& key : run->config) {
      if (std::ranges::find(keys, key.key, &KeyPair::key) == keys.end()) keys.push_back(key);
    }
  }
  for (std::size_t i = 0; i < std::min(keys.size(), kMost); ++i) {
    out += fmt::format("The configuration has changed: {} was {}, is {}\n", keys[i].key, keys[i].a, keys[i].b);
  }
  if (keys.size() > kMost) out += fmt::format("and {} more keys have\n", keys.size() - kMost);
  return out;
}

}  // namespace tools
