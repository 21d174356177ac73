#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "tools/analysis/top_down.h"
#include "tools/noise/statistics.h"
#include "tools/run/frame/job_options.h"

namespace tools {

class Progress;

/// Cycles of a frame with one resource made ideal.
struct Bound {
  std::string resource;
  std::uint64_t cycles = 0;  ///< cycles of the T&I clock
  double estimated = 1;      ///< the speed-up that the counters of the run as configured promise
  Draws plays{};             ///< cycles over all replicates
};

/// First-level caches of a kind, by the run as configured. `ideal.l1` makes all of them perfect at once.
struct CacheShare {
  std::string name;          ///< "node", "triangle", "data"
  double hit_rate = 0;       ///< share of the probes
  double cycles_a_miss = 0;  ///< cycles of the cache's clock
  double share = 0;          ///< part of the cores' time in which its misses are waited for
};
std::vector<CacheShare> cache_shares(std::span<const sim::UnitReport> units, const CoreTime& time);

/// The limit of a frame by one run's counters, and the most that each resource could bring, by further runs.
struct Bottleneck {
  std::uint64_t cycles = 0;
  std::string limiter;  ///< in words
  CoreTime time;
  std::string named;  ///< the resource that the counters name
  std::vector<Bound> bounds;
  std::vector<CacheShare> caches;
  Draws plays{};             ///< cycles over all replicates, as configured
  double assumed_noise = 0;  ///< default_noise() of cycles, where there are no replicates
  std::vector<std::string> warnings{};
  double speedup(const Bound& bound) const { return static_cast<double>(cycles) / static_cast<double>(bound.cycles); }
};

/// Speed-up of mean over mean by replicates of both, or else that of the runs with the assumed noise.
struct NoisySpeedup {
  double value = 1;
  double half_width = 0;  ///< half of its 95 % interval
  bool outside = false;   ///< beyond what noise explains
};
NoisySpeedup noisy_speedup(const Bottleneck& found, const Bound& bound);

/// Simulates the first frame once as configured and once with each resource made ideal. InputError, sim::Deadlock.
Bottleneck find_bottleneck(const JobOptions& options, Progress* progress = nullptr);

}  // namespace tools
