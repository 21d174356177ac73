#include "tools/studies/microbench/figure.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "sim/io/json.h"
#include "sim/report/report_json.h"
#include "sim/report/table.h"

namespace tools {
namespace {

using Holds = Figure::Holds;

constexpr double kTolerance = 0.02;

const char* words_for(Holds holds) {
  switch (holds) {
    case Holds::kExactly:
      return "exactly";
    case Holds::kClosely:
      return "within 2 %";
    case Holds::kNearly:
      return "nine tenths or more";
    case Holds::kAtMost:
      return "an upper bound";
    case Holds::kAtLeast:
      return "a lower bound";
  }
  return "";
}

std::string table_of_figures(const Findings& findings) {
  sim::Table table({findings.title, "measured", "closed form", "", "difference", "holds", "", ""});
  for (const Figure& f : findings.figures) {
    table.add_row({f.name, fmt::format("{:.3f}", f.measured), fmt::format("{:.3f}", f.expected), f.unit,
                   fmt::format("{:+.2f} %", 100 * f.relative_error()), words_for(f.holds), f.remark,
                   f.good() ? "" : "MISSED"});
  }
  return table.text();
}

}  // namespace

bool Figure::good() const {
  switch (holds) {
    case Holds::kExactly:
      return std::abs(measured - expected) <= 1e-9 * std::abs(expected);
    case Holds::kClosely:
      return std::abs(measured - expected) <= kTolerance * expected;
    case Holds::kNearly:
      return measured >= 0.9 * expected && measured <= expected;
    case Holds::kAtMost:
      return measured <= (1 + kTolerance) * expected;
    case Holds::kAtLeast:
      return measured >= expected;
  }
  return false;
}

double Figure::relative_error() const { return measured == expected ? 0 : measured / expected - 1; }

bool Findings::good() const {
  return std::ranges::all_of(figures, [](const Figure& f) { return f.good(); });
}

UpperBound least(const std::vector<UpperBound>& bounds) {
  constexpr double kClear = 1.5;
  UpperBound tightest = *std::ranges::min_element(bounds, {}, &UpperBound::value);
  for (const UpperBound& bound : bounds) tightest.reached &= bound.reached || bound.value > kClear * tightest.value;
  return tightest;
}

std::string table_of(const Findings& findings) {
  std::string text = findings.table.empty() ? table_of_figures(findings) : findings.table;
  for (const std::string& note : findings.notes) text += "\n" + note + "\n";
  return text;
}

std::string json_of(std::string_view benchmark, const Findings& findings) {
  sim::Json figures = sim::Json::array();
  for (const Figure& f : findings.figures) {
    figures.push_back({{"name", f.name},
                       {"unit", f.unit},
                       {"measured", f.measured},
                       {"expected", f.expected},
                       {"relative_error", f.relative_error()},
                       {"holds", words_for(f.holds)},
                       {"remark", f.remark},
                       {"good", f.good()}});
  }
  return sim::json_text({{"schema", "raywatt-microbench/1"},
                         {"benchmark", benchmark},
                         {"title", findings.title},
                         {"figures", figures},
                         {"notes", findings.notes},
                         {"good", findings.good()}});
}

}  // namespace tools
