#pragma once
#include <chrono>

namespace sim {

/// The host's own time, for what reports say of the host; never for what is simulated.
using HostClock = std::chrono::steady_clock;

inline double seconds_since(HostClock::time_point begin) {
  return std::chrono::duration<double>(HostClock::now() - begin).count();
}

}  // namespace sim
