#pragma once
#include <cstdint>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "tools/studies/sweep/launch/compute.h"

namespace tools::sweep {

/// How a batch of points ended.
struct BatchEnd {
  std::vector<Fate> fates;  ///< fates of the points, in their order
  double seconds = 0;       ///< host: from the first point begun to the last one finished
  double busy = 0;          ///< share of that time in which workers had a point in hand; 0 if none was begun
  std::uint32_t workers = 0;
  bool interrupted = false;  ///< points may be missing
  std::uint64_t count(Fate fate) const;
};

/// Has points computed into a store. Afterwards Store::report() and Store::failure() tell what came out: points that
/// are there are not computed again, and those that failed before only if that is asked for.
///
///   LocalLauncher launcher(store, {.jobs = 2});
///   const BatchEnd end = launcher.run(points);
///   if (end.fates[0] != Fate::kFailed) use(*store.report(points[0].id));
///
/// Points need their keys (PointKeys::set_key). Two with one id are computed once. A point that fails, or crashes its
/// worker, is no reason to stop. Slices of points that are cut are handed out like points.
class Launcher {
 public:
  virtual ~Launcher() = default;
  Launcher(const Launcher&) = delete;
  Launcher& operator=(const Launcher&) = delete;

  /// Told when a point has ended, by its index in the batch.
  using Watch = std::function<void(std::size_t point, Fate fate)>;
  /// Told when a slice of a point has ended, however it has.
  using SliceWatch = std::function<void(std::size_t point)>;
  /// Returns when all points have ended, or when an interrupt waits (tools/host/interrupt.h; have a HoldInterrupts).
  /// IoError if the store cannot be written: points that are finished are kept.
  BatchEnd run(
      std::span<const Point> points, const Watch& watch = [](std::size_t, Fate) {},
      const SliceWatch& slice_watch = [](std::size_t) {});

 protected:
  Launcher(Store store, bool retry_failed) : store_(std::move(store)), retry_failed_(retry_failed) {}

  /// The same for points that are not cut, for slices, and for points whose slices have all ended.
  virtual BatchEnd play(std::span<const Point> points, const Watch& watch) = 0;

  /// Shall it be computed?
  bool is_wanted(const Point& point) const;
  /// Forgets why it failed, so that a failure seen later is a new one.
  void forget_failure(const Point& point) const;

  const Store store_;
  const bool retry_failed_;

 private:
  class CutBatch;
};

}  // namespace tools::sweep
