#include <algorithm>
#include <cctype>
#include <sstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/tools/program.h"
#include "tools/analysis/report.h"

namespace test {
namespace {

using Json = nlohmann::ordered_json;

/// The longest number of a line's cells, in digits from the first that is not 0.
std::ptrdiff_t most_digits(const std::string& line) {
  std::ptrdiff_t most = 0;
  std::istringstream cells(line);
  for (std::string cell; cells >> cell;) {
    if (cell.find_first_not_of("0123456789.") != std::string::npos) continue;
    cell.erase(0, cell.find_first_not_of("0."));
    most = std::max(most, std::ranges::count_if(cell, [](unsigned char c) { return std::isdigit(c) != 0; }));
  }
  return most;
}

TEST(ReportTable, HasEnergiesOfFourDigitsAtMost) {
  const TempFolder folder;
  ASSERT_EQ(raywatt(small_run(folder.path() / "out")).exit, 0);
  Json report = Json::parse(read_bytes(folder.path() / "out" / "report.json"));
  for (const char* group : {"energy_by_block_mj", "energy_by_kind_mj"}) {
    for (Json& band : report["totals"][group]) {
      for (Json& side : band) side = 1e5 * side.get<double>() + 12.3456789;
    }
  }
  std::istringstream lines(tools::report_table(report));
  std::size_t rows = 0;
  for (std::string line; std::getline(lines, line);) {
    if (!line.ends_with(" %") || line.starts_with(" ")) continue;
    EXPECT_LE(most_digits(line), 4) << line;
    EXPECT_GE(most_digits(line), 3) << line;
    ++rows;
  }
  EXPECT_GT(rows, 10U);
}

}  // namespace
}  // namespace test
