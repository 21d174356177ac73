#pragma once
#include <filesystem>
#include <vector>

#include "sim/io/json.h"
#include "tools/studies/reproduce/results.h"

namespace tools::reproduce {

/// Results in a folder before the experiments run into it.
struct Former {
  std::size_t rows = 0;       ///< rows of any run: fewer do not replace them
  std::vector<Row> finished;  ///< rows of an interrupted run of the same experiments, to go on from
};

/// Reads the folder's reproduce.json, if it is there and can be read. A row is finished if paper, sizes, program and
/// configuration are those of `head`, the first members of this run's own, and its scene's file has not changed.
Former load_former(const std::filesystem::path& folder, const sim::Json& head);

/// SHA-256 of a scene's file; empty for a built-in scene, which comes with the program.
std::string digest_of_file(const std::filesystem::path& scene);

}  // namespace tools::reproduce
