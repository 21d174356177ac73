#pragma once
#include <span>
#include <string>

#include "traces/scene/scene.h"
#include "traces/scenes/modelling/detail.h"

namespace traces::car {

// In metres. The car's front is +x, its right side +z, the ground y = 0.
inline constexpr float kFrontAxle = 1.30F, kRearAxle = -1.31F;
inline constexpr float kWheel = 0.335F;  ///< radius, and height of the axles
inline constexpr float kArch = 0.385F;   ///< radius of the wheel arches
inline constexpr float kTrack = 0.795F;  ///< from the car's middle plane to the middle of a wheel

/// Makes the shell up to the belt line: fenders, bonnet, doors, tail. It is open below and has wheel arches.
Mesh make_shell(const Detail& detail);

/// Makes roof and pillars without glass; the lower edge is inside the shell.
Mesh make_cabin(const Detail& detail);

/// Makes the liners of the wheel arches and the floor.
Mesh make_underbody(const Detail& detail);

/// Makes the rims of the wheel arches.
Mesh make_arch_lips(const Detail& detail);

/// Returns half the width of the shell at a point of its side.
float side_at(float x, float y);

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
Mesh drape_patch(const Mesh& body, const Mesh& patch, From from, float lift);

}  // namespace traces::car
