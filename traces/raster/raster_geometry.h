#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include <glm/vec3.hpp>

#include "traces/accel/memory_image.h"

namespace traces {

/// A scene as a rasteriser draws it: all triangles in world space, in the order of the memory image, instance by
/// instance, over vertices that those share which have the same position to the last bit. Vertices are numbered as
/// triangles first use them.
struct RasterGeometry {
  struct Triangle {
    std::array<std::uint32_t, 3> vertices{};
    std::uint32_t index = 0;         ///< among the memory image's
    std::uint32_t instance = kNone;  ///< two levels
    std::uint32_t missing = 0;       ///< kNoClockwise or kNoCounterClockwise, as seen in world space
  };
  std::vector<glm::dvec3> vertices;
  std::vector<Triangle> triangles;
};

RasterGeometry raster_geometry(const MemoryImage& image);

}  // namespace traces
