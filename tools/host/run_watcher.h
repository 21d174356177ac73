#pragma once
#include <atomic>
#include <span>
#include <vector>

#include "sim/intervals.h"
#include "sim/unit_report.h"

namespace tools {

/// Somebody who looks at a frame while it is played. Told by the thread that plays the machine, at the end of a tile,
/// and only when it has asked: that thread never looks at a clock.
class RunWatcher {
 public:
  virtual ~RunWatcher() = default;
  /// A machine begins; its units at rest, and where its intervals are taken down.
  virtual void begin(std::vector<sim::UnitReport> units, const sim::Intervals* intervals) = 0;
  bool wants() const { return wanted_.load(std::memory_order_relaxed); }
  /// The picture so far, in linear light.
  virtual void note(std::span<const float> rgb) = 0;

 protected:
  std::atomic<bool> wanted_{false};
};

}  // namespace tools
