#pragma once
#include <chrono>

#include <time.h>

namespace sim {

/// Wall clock of the host, for measuring the simulator itself; never for simulated time.
using HostClock = std::chrono::steady_clock;

inline double seconds_since(HostClock::time_point begin) {
  return std::chrono::duration<double>(HostClock::now() - begin).count();
}

/// Returns the processor time used by the calling thread, in seconds.
inline double thread_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace sim
