#pragma once
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "sim/io/json.h"
#include "tools/run/frame/job_options.h"

namespace tools::sweep {

/// One simulation: what is computed, said as to `raywatt run`. A line of points.jsonl. One that is cut into slices is
/// computed slice by slice, each of which is a point by itself.
struct Point {
  std::uint64_t n = 0;                                    ///< in the order of the sweep, from 0
  std::string id;                                         ///< 64 hexadecimal digits: equal ids, equal results
  std::vector<std::pair<std::string, std::string>> axes;  ///< name and value, as the sweep says them
  std::string config = "sgrt-2016";
  std::string scene, camera, frames, resolution;             ///< empty: the configuration's
  std::string program = "full:1", reference, tile_sampling;  ///< the last two may be empty: none
  bool image = false;                                        ///< the picture is kept
  std::uint32_t replicates = 1;                              ///< plays of its work
  std::uint32_t slices = 0;                                  ///< that its frames are cut into; 0: none
  std::uint32_t slice = 0;                                   ///< the one that this is, from 1; 0: all of them, joined
  std::string whole;                                         ///< id of the point that it is a slice of
  std::vector<std::string> sets;                             ///< "key=value"
  std::string stream;  ///< key of the recorded work that points share which differ in the machine alone; empty: none
  std::string error;   ///< why it cannot be computed at all, if its values do not go together

  /// Has slices that can be computed?
  bool is_cut() const { return slices != 0 && slice == 0 && error.empty(); }
  /// Pieces in which it is handed out.
  std::uint32_t pieces() const { return is_cut() ? slices : 1; }
  /// The same as options of a run; argv is the command that does it.
  JobOptions options() const;
};

/// The slices of a point in order; none if it is not cut.
std::vector<Point> slices_of(const Point& point);
/// The point that it is a slice of.
Point whole_of(const Point& slice);
/// Contents of which the id of a slice is the hash.
sim::Json made_of(const Point& slice);

/// A line of points.jsonl, without its end, and back. InputError that begins with `where` for anything else.
std::string to_line(const Point& point);
Point read_line(const std::string& line, const std::string& where);

}  // namespace tools::sweep
