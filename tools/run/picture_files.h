#pragma once
#include <cstddef>
#include <filesystem>

#include "tools/run/run.h"

namespace tools {

/// A finished frame and the pictures to write.
struct FramePictures {
  const PlayedFrame& played;
  const kernels::ProgramSpec& program;
  bool has_picture = true;  ///< false if sampling skipped tiles
  bool debug = false;       ///< also write debug pictures
};

/// Writes the frame's pictures: image, reference, difference, costs of pixels and tiles, debug pictures. Uses up to
/// `threads` threads. IoError if a file cannot be written.
void write_pictures(const std::filesystem::path& folder, const FramePictures& of, std::size_t threads);

}  // namespace tools
