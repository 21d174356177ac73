#pragma once
#include <string>

#include "tools/analysis/report_file.h"
#include "tools/studies/compare/compare.h"
#include "tools/studies/report/page/page_model.h"

namespace tools::pages {

/// Two runs with what explains their difference, and their names.
struct Difference {
  const ReportFile &a, &b;
  std::string name_a, name_b;
  const Comparison& found;

  /// A figure of both; nothing if there is none.
  const Pair* figure(std::string_view name) const;
};

void add_diff_verdict(const Difference& d, View& view);
void add_waterfalls(const Difference& d, View& view);
void add_keys(const Difference& d, View& view);
void add_diff_pictures(const Difference& d, View& view);
void add_explanations(const Difference& d, View& view);

/// Figures of the second run's tiles less those of the first, as grids of a picture's block.
struct TileDifferences {
  Json grids = Json::array();  ///< one for each figure that differs anywhere
  std::string note;            ///< those that do not differ, or why tiles are not compared
};
TileDifferences tile_differences(const Difference& d);

/// Rows of a waterfall from the first total through changes, the largest first, to the second; what is below two
/// thousandths of the larger total, or behind the twelfth, is one row, under its own name if it is one part.
Dataset waterfall(const std::string& first, double a, const std::vector<Pair>& changes, const std::string& last,
                  double b, const std::string& unit);

}  // namespace tools::pages
