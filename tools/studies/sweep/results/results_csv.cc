#include "tools/studies/sweep/results/results_csv.h"

#include <algorithm>
#include <iterator>

#include <fmt/format.h>

#include "tools/studies/sweep/results/csv.h"

namespace tools::results {

std::string results_csv(const Collection& all) {
  std::vector<std::string> header = {"n", "id", "status"};
  for (const auto* names : {&all.axes, &all.metrics}) header.insert(header.end(), names->begin(), names->end());
  std::string out = csv_line(header);
  for (std::size_t i = 0; i < all.points.size(); ++i) {
    const ListedPoint& point = all.points[i];
    out += fmt::format("{},{},{}", point.n, point.id, name_of(all.states[i].status));
    for (const std::string& axis : all.axes) {
      const auto found = std::ranges::find(point.axes, axis, &std::pair<std::string, std::string>::first);
      out += ',';
      if (found != point.axes.end()) out += csv_cell(found->second);
    }
    for (const std::vector<Value>& column : all.columns) {
      out += ',';
      if (const auto* text = std::get_if<std::string>(&column[i])) {
        out += csv_cell(*text);
      } else if (const auto* whole = std::get_if<std::int64_t>(&column[i])) {
        fmt::format_to(std::back_inserter(out), "{}", *whole);
      } else if (const auto* real = std::get_if<double>(&column[i])) {
        fmt::format_to(std::back_inserter(out), "{}", *real);
      }
    }
    out += '\n';
  }
  return out;
}

}  // namespace tools::results
