#pragma once
#include <map>
#include <string>
#include <string_view>
#include <utility>

#include "sim/io/json.h"
#include "tools/simulation/load_config.h"
#include "tools/studies/sweep/spec/point.h"

namespace tools::sweep {

/// The digest of scenes that are no files.
inline constexpr std::string_view kBuiltIn = "built-in";

/// Finds out what points depend on. Remembers what they share: read once, many points take no longer than one.
class PointKeys {
 public:
  struct Key {
    sim::Json made_of;   ///< all that the result depends on
    std::string id;      ///< its hash
    std::string stream;  ///< as in Point
  };

  /// The effective configuration. InputError if its values do not go together.
  RunConfig config_of(const Point& point);
  Key key_of(const Point& point, RunConfig config);
  /// Sets id and stream; or error, and an id of what was asked for. InputError for a scene file that cannot be read.
  void set_key(Point& point);

 private:
  std::string scene_digest(const RunConfig& config);

  std::map<std::pair<std::string, std::string>, RunConfig> bases_;  ///< by configuration and scene
  std::map<std::string, std::string> digests_;                      ///< digests of scene files
};

}  // namespace tools::sweep
