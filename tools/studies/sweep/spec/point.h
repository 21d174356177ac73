#pragma once
#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "sim/io/json.h"
#include "tools/run/frame/job_options.h"
#include "tools/run/frame/load_config.h"

namespace tools::sweep {

/// Status of a point of a sweep, in a store, a batch, a table of results or a search.
enum class PointStatus : std::uint8_t {
  kMissing,     ///< not computed
  kLocked,      ///< another process is computing it
  kImpossible,  ///< its axis values contradict each other
  kDamaged,     ///< its files do not match their digests
  kFailed,      ///< it could not be computed; a Failure is recorded
  kDone,        ///< its result is in the store
  kComputed,    ///< its result is in the store and was computed by this batch
};
inline bool is_done(PointStatus status) { return status >= PointStatus::kDone; }
inline std::string_view name_of(PointStatus status) {
  constexpr std::array<std::string_view, 7> kNames = {"missing", "locked", "impossible", "damaged",
                                                      "failed",  "done",   "computed"};
  return kNames.at(static_cast<std::size_t>(status));
}

/// A point of a sweep: one simulation, described by options of `raywatt run`. It is a line of points.jsonl. A point
/// that is cut into slices is computed slice by slice, and each slice is a point.
struct Point {
  std::uint64_t n = 0;                                    ///< index in the sweep
  std::string id;                                         ///< 64 hexadecimal digits: equal ids, equal results
  std::vector<std::pair<std::string, std::string>> axes;  ///< name and value, as written in the sweep's file
  std::string config = "sgrt-2016";
  std::string scene, camera, frames, resolution;                             ///< empty: as in the configuration
  std::string program = "full:1", reference, tile_sampling, representative;  ///< the last three may be empty
  bool image = false;                                                        ///< keep the picture
  std::uint32_t replicates = 1;                                              ///< perturbed repetitions
  std::uint32_t slices = 0;       ///< slices of each frame; 0: frames are not cut
  std::uint32_t slice = 0;        ///< number of this slice, from 1; 0: the whole point
  std::string whole;              ///< id of the whole point of a slice
  std::vector<std::string> sets;  ///< "key=value"
  std::string stream;  ///< key of the recorded rays, which points share that differ only in the machine; may be empty
  std::string error;   ///< contradiction between its values, which prevents a simulation; usually empty

  /// True if workers compute the slices of this point separately.
  bool is_cut() const { return slices != 0 && slice == 0 && error.empty(); }
  /// Returns the number of pieces in which workers compute the point: its slices, or 1.
  std::uint32_t piece_count() const { return is_cut() ? slices : 1; }
  /// Returns the options of the run that computes the point; their argv is its command line.
  JobOptions run_options() const;
};

/// A text member of Point, with the corresponding key in a sweep's files and option of `raywatt run`.
struct PointText {
  const char* name;    ///< key of the member in the files of a sweep
  const char* option;  ///< option of `raywatt run`
  std::string Point::*member;
  std::string JobOptions::*job;
};
inline constexpr PointText kPointTexts[] = {
    {"scene", "--scene", &Point::scene, &JobOptions::scene},
    {"camera", "--camera", &Point::camera, &JobOptions::camera},
    {"frames", "--frames", &Point::frames, &JobOptions::frames},
    {"resolution", "--resolution", &Point::resolution, &JobOptions::resolution},
    {"program", "--program", &Point::program, &JobOptions::program},
    {"reference", "--reference", &Point::reference, &JobOptions::reference},
    {"tile_sampling", "--tile-sampling", &Point::tile_sampling, &JobOptions::tile_sampling},
    {"representative", "--representative", &Point::representative, &JobOptions::representative}};

/// Returns the slices of a point in order; none if it is not cut into slices.
std::vector<Point> slices_of(const Point& point);
/// Returns the point that a slice was cut from.
Point whole_point_of(const Point& slice);
/// Returns the JSON whose hash is the id of a slice.
sim::Json slice_identity(const Point& slice);

/// Converts a point to a line of points.jsonl, without the line end. parse_point_line() converts it back; its
/// InputErrors begin with `where`.
std::string format_point_line(const Point& point);
Point parse_point_line(const std::string& line, const std::string& where);

/// Text in place of the digest for scenes that are not files.
inline constexpr std::string_view kBuiltIn = "built-in";

/// Computes the ids of points from everything that the results depend on. Caches configurations and digests of scene
/// files, because many points share them.
class PointKeys {
 public:
  struct Key {
    sim::Json made_of;   ///< everything that the result depends on
    std::string id;      ///< hash of made_of
    std::string stream;  ///< as in Point
  };

  /// Returns the effective configuration of a point, valid until the next call of a member function. Throws InputError
  /// if the point's values contradict each other.
  const RunConfig& config_of(const Point& point);
  /// Returns id and stream (key of the recorded rays) of a point. Throws InputError like config_of().
  Key key_of(const Point& point);
  /// Sets id and stream of a point. If its values contradict each other, sets its error instead, and an id made from
  /// the values. Throws InputError for a scene file that cannot be read.
  void set_key(Point& point);

 private:
  /// Applies the settings of a point to the point's base configuration. Throws InputError.
  const ConfigVariants& apply_point(const Point& point);
  Key make_key(const Point& point, const ConfigVariants& applied);
  std::string scene_digest(const RunConfig& config);

  /// Base configurations by configuration file, scene and process.
  std::map<std::vector<std::string>, ConfigVariants> bases_;
  std::map<std::string, std::string> digests_;  ///< digests by scene file
};

}  // namespace tools::sweep
