#pragma once
#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "sim/io/file.h"
#include "sim/io/json.h"
#include "tools/studies/sweep/spec/point.h"

namespace tools::sweep {

inline constexpr const char* kSliceFile = "slice.json";

/// Record of a point that could not be computed.
struct Failure {
  std::string id;
  int exit = 0;  ///< exit code of `raywatt run`: 2 bad input, 3 stuck machine, 70 our bug; 128 + signal of a crash
  std::string error;
  std::string log;  ///< last lines that the worker printed
  std::string host;
  int attempt = 1;
};

/// Results by the id of their point, shared by any number of sweeps and hosts at once.
///
///   points/<2 hex>/<id>/      report.json, config.yaml, [image.png], point.json: what the id is the hash of, and the
///                             digest of each file. A slice has slice.json instead of the first two
///   failed/<2 hex>/<id>.json  a Failure
///   locks/<id>                held while the point is computed
///   tmp/                      point folders that are being written, then renamed
///   streams/<key>.trace       recorded work that points of a sweep share while they are computed
///   damaged/                  point folders whose files do not match their digests
class Store {
 public:
  explicit Store(std::filesystem::path root) : root_(std::move(root)) {}
  /// $RAYWATT_STORE, or raywatt-out/store.
  static std::filesystem::path default_root();

  const std::filesystem::path& root() const { return root_; }
  std::filesystem::path folder_of(const std::string& id) const;
  /// File of the point's Failure.
  std::filesystem::path failure_file(const std::string& id) const;
  std::filesystem::path stream_file(const std::string& key) const { return root_ / "streams" / (key + ".trace"); }

  /// Status of a point: done, damaged, failed or missing. Reads all files of a result; a result overrides a failure.
  PointStatus status_of(const std::string& id) const;
  bool is_done(const std::string& id) const { return status_of(id) == PointStatus::kDone; }
  /// Bytes of report.json; nothing unless they match their digest.
  std::optional<std::string> read_report(const std::string& id) const { return read_sound(id, "report.json"); }
  /// Bytes of slice.json of a slice; nothing unless they match their digest.
  std::optional<std::string> read_slice(const std::string& id) const { return read_sound(id, kSliceFile); }
  std::optional<Failure> read_failure(const std::string& id) const;

  /// Locks a point that is to be computed; nothing if another process holds it. Removes what an earlier holder left
  /// unfinished and moves a damaged result to damaged/.
  std::optional<sim::FileLock> lock_point(const std::string& id) const;
  bool is_locked(const std::string& id) const;
  /// Locks a stream that is to be recorded; nothing if another process holds it.
  std::optional<sim::FileLock> lock_stream(const std::string& key) const;

  // These require the lock of the point or stream.
  /// Lets `write` put files into a folder, then adds the digests and renames it to the point's folder.
  void put_result(const std::string& id, const sim::Json& made_of,
                  const std::function<void(const std::filesystem::path& folder)>& write) const;
  void put_failure(const Failure& failure) const;
  void remove_failure(const std::string& id) const;
  void remove_stream(const std::string& key) const;

  /// Removes what killed processes have left unfinished.
  void remove_stale() const;

 private:
  std::filesystem::path lock_file(const std::string& id) const { return root_ / "locks" / id; }
  std::optional<std::string> read_sound(const std::string& id, const char* file) const;
  void clean_up(const std::string& id) const;

  std::filesystem::path root_;
};

std::string host_name();

}  // namespace tools::sweep
