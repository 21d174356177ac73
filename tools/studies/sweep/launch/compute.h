#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "tools/simulation/run_job.h"
#include "tools/studies/sweep/spec/point_keys.h"
#include "tools/studies/sweep/store/store.h"

namespace tools::sweep {

/// The fate of a point.
enum class Fate : std::uint8_t {
  kComputed,  ///< its result is new
  kFound,     ///< its result was there
  kFailed,    ///< it cannot be computed; there is a Failure
  kLocked,    ///< another process is computing it
  kMissing,   ///< not computed yet
};
constexpr std::array<std::string_view, 5> names_of(Fate) {
  return {"computed", "found", "failed", "locked", "missing"};
}

/// Computes points, one after the other, each into the store. Keeps a scene and its tree for the next point.
class PointComputer {
 public:
  /// `threads` of the host for each.
  PointComputer(const Store& store, std::uint32_t threads) : store_(store), threads_(threads) {}

  struct Order {
    bool record = false;  ///< the recorded work is kept for points that share it
    bool wait = false;    ///< if another process computes the point
    bool retry = false;   ///< although it has failed before
    int attempt = 1;
  };
  /// A fault of the point becomes a Failure. IoError if the store cannot be written, Interrupted.
  Fate compute(const Point& point, const Order& order);

 private:
  void compute_now(const Point& point, const PointKeys::Key& key, const RunConfig& config, bool record);
  /// From the recorded stream; InputError if that is of no use.
  void replay(const Point& point, const PointKeys::Key& key, const RunConfig& config);
  struct Recording {
    Lock lock;
    std::unique_ptr<traces::TraceWriter> trace;
  };
  /// Nothing if it cannot or need not be recorded.
  std::optional<Recording> begin_recording(const std::string& stream, const Inputs& inputs, const JobOptions& options);
  /// For a caller that moves them on to later frames, too.
  Inputs& inputs_for(const RunConfig& config);

  const Store store_;
  const std::uint32_t threads_;
  PointKeys keys_;
  std::string inputs_key_;  ///< what inputs_ were made from
  Inputs inputs_;
};

}  // namespace tools::sweep
