#pragma once
#include <cstddef>
#include <filesystem>

#include "tools/simulation/run_job.h"
#include "tools/tiles/tile_table.h"

namespace tools {

/// A finished frame, and what it looks like.
struct FramePictures {
  const Inputs& inputs;
  const kernels::ProgramSpec& program;
  const Simulation& frame;
  const Simulation* compared = nullptr;  ///< frame of the reference, if there is one
  const TileFrame* tiles = nullptr;      ///< account of its tiles, for debug pictures
  bool is_first = true;                  ///< frame of the run: its pictures have names of their own
  bool has_picture = true;               ///< a sampled frame may have none
  bool debug = false;                    ///< writes debug pictures as well
};

/// Writes the frame's picture and what it looks like otherwise: its reference, what pixels and tiles took, debug
/// pictures. Files are compressed side by side on so many threads. IoError if one cannot be written.
void write_pictures(const std::filesystem::path& folder, const FramePictures& of, std::size_t threads);

}  // namespace tools
