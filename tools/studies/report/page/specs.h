#pragma once
#include <string>
#include <utility>
#include <vector>

#include "tools/studies/report/page/page_model.h"

namespace tools::pages {

// Vega-Lite specifications of the pages' charts. Fields are those of the datasets; data come by name.

/// A value and the colour in which it is drawn.
using Colours = std::vector<std::pair<std::string, std::string>>;

/// A field of a chart, and how it is shown; `format` is of d3-format.
struct Axis {
  std::string field, title;
  std::string format = {};
};

/// Horizontal bars, one a row in the order of the data, each with its value at its end. They begin at `from`.
Json bars_spec(const Axis& category, const Axis& value, const std::string& label_field, double from = 0);

/// Horizontal bars of the whole length 1, divided into parts in the order of `colours`; parts of some size are named.
Json stack_spec(const Axis& category, const std::string& part, const std::string& share, const Colours& colours);

/// From a first total through signed changes to a last one: fields name, from, to, kind (total, more, less), label.
/// `format` of the axis: "~s" with metric prefixes, for counts.
Json waterfall_spec(const std::string& title, const std::string& unit, const std::string& format);

/// Lines over a number.
Json lines_spec(const Axis& x, const Axis& y, const std::string& series);

/// Points under lines on logarithmic axes: fields x, y, line (empty for points), name, label (above or below its line,
/// before or behind its point).
Json roofline_spec();

/// Figures over time, one a column: stacked areas, or lines. Fields begin_us and the columns.
/// `colours`: one for each of them, or none: as they come.
Json series_spec(const std::vector<std::string>& names, const std::string& unit, bool stacked,
                 const Colours& colours = {});

/// Bars of shares for each metric, side by side: fields metric, axis, share, low, high, label.
Json sensitivity_spec();

}  // namespace tools::pages
