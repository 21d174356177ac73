#include <gtest/gtest.h>

#include "tools/host/standard_streams.h"

namespace test {
namespace {

TEST(CommandText, QuotesWhatAShellWouldTakeApart) {
  EXPECT_EQ(tools::command_text({"raywatt", "-o", "out/a-1.html"}), "raywatt -o out/a-1.html");
  EXPECT_EQ(tools::command_text({"raywatt", "two words", ""}), "raywatt 'two words' ''");
  EXPECT_EQ(tools::single_quoted("it's"), R"('it'\''s')");
}

}  // namespace
}  // namespace test
