#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "tools/simulation/job_options.h"
#include "tools/simulation/run_config.h"

namespace tools::sweep {

/// The digest of scenes that are no files.
inline constexpr std::string_view kBuiltIn = "built-in";

/// One simulation: what is computed, said as to `raywatt run`. A line of points.jsonl.
struct Point {
  std::uint64_t n = 0;                                    ///< in the order of the sweep, from 0
  std::string id;                                         ///< 64 hexadecimal digits: equal ids, equal results
  std::vector<std::pair<std::string, std::string>> axes;  ///< name and value, as the sweep says them
  std::string config = "sgrt-2016";
  std::string scene, camera, frames, resolution;             ///< empty: the configuration's
  std::string program = "full:1", reference, tile_sampling;  ///< the last two may be empty: none
  bool image = false;                                        ///< the picture is kept
  std::vector<std::string> sets;                             ///< "key=value"
  std::string stream;  ///< key of the recorded work that points share which differ in the machine alone; empty: none
  std::string error;   ///< why it cannot be computed at all, if its values do not go together

  /// The same as options of a run; argv is the command that does it.
  JobOptions options() const;
};

/// A line of points.jsonl, without its end, and back. InputError that begins with `where` for anything else.
std::string to_line(const Point& point);
Point read_line(const std::string& line, const std::string& where);

/// Finds out what points depend on. Remembers what they share: read once, many points take no longer than one.
class PointKeys {
 public:
  struct Key {
    nlohmann::ordered_json made_of;  ///< all that the result depends on
    std::string id;                  ///< its hash
    std::string stream;              ///< as in Point
  };

  /// The effective configuration. InputError if its values do not go together.
  RunConfig config_of(const Point& point);
  Key key_of(const Point& point, const RunConfig& config);
  /// Sets id and stream; or error, and an id of what was asked for. InputError for a scene file that cannot be read.
  void set_key(Point& point);

 private:
  std::string scene_digest(const RunConfig& config);

  std::map<std::pair<std::string, std::string>, RunConfig> bases_;  ///< by configuration and scene
  std::map<std::string, std::string> digests_;                      ///< of scene files
};

}  // namespace tools::sweep
