#pragma once
#include <map>
#include <string>
#include <string_view>
#include <utility>

#include "sim/io/json.h"
#include "tools/run/frame/load_config.h"
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

  /// The effective configuration, valid until the next call of any function. InputError if its values do not go
  /// together.
  const RunConfig& config_of(const Point& point);
  /// InputError as config_of().
  Key key_of(const Point& point);
  /// Sets id and stream; or error, and an id of what was asked for. InputError for a scene file that cannot be read.
  void set_key(Point& point);

 private:
  /// Variants of the point's base, with the point applied. InputError.
  const ConfigVariants& apply(const Point& point);
  Key make_key(const Point& point, const ConfigVariants& applied);
  std::string scene_digest(const RunConfig& config);

  std::map<std::pair<std::string, std::string>, ConfigVariants> bases_;  ///< by configuration and scene
  std::map<std::string, std::string> digests_;                           ///< digests of scene files
};

}  // namespace tools::sweep
