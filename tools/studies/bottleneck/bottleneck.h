#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "tools/analysis/top_down.h"
#include "tools/noise/noise.h"
#include "tools/run/frame/job_options.h"

namespace tools {

class Progress;

/// Cycles of a frame with one ideal resource.
struct Bound {
  std::string resource;
  std::uint64_t cycles = 0;  ///< cycles of the T&I clock
  double estimated = 1;      ///< speed-up estimated from the counters of the configured run
  Draws plays{};             ///< cycles of all replicates
};

/// First-level caches of a kind in the configured run. `ideal.l1` makes all kinds ideal.
struct CacheShare {
  std::string name;          ///< "node", "triangle", "data"
  double hit_rate = 0;       ///< per probe
  double cycles_a_miss = 0;  ///< mean miss time, in cycles of the cache's clock
  double share = 0;          ///< share of the time of the cores that waits for its misses
};

/// The bottleneck of a frame, estimated from the counters of one run and measured by runs with ideal resources.
struct Bottleneck {
  std::uint64_t cycles = 0;
  std::string limiter;  ///< description of the limiter
  CoreTime time;
  std::string named;  ///< resource with the largest estimate
  std::vector<Bound> bounds;
  std::vector<CacheShare> caches;
  Draws plays{};             ///< cycles of all replicates of the configured run
  double assumed_noise = 0;  ///< default_noise() of cycles, used without replicates
  std::vector<std::string> warnings{};
  double speedup_of(const Bound& bound) const {
    return static_cast<double>(cycles) / static_cast<double>(bound.cycles);
  }
};

/// Speed-up and its noise: of means of replicates, or of single runs with the assumed noise.
struct NoisySpeedup {
  double value = 1;
  double half_width = 0;  ///< half of its 95 % interval
  bool outside = false;   ///< the speed-up differs from 1 by more than the noise
};
NoisySpeedup noisy_speedup(const Bottleneck& found, const Bound& bound);

/// Simulates the first frame as configured, and once with each resource ideal. Throws InputError, sim::Deadlock.
Bottleneck find_bottleneck(const JobOptions& options, Progress* progress = nullptr);

}  // namespace tools
