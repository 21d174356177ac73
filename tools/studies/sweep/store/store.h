#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "sim/io/json.h"
#include "tools/studies/sweep/store/lock.h"

namespace tools::sweep {

inline constexpr const char* kSliceFile = "slice.json";

/// A point that could not be computed.
struct Failure {
  std::string id;
  int exit = 0;  ///< as `raywatt run` would end: 2 bad input, 3 stuck machine, 70 our bug; 128 + signal of a crash
  std::string error;
  std::string log;  ///< the last lines that it said
  std::string host;
  int attempt = 1;
};

/// Results by what they were made of, shared by any number of sweeps at once, on any number of hosts.
///
///   points/<2 hex>/<id>/      report.json, config.yaml, [image.png], point.json: what the id is the hash of, and the
///                             digest of each file. Written in tmp/ and moved there as a whole. A slice has slice.json
///                             instead of the first two
///   failed/<2 hex>/<id>.json  a Failure
///   locks/<id>                held while the point is computed
///   streams/<key>.trace       recorded work, while points of a sweep that share it are computed
///   damaged/                  point folders that are not as they were written
class Store {
 public:
  explicit Store(std::filesystem::path root) : root_(std::move(root)) {}
  /// $RAYWATT_STORE, or raywatt-out/store.
  static std::filesystem::path default_root();

  const std::filesystem::path& root() const { return root_; }
  std::filesystem::path folder(const std::string& id) const;
  /// Where a Failure is written down.
  std::filesystem::path failure_file(const std::string& id) const;
  std::filesystem::path stream(const std::string& key) const { return root_ / "streams" / (key + ".trace"); }

  enum class State : std::uint8_t { kMissing, kGood, kDamaged };
  /// Reads all of it: a file that is missing, cut or changed makes it damaged.
  State state(const std::string& id) const;
  /// The bytes of report.json of a point that is good; nothing otherwise.
  std::optional<std::string> report(const std::string& id) const;
  /// Likewise slice.json of a slice.
  std::optional<std::string> slice(const std::string& id) const;
  std::optional<Failure> failure(const std::string& id) const;

  /// Nothing if somebody else is computing the point. What an earlier holder has left half done is removed, and what is
  /// damaged put aside.
  std::optional<Lock> lock(const std::string& id) const;
  bool is_locked(const std::string& id) const;
  /// The same for a stream that is to be recorded.
  std::optional<Lock> lock_stream(const std::string& key) const;

  // Only for who holds the lock.
  /// `write` puts files into a folder, which then becomes the point's.
  void put(const std::string& id, const sim::Json& made_of,
           const std::function<void(const std::filesystem::path& folder)>& write) const;
  void put_failure(const Failure& failure) const;
  void forget_failure(const std::string& id) const;
  void remove_stream(const std::string& key) const;

  /// Removes what killed processes have left half done.
  void clean() const;

 private:
  std::filesystem::path lock_file(const std::string& id) const { return root_ / "locks" / id; }
  void clean(const std::string& id) const;

  std::filesystem::path root_;
};

std::string host_name();

}  // namespace tools::sweep
