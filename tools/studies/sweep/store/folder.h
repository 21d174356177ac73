#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "sim/io/file.h"
#include "sim/io/json.h"
#include "tools/studies/sweep/spec/point.h"
#include "tools/studies/sweep/store/store.h"

namespace tools::sweep {

/// The folder of a sweep: its points and where their results are.
///
///   sweep.json     schema, store, arguments for Slurm; identifies the folder of a sweep
///   sweep.yaml     the sweep's file
///   points.jsonl   one point a line, in the order of all tables
///   index.sqlite, results.csv   made from the results of the points
///   log/           output of workers; runs.jsonl: time, duration, points and utilisation of each run
class SweepFolder {
 public:
  enum class Of : std::uint8_t { kSweep, kSearch };

  /// Opens the folder of a sweep or a search. InputError if it is none.
  static SweepFolder open(const std::filesystem::path& path);
  /// Creates the folder if it is missing and locks it; nothing if another process holds it. InputError for a folder
  /// with other contents.
  static std::optional<sim::FileLock> try_claim(const std::filesystem::path& path, Of of);
  /// Writes a sweep or a search into a folder that the caller has claimed; replaces the former one.
  static SweepFolder create(const std::filesystem::path& path, Of of, const std::string& spec,
                            const std::vector<Point>& points, const std::filesystem::path& store,
                            const std::vector<std::string>& slurm);

  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path log_folder() const { return path_ / "log"; }
  Store store() const { return Store(store_); }
  const std::vector<std::string>& slurm_arguments() const { return slurm_; }
  std::vector<Point> read_points() const;

  struct Runner {
    std::string host;
    int process = 0;
  };
  /// Returns the process that runs the sweep, if one does.
  std::optional<Runner> find_runner() const;

  /// IoError if the folder was moved or removed during the run.
  void check_exists() const;
  /// Appends a line to log/runs.jsonl.
  void log_run(const sim::Json& run) const;

 private:
  explicit SweepFolder(std::filesystem::path path) : path_(std::move(path)) {}

  std::filesystem::path path_, store_;
  std::vector<std::string> slurm_;
};

}  // namespace tools::sweep
