#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include <glm/vec3.hpp>

#include "traces/accel/memory_image.h"

namespace traces {

/// The scene as the rasteriser draws it: all triangles in world space, in the order of the memory image, instance by
/// instance. Triangles share vertices with bit-identical positions, numbered in order of first use.
struct RasterGeometry {
  struct Triangle {
    std::array<std::uint32_t, 3> vertices{};
    std::uint32_t index = 0;         ///< index in the memory image
    std::uint32_t instance = kNone;  ///< set in two-level images
    std::uint32_t missing = 0;       ///< culled face in world space: kNoClockwise, kNoCounterClockwise or 0
  };
  std::vector<glm::dvec3> vertices;
  std::vector<Triangle> triangles;
};

RasterGeometry raster_geometry(const MemoryImage& image);

}  // namespace traces
