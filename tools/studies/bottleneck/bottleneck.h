#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "tools/analysis/top_down.h"
#include "tools/noise/noise.h"
#include "tools/run/frame/job_options.h"

namespace tools {

class Progress;

/// Time of a frame on a machine in which one resource is ideal. The difference from the time of the configured machine
/// is the most that improving this resource can gain.
struct Bound {
  std::string resource;
  std::uint64_t cycles = 0;  ///< cycles of the T&I clock
  double estimated = 1;      ///< speed-up estimated from the counters of the configured run
  Draws plays{};             ///< statistics of the cycles over all replicates
};

/// Statistics of the first-level caches of one kind, summed over the machine, in the run as configured.
struct CacheShare {
  std::string name;          ///< "node", "triangle", "data"
  double hit_rate = 0;       ///< hits per probe
  double cycles_a_miss = 0;  ///< mean miss time, in cycles of the cache's clock
  double share = 0;          ///< share of core time spent waiting for misses of this kind
};

/// The bottleneck of a frame: estimated from performance counters, and measured by runs with ideal resources.
struct Bottleneck {
  std::uint64_t cycles = 0;
  std::string limiter;  ///< description of the estimated bottleneck
  CoreTime time;
  std::string named;  ///< resource with the largest estimated speed-up
  std::vector<Bound> bounds;
  std::vector<CacheShare> caches;
  Draws plays{};             ///< cycles of all replicates of the configured run
  double assumed_noise = 0;  ///< noise of `cycles` that is assumed without replicates (default_noise())
  std::vector<std::string> warnings{};
  double speedup_of(const Bound& bound) const {
    return static_cast<double>(cycles) / static_cast<double>(bound.cycles);
  }
};

/// The speed-up that an ideal resource gives, with its noise: measured by replicates, or assumed for single runs.
struct NoisySpeedup {
  double value = 1;
  double half_width = 0;  ///< half-width of the speed-up's 95 % interval
  bool outside = false;   ///< the speed-up differs from 1 by more than its noise
};
NoisySpeedup noisy_speedup(const Bottleneck& found, const Bound& bound);

/// Simulates the first frame once as configured and once for each resource with that resource ideal. Throws InputError,
/// sim::Deadlock.
Bottleneck find_bottleneck(const JobOptions& options, Progress* progress = nullptr);

}  // namespace tools
