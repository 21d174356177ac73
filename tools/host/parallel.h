#pragma once
#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace tools {

/// Calls work(0) to work(count - 1) concurrently: the first on the calling thread, each other on a thread of its own.
/// Returns after all have ended. Rethrows the first exception, or the failure to start a thread.
template <typename Work>
void run_on_threads(std::size_t count, Work&& work) {
  std::mutex mutex;
  std::exception_ptr failure;
  const auto guarded = [&](std::size_t i) {
    try {
      work(i);
    } catch (...) {
      const std::lock_guard lock(mutex);
      if (!failure) failure = std::current_exception();
    }
  };
  {
    std::vector<std::jthread> others;
    others.reserve(count);
    for (std::size_t i = 1; i < count; ++i) others.emplace_back(guarded, i);
    if (count != 0) guarded(0);
  }
  if (failure) std::rethrow_exception(failure);
}

/// Calls work(i, thread) for each i below `count`, started in ascending order of i on at most `threads` threads (0
/// counts as 1), numbered from 0. No call starts after a failure. Rethrows the exception of the lowest i that failed,
/// for any number of threads.
template <typename Work>
void parallel_for(std::size_t count, std::size_t threads, Work&& work) {
  std::atomic<std::size_t> next = 0;
  std::vector<std::exception_ptr> failures(count);
  run_on_threads(std::min(std::max<std::size_t>(threads, 1), count), [&](std::size_t thread) {
    for (std::size_t i = next++; i < count; i = next++) {
      try {
        work(i, thread);
      } catch (...) {
        failures[i] = std::current_exception();
        next = count;
      }
    }
  });
  const auto first = std::ranges::find_if(failures, [](const std::exception_ptr& one) { return one != nullptr; });
  if (first != failures.end()) std::rethrow_exception(*first);
}

}  // namespace tools
