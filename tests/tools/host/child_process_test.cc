#include <csignal>
#include <cstdlib>
#include <string>

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tools/host/process.h"

namespace test {
namespace {

TEST(ChildProcess, SendsATextLongerThanItsPipe) {
  const std::string text(1 << 20, 'x');
  tools::ChildProcess child([&] { return text; });
  while (child.receive_data()) {
  }
  EXPECT_EQ(child.received_text(), text);
  const int status = child.wait_for_exit();
  EXPECT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 0);
}

TEST(ChildProcess, ReturnsTheStatusOfAChildWithoutAText) {
  tools::ChildProcess child([]() -> std::string { std::_Exit(7); });
  EXPECT_FALSE(child.receive_data());
  EXPECT_EQ(WEXITSTATUS(child.wait_for_exit()), 7);
  EXPECT_EQ(child.received_text(), "");
}

TEST(ChildProcess, IsKilledByTheDestructor) {
  int ends[2];
  ASSERT_EQ(::pipe(ends), 0);
  {
    tools::ChildProcess child([]() -> std::string {
      for (;;) ::pause();
    });
    ::close(ends[1]);
  }
  char byte = 0;
  EXPECT_EQ(::read(ends[0], &byte, 1), 0) << "the child held the other writing end and is gone";
  ::close(ends[0]);
}

}  // namespace
}  // namespace test
