#pragma once
#include <atomic>
#include <span>
#include <vector>

#include "sim/intervals.h"
#include "sim/unit_report.h"

namespace tools {

/// Receives a frame while it is simulated. The simulation thread calls it at tile ends, only when a frame was
/// requested, so that thread reads no clock.
class RunWatcher {
 public:
  virtual ~RunWatcher() = default;
  /// Called before a machine's first cycle, with its units and the intervals that it records.
  virtual void begin(std::vector<sim::UnitReport> units, const sim::Intervals* intervals) = 0;
  bool wants() const { return wanted_.load(std::memory_order_relaxed); }
  /// Called with the picture so far, in linear light.
  virtual void note(std::span<const float> rgb) = 0;

 protected:
  std::atomic<bool> wanted_{false};
};

}  // namespace tools
