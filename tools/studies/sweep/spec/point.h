#pragma once
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "tools/simulation/job_options.h"

namespace tools::sweep {

/// One simulation: what is computed, said as to `raywatt run`. A line of points.jsonl.
struct Point {
  std::uint64_t n = 0;                                    ///< in the order of the sweep, from 0
  std::string id;                                         ///< 64 hexadecimal digits: equal ids, equal results
  std::vector<std::pair<std::string, std::string>> axes;  ///< name and value, as the sweep says them
  std::string config = "sgrt-2016";
  std::string scene, camera, frames, resolution;             ///< empty: the configuration's
  std::string program = "full:1", reference, tile_sampling;  ///< the last two may be empty: none
  bool image = false;                                        ///< the picture is kept
  std::uint32_t replicates = 1;                              ///< plays of its work
  std::vector<std::string> sets;                             ///< "key=value"
  std::string stream;  ///< key of the recorded work that points share which differ in the machine alone; empty: none
  std::string error;   ///< why it cannot be computed at all, if its values do not go together

  /// The same as options of a run; argv is the command that does it.
  JobOptions options() const;
};

/// A line of points.jsonl, without its end, and back. InputError that begins with `where` for anything else.
std::string to_line(const Point& point);
Point read_line(const std::string& line, const std::string& where);

}  // namespace tools::sweep
