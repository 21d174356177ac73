#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "traces/ray.h"

namespace tools {

/// The rays of a file.
struct RayList {
  std::vector<traces::Ray> rays;
  std::string sha256;  ///< SHA-256 of the file
};

/// Reads a file with 8 little-endian floats per ray: origin, t_min, direction, t_max. All are finite except t_max; 0 <=
/// t_min <= t_max; the direction is not zero. InputError with the file and the ray's index, from 0.
RayList read_ray_list(const std::filesystem::path& path);

}  // namespace tools
