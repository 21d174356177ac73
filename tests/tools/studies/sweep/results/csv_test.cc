#include <gtest/gtest.h>

#include "tools/studies/sweep/results/results.h"

namespace test {
namespace {

using tools::results::csv_cell;

TEST(CsvCell, QuotesCommasQuotesAndLineEnds) {
  EXPECT_EQ(csv_cell("16 KiB"), "16 KiB");
  EXPECT_EQ(csv_cell("a,b"), "\"a,b\"");
  EXPECT_EQ(csv_cell("a\"b"), "\"a\"\"b\"");
  EXPECT_EQ(csv_cell("a\nb"), "\"a\nb\"");
}

TEST(CsvCell, LeavesNoFormulaForASpreadsheet) {
  EXPECT_EQ(csv_cell("=1+1"), "'=1+1");
  EXPECT_EQ(csv_cell("@SUM(A1)"), "'@SUM(A1)");
  EXPECT_EQ(csv_cell("+cmd"), "'+cmd");
  EXPECT_EQ(csv_cell("-a"), "'-a");
  EXPECT_EQ(csv_cell("\ta"), "'\ta");
  EXPECT_EQ(csv_cell("=a,b"), "\"'=a,b\"");
}

TEST(CsvCell, LeavesNegativeNumbersNumbers) {
  EXPECT_EQ(csv_cell("-1.5"), "-1.5");
  EXPECT_EQ(csv_cell("-2e-05"), "-2e-05");
}

}  // namespace
}  // namespace test
