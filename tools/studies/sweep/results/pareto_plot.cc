#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "tools/studies/sweep/results/cells.h"
#include "tools/studies/sweep/results/pareto.h"

namespace tools::results {
namespace {

constexpr std::size_t kHeight = 20, kLeastWidth = 40, kMostWidth = 160;

/// Where the values of an objective lie.
struct Range {
  double low = 0, high = 0;
  std::string low_text, high_text;

  Range(const Objective& objective, const std::vector<std::size_t>& rows) {
    const auto by_value = [&](std::size_t a, std::size_t b) { return *objective.of(a) < *objective.of(b); };
    const auto [least, most] = std::ranges::minmax_element(rows, by_value);
    low = *objective.of(*least);
    high = *objective.of(*most);
    low_text = end_text(objective, *least);
    high_text = end_text(objective, *most);
  }
  static std::string end_text(const Objective& objective, std::size_t row) {
    const Value& value = objective.column.values[row];
    return std::holds_alternative<std::string>(value) ? std::get<std::string>(value) : shown(*objective.of(row));
  }
  std::size_t cell(double value, std::size_t cells) const {
    if (high == low) return cells / 2;
    return static_cast<std::size_t>(std::lround((value - low) / (high - low) * static_cast<double>(cells - 1)));
  }
};

}  // namespace

std::string pareto_plot(const Objective& x, const Objective& y, const ParetoFront& front, std::size_t width) {
  const std::vector<std::size_t> all = front.all();
  const Range xs(x, all), ys(y, all);
  const std::size_t margin = std::max(xs.low_text.size() / 2, std::max(ys.low_text.size(), ys.high_text.size()));
  const std::size_t columns = std::clamp(width, kLeastWidth, kMostWidth) - margin - 3;
  std::vector<std::string> lines(kHeight, std::string(columns, ' '));
  const auto cell = [&](std::size_t row) -> char& {
    return lines[kHeight - 1 - ys.cell(*y.of(row), kHeight)][xs.cell(*x.of(row), columns)];
  };
  for (const std::size_t row : front.other) cell(row) = '.';
  for (const std::size_t row : front.near) cell(row) = '~';
  for (std::size_t i = front.rows.size(); i-- > 0;) cell(front.rows[i]) = front.mark(i);

  std::string out = fmt::format("{}\n", y.text());
  for (std::size_t line = 0; line < kHeight; ++line) {
    const std::string& label = line == 0 ? ys.high_text : line == kHeight - 1 ? ys.low_text : std::string();
    out += fmt::format("{:>{}} |{}", label, margin, lines[line]);
    out.erase(out.find_last_not_of(' ') + 1);
    out += '\n';
  }
  const std::size_t between = columns + 1 - std::min(columns, xs.low_text.size() + xs.high_text.size());
  out += fmt::format("{:>{}} +{:->{}}\n", "", margin, "", columns);
  out += fmt::format("{:>{}}  {}{:>{}}{}\n", "", margin, xs.low_text, "", between - 1, xs.high_text);
  const std::string title = x.text();
  out += fmt::format("{:>{}}\n", title, std::max(title.size(), margin + 2 + columns));
  out += fmt::format("{} of {} points are on the front: {}; dots are the others\n", front.rows.size(), all.size(),
                     front.mark(0) == '#' ? "#" : "letters, as in the table");
  if (std::ranges::find(front.sure, false) != front.sure.end()) {
    out += "a letter with ~: noise does not tell whether another point is as good in both\n";
  }
  if (!front.near.empty()) {
    out += fmt::format("{} more may be, marked ~: none beats them by more than the band\n", front.near.size());
  }
  return out;
}

}  // namespace tools::results
