#pragma once
#include <cstddef>
#include <filesystem>

#include "tools/run/run.h"

namespace tools {

/// A finished frame and which of its pictures are written.
struct FramePictures {
  const PlayedFrame& played;
  const kernels::ProgramSpec& program;
  bool has_picture = true;  ///< false for a sampled frame without tiles that are not timed
  bool debug = false;       ///< writes debug pictures as well
};

/// Writes the frame's picture and what it looks like otherwise: its reference, what pixels and tiles took, debug
/// pictures. Files are compressed side by side on so many threads. IoError if one cannot be written.
void write_pictures(const std::filesystem::path& folder, const FramePictures& of, std::size_t threads);

}  // namespace tools
