#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "sim/io/json.h"
#include "tools/studies/sweep/spec/point.h"
#include "tools/studies/sweep/store/lock.h"
#include "tools/studies/sweep/store/store.h"

namespace tools::sweep {

/// The folder of a sweep: which points it has, and where their results are. Everything else in it can be made again.
///
///   sweep.json     schema, store, arguments for Slurm; what makes this a sweep's folder
///   sweep.yaml     the sweep as it was given
///   points.jsonl   a point a line, in the order of all tables
///   results.csv    made from the points' results
///   log/           what workers said; runs.jsonl: when, how long, how many points, how busy the workers were
class SweepFolder {
 public:
  /// InputError if there is no sweep.
  static SweepFolder open(const std::filesystem::path& path);
  /// The owner of the points.
  enum class Of : std::uint8_t { kSweep, kSearch };
  /// Makes the folder, if it is not there, and holds it as long as somebody works in it; nothing if somebody else does.
  /// InputError for a folder of other things than a sweep or a search.
  static std::optional<Lock> claim(const std::filesystem::path& path, Of of);
  /// Writes a sweep or a search into a folder that the caller has claimed, in place of the former there.
  static SweepFolder create(const std::filesystem::path& path, Of of, const std::string& spec,
                            const std::vector<Point>& points, const std::filesystem::path& store,
                            const std::vector<std::string>& slurm);

  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path log() const { return path_ / "log"; }
  Store store() const { return Store(store_); }
  const std::vector<std::string>& slurm() const { return slurm_; }
  std::vector<Point> points() const;

  /// The process that runs it, if it is on this host.
  struct Runner {
    std::string host;
    int process = 0;
  };
  std::optional<Runner> runner() const;

  /// IoError if the folder was moved or removed after it was made.
  void check_there() const;
  /// Adds a line to log/runs.jsonl.
  void note_run(const sim::Json& run) const;

 private:
  explicit SweepFolder(std::filesystem::path path) : path_(std::move(path)) {}

  std::filesystem::path path_, store_;
  std::vector<std::string> slurm_;
};

}  // namespace tools::sweep
