#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "sim/io/file.h"
#include "sim/io/json.h"
#include "tools/studies/sweep/spec/point.h"

namespace tools::sweep {

inline constexpr const char* kSliceFile = "slice.json";

/// Record of a point of a sweep that could not be computed.
struct Failure {
  std::string id;
  int exit = 0;  ///< exit code of `raywatt run`: 2 bad input, 3 deadlock of the machine, 70 our bug; 128 + signal
  std::string error;
  std::string log;  ///< last lines that the worker printed
  std::string host;
  int attempt = 1;
};

/// The results of points by point id. Any number of sweeps and hosts may share a store at the same time.
///
///   points/<2 hex>/<id>/      report.json, config.yaml, [image.png], point.json: the inputs whose hash is the id, a
///                             digest of each file. A slice has slice.json instead of the first two
///   failed/<2 hex>/<id>.json  a Failure
///   locks/<id>                held while the point is computed
///   tmp/                      point folders that are being written, then renamed
///   streams/<key>.trace       recorded rays that points of a sweep replay
///   damaged/                  point folders whose files do not match their digests
class Store {
 public:
  explicit Store(std::filesystem::path root) : root_(std::move(root)) {}
  /// Returns the default folder of a store: $RAYWATT_STORE, or raywatt-out/store.
  static std::filesystem::path default_root();

  const std::filesystem::path& root() const { return root_; }
  std::filesystem::path folder_of(const std::string& id) const;
  /// Returns the path of the file that records the failure of a point.
  std::filesystem::path failure_file(const std::string& id) const;
  std::filesystem::path stream_file(const std::string& key) const { return root_ / "streams" / (key + ".trace"); }

  /// Returns the status of a point: done, damaged, failed or missing. Reads all files of a result to check their
  /// digests. A result overrides a failure.
  PointStatus status_of(const std::string& id) const;
  bool is_done(const std::string& id) const { return status_of(id) == PointStatus::kDone; }
  /// Returns the bytes of a point's report.json; nothing if it is missing or does not match its digest.
  std::optional<std::string> read_report(const std::string& id) const { return read_verified_file(id, "report.json"); }
  /// Returns the bytes of a slice's slice.json; nothing if it is missing or does not match its digest.
  std::optional<std::string> read_slice(const std::string& id) const { return read_verified_file(id, kSliceFile); }
  std::optional<Failure> read_failure(const std::string& id) const;

  /// Locks a point before it is computed; returns nothing if another process holds the lock. Removes unfinished files
  /// of an earlier holder and moves a damaged result to damaged/.
  std::optional<sim::FileLock> lock_point(const std::string& id) const;
  bool is_locked(const std::string& id) const;
  /// Locks a stream (recorded rays) before it is recorded; returns nothing if another process holds the lock.
  std::optional<sim::FileLock> lock_stream(const std::string& key) const;

  // The caller of these functions must hold the lock of the point or stream.
  /// Lets `write` write a result into a temporary folder, adds digests, and renames it to the point's folder.
  void put_result(const std::string& id, const sim::Json& made_of,
                  const std::function<void(const std::filesystem::path& folder)>& write) const;
  void put_failure(const Failure& failure) const;
  void remove_failure(const std::string& id) const;
  void remove_stream(const std::string& key) const;

  /// Removes unfinished files of killed processes from the store.
  void remove_stale() const;

 private:
  std::filesystem::path lock_file(const std::string& id) const { return root_ / "locks" / id; }
  std::optional<std::string> read_verified_file(const std::string& id, const char* file) const;
  void clean_up(const std::string& id) const;

  std::filesystem::path root_;
};

std::string host_name();

/// The folder of a sweep or a search, with its points and the path of the store of their results.
///
///   sweep.json     schema, store, arguments for Slurm, settings of the command; identifies the folder of a sweep
///   sweep.yaml     the sweep's file
///   points.jsonl   a line per point, in the order of all tables
///   index.sqlite, results.csv, machines.csv   made from the results of the points
///   log/           output of workers; runs.jsonl: time, duration, points and utilisation of each run
class SweepFolder {
 public:
  enum class FolderKind : std::uint8_t { kSweep, kSearch };

  /// Opens the folder of a sweep or a search. Throws InputError for another folder.
  static SweepFolder open(const std::filesystem::path& path);
  /// Creates the folder if it is missing and locks it; returns nothing if another process holds the lock. Throws
  /// InputError for a folder with other contents.
  static std::optional<sim::FileLock> try_claim(const std::filesystem::path& path, FolderKind kind);
  /// Writes, or replaces, the files of a sweep or search in a folder that the caller has locked with try_claim().
  /// `sets`: settings of the command line, "key=value".
  static SweepFolder create(const std::filesystem::path& path, FolderKind kind, const std::string& spec,
                            const std::vector<Point>& points, const std::filesystem::path& store,
                            const std::vector<std::string>& slurm, const std::vector<std::string>& sets = {});

  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path log_folder() const { return path_ / "log"; }
  Store store() const { return Store(store_); }
  const std::vector<std::string>& slurm_arguments() const { return slurm_; }
  const std::vector<std::string>& sets() const { return sets_; }  ///< settings of the command line, "key=value"
  std::vector<Point> read_points() const;

  struct Runner {
    std::string host;
    int process = 0;
  };
  /// Returns the process that runs the sweep, if one does.
  std::optional<Runner> find_runner() const;

  /// Throws IoError if the folder was moved or removed during the run.
  void check_exists() const;
  /// Appends a line about a run of the sweep to log/runs.jsonl.
  void log_run(const sim::Json& run) const;

 private:
  explicit SweepFolder(std::filesystem::path path) : path_(std::move(path)) {}

  std::filesystem::path path_, store_;
  std::vector<std::string> slurm_, sets_;
};

}  // namespace tools::sweep
