#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "tools/run/frame/run_job.h"
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

/// Nothing is wrong with the point: it must not be kept as one that fails.
[[noreturn]] void refuse_changed(const Point& point);

/// A point's report into its folder, which is being put into the store.
void write_results(const std::filesystem::path& folder, const sim::Json& report, const RunConfig& config);

/// Computes points, one after the other, each into the store. Keeps a scene and its tree for the next point. Whoever
/// computes the last of a point's slices joins them.
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
  void play_slice(const Point& slice, const PointKeys::Key& key, const RunConfig& config);
  void join(const Point& whole, const PointKeys::Key& key, const RunConfig& config);
  /// Computes slices of a point that lack a result; why it has none if one of them fails.
  std::optional<Failure> complete(const Point& whole, const Order& order);
  /// Joins the slices of its point if all are there and nobody else does.
  void join_after(const Point& slice, const Order& order);
  void put_failure(const Point& point, const Failure& failure) const;
  /// From the recorded stream; InputError if that is of no use.
  void replay(const Point& point, const PointKeys::Key& key, const RunConfig& config);
  struct Recording {
    Lock lock;
    std::unique_ptr<traces::TraceWriter> trace;
  };
  /// Nothing if it cannot or need not be recorded.
  std::optional<Recording> begin_recording(const std::string& stream, const Inputs& inputs, const JobOptions& options);
  /// For a caller that moves them on to later frames, too. IoError for a scene file that is not the planned one.
  Inputs& inputs_for(const Point& point, const PointKeys::Key& key, const RunConfig& config);

  const Store store_;
  const std::uint32_t threads_;
  PointKeys keys_;
  std::string inputs_key_;  ///< what inputs_ were made from
  Inputs inputs_;
};

}  // namespace tools::sweep
