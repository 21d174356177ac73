#pragma once
#include <span>
#include <string>

#include "traces/scene/scene.h"

namespace traces::car {

/// Makes a patch of columns x rows cells between two smoothed lines in the plane z = 0. The lines run in the same
/// direction; the patch faces +z if the second is to the left of the first.
Mesh make_patch(std::span<const glm::vec2> first, std::span<const glm::vec2> second, std::uint32_t columns,
                std::uint32_t rows);

/// Makes a strip of that width along a line in the plane.
Mesh make_strip(std::span<const glm::vec2> line, float width, std::uint32_t columns);

/// Direction in which a patch is projected, and its plane's axes.
enum class From : std::uint8_t {
  kFront,  ///< along -x: (z, y)
  kRear,   ///< along +x: (z, y)
  kLeft,   ///< along +z: (x, y)
  kRight,  ///< along -z: (x, y)
  kAbove   ///< along -y: (x, z)
};

/// Projects the patch onto a body, `lift` above its surface and with its normals; parts that miss are left out.
Mesh draped(const Mesh& body, const Mesh& patch, From from, float lift);

}  // namespace traces::car
