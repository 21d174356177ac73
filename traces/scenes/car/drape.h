#pragma once
#include <span>
#include <string>

#include "traces/scene/scene.h"

namespace traces::car {

/// A patch between two lines in the plane, smoothed, in columns x rows cells; z = 0. Lines run side by side; the front
/// is where first and second line lie as x axis and y axis do.
Mesh make_patch(std::span<const glm::vec2> first, std::span<const glm::vec2> second, std::uint32_t columns,
                std::uint32_t rows);

/// A strip of that width along a line in the plane.
Mesh make_strip(std::span<const glm::vec2> line, float width, std::uint32_t columns);

/// Which way a patch is thrown; its plane's axes seen in the direction of the throw.
enum class From : std::uint8_t {
  kFront,  ///< along -x: (z, y)
  kRear,   ///< along +x: (z, y)
  kLeft,   ///< along +z: (x, y)
  kRight,  ///< along -z: (x, y)
  kAbove   ///< along -y: (x, z)
};

/// The patch thrown onto a body, `lift` above its surface and with its normals; what misses is left out.
Mesh draped(const Mesh& body, const Mesh& patch, From from, float lift);

}  // namespace traces::car
