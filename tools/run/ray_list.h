#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "traces/ray.h"

namespace tools {

/// Rays as a file lists them.
struct RayList {
  std::vector<traces::Ray> rays;
  std::string sha256;  ///< digest of the file
};

/// Reads a file of 8 little-endian floats a ray: origin, t_min, direction, t_max. Numbers are finite but for t_max,
/// which may be infinite; 0 <= t_min <= t_max; the direction is not zero. InputError that names the file and the ray,
/// counted from 0.
RayList read_ray_list(const std::filesystem::path& path);

}  // namespace tools
