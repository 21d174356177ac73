#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "tools/run/frame/run_job.h"
#include "tools/studies/sweep/spec/point.h"
#include "tools/studies/sweep/store/store.h"

namespace tools::sweep {

/// Simulates points of a sweep one after the other and stores their results. Keeps a loaded scene and its BVH for the
/// next point. The process that simulates the last slice of a point also joins the results of all its slices.
class PointComputer {
 public:
  /// `threads`: host threads that simulate each point.
  PointComputer(const Store& store, std::uint32_t threads) : store_(store), threads_(threads) {}

  struct Order {
    bool record = false;  ///< record the rays of the frames, for other points to replay
    bool wait = false;    ///< wait if another process computes the point
    bool retry = false;   ///< compute the point although it failed before
    int attempt = 1;
  };
  /// Simulates a point. Returns kComputed, kDone (found in the store), kFailed or kLocked. An error of the point is
  /// recorded as a Failure. Throws IoError if the store cannot be written, and Interrupted.
  PointStatus compute_point(const Point& point, const Order& order);

 private:
  struct Recording {
    sim::FileLock lock;
    std::unique_ptr<traces::TraceWriter> trace;
  };

  void compute_now(const Point& point, const PointKeys::Key& key, const RunConfig& config, bool record);
  /// Records the frames of a point whose tiles are sampled, with their pilots, unless another process does.
  void record_samples(const Point& point, const PointKeys::Key& key, const RunConfig& config,
                      const JobOptions& options);
  void replay_stream(const Point& point, const PointKeys::Key& key, const RunConfig& config);
  void play_slice(const Point& slice, const PointKeys::Key& key, const RunConfig& config);
  void join_slices_of(const Point& whole, const PointKeys::Key& key, const RunConfig& config);
  /// Simulates the slices of a point that have no result. If one fails, it returns the failure of the whole point.
  std::optional<Failure> compute_missing_slices(const Point& whole, const Order& order);
  /// Joins all slices of the point to which `slice` belongs, if all have results and no other process is joining them.
  void join_if_complete(const Point& slice, const Order& order);
  void put_failure(const Point& point, const Failure& failure) const;
  /// Begins to record a stream: the rays of a point's frames, which other points replay. Returns nothing if it cannot
  /// be recorded or another process records it.
  std::optional<Recording> begin_recording(const std::string& stream, const Inputs& inputs, const JobOptions& options);
  /// Returns the scene and settings of a point. The caller may advance the scene to later frames. Throws IoError if the
  /// scene file has changed since the point was planned.
  Inputs& inputs_for(const Point& point, const PointKeys::Key& key, const RunConfig& config);

  const Store store_;
  const std::uint32_t threads_;
  PointKeys keys_;
  std::string inputs_key_;  ///< inputs_text() of inputs_; empty if they cannot be used again
  Inputs inputs_;
};

}  // namespace tools::sweep
