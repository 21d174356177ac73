#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "sim/report/table.h"
#include "tools/studies/report/diff/diff_parts.h"

namespace tools::pages {
namespace {

constexpr double kLeast = 0.002;  ///< share of the larger total
constexpr std::size_t kMostRows = 12;
constexpr double kMargin = 0.12;             ///< share of the axis before the least bar ends
constexpr std::size_t kFrom = 2, kKind = 5;  ///< columns

std::string total_text(double value, const std::string& unit) {
  return unit.empty() ? sim::si_text(std::abs(value) < 1000 ? std::round(value) : value)
                      : fmt::format("{} {}", number_text(value), unit);
}

std::string change(double value, const std::string& unit) {
  return (value > 0 ? "+" : "−") + total_text(std::abs(value), unit);
}

}  // namespace

Dataset waterfall(const std::string& first, double a, const std::vector<Pair>& changes, const std::string& last,
                  double b, const std::string& unit) {
  Dataset data({{"name", "part"},
                {"change", "change", Show::kSi, unit},
                {"from", "from", Show::kSi, unit},
                {"to", "to", Show::kSi, unit},
                {"right", "right"},
                {"kind", "kind"},
                {"label", "shown"}});
  std::vector<std::vector<Json>> rows;
  double least_end = std::min(a, b), most_end = std::max(a, b);
  const auto row = [&](const std::string& name, double from, double to, const char* kind, const std::string& label) {
    const bool is_total = std::string_view(kind) == "total";
    rows.push_back({name, is_total ? Json() : Json(to - from), from, to, std::max(from, to), kind, label});
    least_end = std::min({least_end, from, to});
    most_end = std::max({most_end, from, to});
  };
  std::vector<Pair> sorted = changes;
  std::ranges::stable_sort(sorted, std::greater<>(), [](const Pair& pair) { return std::abs(pair.difference()); });
  const double least = kLeast * std::max(a, b);
  row(first, a, a, "total", total_text(a, unit));
  double at = a;
  std::size_t shown = 0;
  for (const Pair& pair : sorted) {
    const double difference = pair.difference();
    if (shown == kMostRows || std::abs(difference) < least) break;
    row(pair.name, at, at + difference, difference < 0 ? "less" : "more", change(difference, unit));
    at += difference;
    ++shown;
  }
  const double rest = b - at;
  if (shown < sorted.size() && std::abs(rest) > 1e-9 * std::max(a, b)) {
    const std::size_t left = sorted.size() - shown;
    row(left == 1 ? sorted.back().name : fmt::format("{} others", left), at, b, rest < 0 ? "less" : "more",
        change(rest, unit));
  }
  row(last, b, b, "total", total_text(b, unit));
  // The axis begins near the least of them, and so do the bars of both totals.
  const double begin = std::max(0.0, least_end - kMargin * (most_end - least_end));
  for (std::vector<Json>& cells : rows) {
    if (cells[kKind] == "total") cells[kFrom] = begin;
    data.row(std::move(cells));
  }
  return data;
}

void add_waterfalls(const Difference& d, View& view) {
  Section section(
      "waterfall", "What made the difference",
      "From the first run to the second: blue, less; orange, more. All steps together are the difference. Axes "
      "need not begin at 0.");
  const Pair* const cycles = d.figure("cycles");
  if (cycles != nullptr && !d.found.time.empty()) {
    view.data("cycles", waterfall(d.name_a, cycles->a, in_words(d.found.time), d.name_b, cycles->b, ""));
    section.chart("cycles-waterfall", "Cycles of an average core",
                  "Cycles of the first run, the change by each part of a core's time, cycles of the second", "cycles",
                  {{"kind", "waterfall"}, {"title", "T&I cycles"}, {"unit", "cycles"}, {"format", "~s"}});
  } else {
    section.text("Both runs spent the same cycles in the same parts.");
  }
  const Pair* const energy = d.figure("energy_mj");
  if (energy != nullptr && !d.found.blocks.empty()) {
    view.data("energy", waterfall(d.name_a, energy->a, d.found.blocks, d.name_b, energy->b, "mJ"));
    section.chart("energy-waterfall", "Energy by block, nominal",
                  "Energy of the first run, the change by each block, energy of the second", "energy",
                  {{"kind", "waterfall"}, {"title", "mJ"}, {"unit", "mJ"}, {"format", "~g"}});
  }
  view.add(section);
}

void add_keys(const Difference& d, View& view) {
  Section section("keys", "Keys that differ");
  if (d.found.config.empty()) {
    section.text("The configurations are equal.");
    return view.add(section);
  }
  Dataset data({{"key", "key"}, {"a", d.name_a}, {"b", d.name_b}});
  for (const KeyPair& key : d.found.config)
    data.row({key.key, key.a.empty() ? "none" : key.a, key.b.empty() ? "none" : key.b});
  view.data("keys", data);
  section.table("key-table", "Configuration", "keys");
  view.add(section);
}

}  // namespace tools::pages
