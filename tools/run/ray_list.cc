#include "tools/run/ray_list.h"

#include <array>
#include <cmath>
#include <cstring>

#include <fmt/format.h>

#include "sim/error.h"
#include "sim/io/file.h"
#include "sim/io/printable.h"
#include "sim/sha256.h"

namespace tools {
namespace {

constexpr std::uint64_t kRayBytes = 32, kMostRays = 1U << 26;

/// Returns what is wrong with a ray; empty if nothing.
std::string_view problem(const traces::Ray& ray) {
  const auto finite = [](const glm::vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); };
  if (!finite(ray.origin)) return "origin is not finite";
  if (!finite(ray.direction)) return "direction is not finite";
  if (ray.direction == glm::vec3(0)) return "direction is zero";
  if (!(ray.t_min >= 0) || std::isinf(ray.t_min)) return "t_min is not a number from 0 on";
  if (!(ray.t_max >= ray.t_min)) return "t_max is less than t_min, or no number";
  return {};
}

}  // namespace

RayList read_ray_list(const std::filesystem::path& path) {
  const std::string bytes = sim::read_file(path, kMostRays * kRayBytes);
  const std::string shown = sim::printable(path.string());
  if (bytes.empty() || bytes.size() % kRayBytes != 0) {
    throw sim::InputError(
        fmt::format("{}: has {} bytes; allowed: 32 a ray (8 floats: origin, t_min, direction, "
                    "t_max), at least one ray",
                    shown, bytes.size()));
  }
  RayList list{std::vector<traces::Ray>(bytes.size() / kRayBytes), sim::sha256_hex(bytes)};
  for (std::size_t i = 0; i < list.rays.size(); ++i) {
    std::array<float, 8> n{};
    std::memcpy(n.data(), bytes.data() + i * kRayBytes, kRayBytes);
    list.rays[i] = {{n[0], n[1], n[2]}, n[3], {n[4], n[5], n[6]}, n[7]};
    const std::string_view wrong = problem(list.rays[i]);
    if (!wrong.empty()) {
      throw sim::InputError(
          fmt::format("{}: ray {}: {}; allowed: finite numbers, a direction that is not zero, "
                      "0 <= t_min <= t_max (t_max may be infinite)",
                      shown, i, wrong));
    }
  }
  return list;
}

}  // namespace tools
