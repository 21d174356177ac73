#include <algorithm>
#include <array>
#include <atomic>
#include <csignal>
#include <cstdlib>
#include <functional>
#include <new>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tools/host/parallel.h"
#include "tools/host/process.h"
#include "tools/host/standard_streams.h"

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

TEST(CommandText, QuotesWhatAShellWouldTakeApart) {
  EXPECT_EQ(tools::command_text({"raywatt", "-o", "out/a-1.html"}), "raywatt -o out/a-1.html");
  EXPECT_EQ(tools::command_text({"raywatt", "two words", ""}), "raywatt 'two words' ''");
  EXPECT_EQ(tools::single_quoted("it's"), R"('it'\''s')");
}

}  // namespace

}  // namespace test

namespace {

using Jobs = std::vector<std::function<void()>>;

void parallel_for(const Jobs& jobs, std::size_t threads) {
  tools::parallel_for(jobs.size(), threads, [&](std::size_t i, std::size_t thread) {
    EXPECT_LT(thread, std::max<std::size_t>(threads, 1));
    jobs[i]();
  });
}

TEST(RunOnThreads, EachNumberIsCalledOnceAndAllHaveEnded) {
  for (const std::size_t count : {0U, 1U, 2U, 7U}) {
    std::array<std::atomic<int>, 8> calls{};
    tools::run_on_threads(count, [&](std::size_t i) { ++calls[i]; });
    for (std::size_t i = 0; i < calls.size(); ++i) EXPECT_EQ(calls[i], i < count ? 1 : 0) << count;
  }
}

TEST(RunOnThreads, FailureOfAnyThreadReachesTheCallerWhenTheOthersHaveEnded) {
  for (const std::size_t failing : {0U, 1U, 3U}) {
    std::atomic<int> ended = 0;
    const auto work = [&](std::size_t i) {
      if (i == failing) throw std::bad_alloc();
      ++ended;
    };
    EXPECT_THROW(tools::run_on_threads(4, work), std::bad_alloc);
    EXPECT_EQ(ended, 3);
  }
}

TEST(RunOnThreads, OfSeveralFailuresOneReachesTheCaller) {
  EXPECT_THROW(tools::run_on_threads(3, [](std::size_t) { throw std::runtime_error("all"); }), std::runtime_error);
}

TEST(ParallelFor, DoesEachJobOnceForAnyNumberOfThreads) {
  for (const std::size_t threads : {0U, 1U, 2U, 5U}) {
    std::array<std::atomic<int>, 3> done{};
    Jobs jobs;
    for (std::atomic<int>& one : done) jobs.emplace_back([&one] { ++one; });
    parallel_for(jobs, threads);
    for (const std::atomic<int>& one : done) EXPECT_EQ(one, 1) << threads;
  }
  EXPECT_NO_THROW(parallel_for({}, 2));
}

TEST(ParallelFor, BeginsThemInOrderOnALimitedNumberOfThreads) {
  std::vector<int> order;
  Jobs jobs;
  for (int i = 0; i < 4; ++i) jobs.emplace_back([&order, i] { order.push_back(i); });
  parallel_for(jobs, 1);
  EXPECT_EQ(order, (std::vector<int>{0, 1, 2, 3}));

  std::atomic<int> at_work = 0, most = 0;
  const std::function<void()> work = [&] {
    const int now = ++at_work;
    for (int seen = most; seen < now && !most.compare_exchange_weak(seen, now);) {
    }
    std::this_thread::yield();
    --at_work;
  };
  parallel_for(Jobs(50, work), 3);
  EXPECT_LE(most, 3);
}

TEST(ParallelFor, ThrowsWhatTheFirstInTheOrderHasThrownAndBeginsNoMore) {
  const auto failing = [](const char* with) { return [with] { throw std::runtime_error(with); }; };
  for (const std::size_t threads : {1U, 2U, 3U}) {
    std::atomic<int> done = 0;
    Jobs jobs(100, [&] { ++done; });
    jobs[0] = failing("first");
    jobs[1] = failing("second");
    try {
      parallel_for(jobs, threads);
      ADD_FAILURE();
    } catch (const std::runtime_error& error) {
      EXPECT_STREQ(error.what(), "first") << threads;
    }
    if (threads == 1) {
      EXPECT_EQ(done, 0);
    }
  }
}

}  // namespace
