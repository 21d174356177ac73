#include "tools/host/on_threads.h"

#include <array>
#include <atomic>
#include <functional>
#include <new>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

namespace {

TEST(OnThreads, EachNumberIsCalledOnceAndAllHaveEnded) {
  for (const std::size_t count : {0U, 1U, 2U, 7U}) {
    std::array<std::atomic<int>, 8> calls{};
    tools::on_threads(count, [&](std::size_t i) { ++calls[i]; });
    for (std::size_t i = 0; i < calls.size(); ++i) EXPECT_EQ(calls[i], i < count ? 1 : 0) << count;
  }
}

TEST(OnThreads, FailureOfAnyThreadReachesTheCallerWhenTheOthersHaveEnded) {
  for (const std::size_t failing : {0U, 1U, 3U}) {
    std::atomic<int> ended = 0;
    const auto work = [&](std::size_t i) {
      if (i == failing) throw std::bad_alloc();
      ++ended;
    };
    EXPECT_THROW(tools::on_threads(4, work), std::bad_alloc);
    EXPECT_EQ(ended, 3);
  }
}

TEST(OnThreads, OfSeveralFailuresOneReachesTheCaller) {
  EXPECT_THROW(tools::on_threads(3, [](std::size_t) { throw std::runtime_error("all"); }), std::runtime_error);
}

TEST(DoAll, DoesEachJobOnceForAnyNumberOfThreads) {
  for (const std::size_t threads : {0U, 1U, 2U, 5U}) {
    std::array<std::atomic<int>, 3> done{};
    std::vector<std::function<void()>> jobs;
    for (std::atomic<int>& one : done) jobs.emplace_back([&one] { ++one; });
    tools::do_all(jobs, threads);
    for (const std::atomic<int>& one : done) EXPECT_EQ(one, 1) << threads;
  }
  EXPECT_NO_THROW(tools::do_all({}, 2));
}

TEST(DoAll, ThrowsWhatAJobThrows) {
  const std::function<void()> fails = [] { throw std::runtime_error("full disk"); }, works = [] {};
  for (const std::size_t threads : {1U, 2U}) {
    EXPECT_THROW(tools::do_all({works, fails, works}, threads), std::runtime_error);
  }
}

}  // namespace
